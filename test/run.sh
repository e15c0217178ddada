#!/usr/bin/env bash
# Usage: test/run.sh [--quick] [CTEST_ARGUMENT...]
# Builds everything in build/ and runs all tests. --quick builds the library, the programs and their
# tests, and leaves out the test suites that take longer than 2 s. The tests on real logs run if
# PLUMBLINE_DATASETS names a folder that holds the logs (see datasets/README.md).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
packages=all
targets=()
tests=()
if [[ ${1:-} == --quick ]]; then
  packages=tests
  targets=(plumbline_{core,factors,solvers,apps}_tests plumbline_fuzzers)
  tests=(--label-exclude slow)
  shift
fi
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

"$root/cmake/bootstrap.sh" "$packages"
"$root/cmake/build.sh" ${targets[@]+"${targets[@]}"}
echo "Tests on real logs: $real_data"
cd "$root/build"
status=0
ctest --output-on-failure --no-tests=error -j2 ${tests[@]+"${tests[@]}"} "$@" || status=$?
# ctest tells of suites; a suite that passes may have skipped some of its tests.
awk '/^\[ RUN      \] / { test = $4 }
     skipped { print "Skipped: " test ": " $0 }
     { skipped = /: Skipped$/ }' Testing/Temporary/LastTest.log
exit "$status"
