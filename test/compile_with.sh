#!/usr/bin/env bash
# Usage: compile_with.sh OTHER_COMPILER COMPILER ARGUMENT...
# A compiler launcher of CMake that compiles one target with clang instead of the project's gcc.
set -euo pipefail
compiler=$1
shift 2
# clang would read a precompiled header that it is about to write.
if [[ " $* " == *" -x c++-header "* ]]; then
  for argument; do
    if [[ $argument == *.gch ]]; then rm -f "$argument"; fi
  done
fi
exec "$compiler" -std=c++17 -Qunused-arguments "$@"
