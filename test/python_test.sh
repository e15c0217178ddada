#!/usr/bin/env bash
# Usage: python_test.sh PYTHON TESTS_DIR
# Runs the tests of the Python module with pytest; PYTHONPATH names the folder of the module.
set -euo pipefail
for needed in numpy pytest; do
  if ! "$1" -c "import $needed" 2>/dev/null; then
    echo "SKIPPED: $1 has no $needed (Debian: python3-$needed)"
    exit 77
  fi
done
export PYTHONDONTWRITEBYTECODE=1
exec "$1" -m pytest --quiet -p no:cacheprovider --durations=5 "$2"
