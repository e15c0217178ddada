#!/usr/bin/env bash
# Usage: test/run.sh [CTEST_ARGUMENT...]
# Builds everything in build/ and runs all tests. The tests on real logs run if PLUMBLINE_DATASETS
# names a folder that holds the logs (see datasets/README.md).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
if [[ -z ${PLUMBLINE_DATASETS:-} ]]; then
  real_data="skipped: PLUMBLINE_DATASETS is not set"
elif [[ -d $PLUMBLINE_DATASETS ]]; then
  PLUMBLINE_DATASETS=$(cd "$PLUMBLINE_DATASETS" && pwd)
  export PLUMBLINE_DATASETS
  real_data="run with $PLUMBLINE_DATASETS"
else
  echo "run.sh: PLUMBLINE_DATASETS=$PLUMBLINE_DATASETS is not a folder" >&2
  exit 1
fi

"$root/cmake/bootstrap.sh" all
"$root/cmake/build.sh"
echo "Tests on real logs: $real_data"
cd "$root/build"
ctest --output-on-failure --no-tests=error -j2 "$@"
