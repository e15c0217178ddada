#!/usr/bin/env bash
# Usage: format_test.sh CLANG_FORMAT ROOT
# Fails, naming file and line, on a source that the formatter would change.
set -euo pipefail
cd "$2"
find core factors solvers apps test -name '*.cc' -o -name '*.h' | sort |
  xargs --max-procs=2 --max-args=50 "$1" --dry-run -Werror
