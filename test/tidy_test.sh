#!/usr/bin/env bash
# Usage: tidy_test.sh CLANG_TIDY ROOT BUILD
# clang-tidy over the C++ files that the last commit or the working tree has changed, as BUILD
# compiles them, up to 40 sources. The whole tree takes too long for every change: test/check.sh
# tidy.
set -euo pipefail
tidy=$1 root=$2 build=$3

skip() {
  echo "SKIPPED: $1"
  exit 77
}

command -v "$tidy" >/dev/null || skip "clang-tidy-14 is not installed"
cd "$root"
git rev-parse --quiet --verify HEAD~1 >/dev/null 2>&1 || skip "no commit before the last one"

# clang reads no precompiled header of gcc and knows none of its parameters.
work=$build/test/tidy
mkdir -p "$work"
sed -E 's/-Winvalid-pch|--param=[^ ]+|(-Xclang )?-include(-pch)? (-Xclang )?[^ ]+cmake_pch[^ ]+//g' \
  "$build/compile_commands.json" >"$work/compile_commands.json"

# A header is checked with its x.cc, or with the source that makes sure that it compiles alone.
changed() {
  git diff --name-only --relative --diff-filter=d HEAD~1 -- '*.cc' '*.h'
  git ls-files --others --exclude-standard -- '*.cc' '*.h'
}
changed | while read -r file; do
  for source in "$root/${file%.*}.cc" "$build/test/headers/${file%.*}.cc"; do
    if grep -qF "\"file\": \"$source\"" "$work/compile_commands.json"; then
      echo "$source"
      break
    fi
  done
done | sort -u >"$work/sources"
num=$(wc -l <"$work/sources")
((num <= 40)) || skip "the last change touches $num sources; run test/check.sh tidy"
echo "$num sources to check"
xargs --no-run-if-empty --max-procs=2 --max-args=1 "$tidy" --quiet -p "$work" \
  --extra-arg-before=-std=c++17 <"$work/sources"
