#!/usr/bin/env bash
# Usage: compile_with.sh COMMAND... -- COMPILER ARGUMENT...
# A compiler launcher of CMake that compiles one target with COMMAND, which calls clang, instead of
# with the project's gcc.
set -euo pipefail
command=()
while [[ $1 != -- ]]; do
  command+=("$1")
  shift
done
shift 2
# clang would read a precompiled header that it is about to write.
if [[ " $* " == *" -x c++-header "* ]]; then
  for argument; do
    if [[ $argument == *.gch ]]; then rm -f "$argument"; fi
  done
fi
exec "${command[@]}" -std=c++17 -Qunused-arguments "$@"
