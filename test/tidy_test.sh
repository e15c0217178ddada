#!/usr/bin/env bash
# Usage: tidy_test.sh CLANG_TIDY ROOT BUILD
# clang-tidy over all sources that BUILD compiles, but over tests and over what has a main function
# only if the last commit or the working tree has changed them. Nearly all of its time goes into
# the headers of libraries, so it looks at the units of a unity build, and at one per layer of tests.
set -euo pipefail
tidy=$1 root=$2 build=$3

skip() {
  echo "SKIPPED: $1"
  exit 77
}

command -v "$tidy" >/dev/null || skip "clang-tidy-14 is not installed"
cd "$root"
work=$build/test/tidy
rm -rf "$work"
mkdir -p "$work"/{tests,alone}
cp .clang-tidy "$work"
cp test/.clang-tidy "$work/tests"
commands=$build/compile_commands.json
cmake -S . -B "$work/unity" -DPLUMBLINE_UNITY_BUILD=ON -DPLUMBLINE_BUILD_TESTS=OFF \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >"$work/configure.log"

# What the last change touched; everything where nothing is known of it.
sources() { # of tests, and what has a main function
  sed -nE "s|^ *\"file\": \"$root/(.*\.cc)\",?$|\1|p" "$commands" |
    grep -E '^test/|_main\.cc$|^apps/examples/' | sort -u
}
if git rev-parse --quiet --verify HEAD~1 >/dev/null 2>&1; then
  git diff --name-only --relative --diff-filter=d HEAD~1 >"$work/changed"
  git ls-files --others --exclude-standard >>"$work/changed"
else
  sources >"$work/changed"
fi

# Tests are nothing but an anonymous namespace each, which gets a name of its own.
number=0
while read -r file; do
  layer=${file#test/}
  layer=${layer%%/*}
  grep -q "^test/$layer/" "$work/changed" || continue
  number=$((number + 1))
  {
    echo "#line 1 \"$root/$file\""
    sed "s/^namespace {\$/namespace unit_$number {/" "$file"
  } >>"$work/tests/$layer.cc"
done < <(sources | grep '_test\.cc$')

# Units of tests see the definitions and the folders of headers of all sources, which do not
# contradict one another.
flags=$(grep -oE ' (-D|-I|-isystem )[^ ]+' "$commands" | sort -u | tr -d '\n')
{
  echo '['
  separator=''
  while read -r unit; do
    printf '%s{"directory": "%s", "file": "%s", "command": "clang++ -std=c++17%s -c %s"}\n' \
      "$separator" "$work" "$unit" "$flags" "$unit"
    separator=,
  done < <(find "$work/tests" -name '*.cc')
  echo ']'
} >"$work/tests/compile_commands.json"

# clang reads no precompiled header of gcc and knows none of its parameters.
for_clang='s/-Winvalid-pch|--param=[^ ]+|(-Xclang )?-include(-pch)? (-Xclang )?[^ ]+cmake_pch[^ ]+//g'
sed -Ei "$for_clang" "$work/unity/compile_commands.json"
sed -E "$for_clang" "$commands" >"$work/alone/compile_commands.json"

# The largest first, so that both processors are busy to the end. Texts that the build makes are no
# sources.
find "$work/tests" -name '*.cc' -exec ls -S {} + >"$work/test_units"
find "$work/unity" -name 'unity_*.cxx' -exec grep -L report_assets.cc {} + | xargs -r ls -S \
  >"$work/source_units"
sed -nE "s|^ *\"file\": \"($root/.*\.cc)\",?$|\1|p" "$work/unity/compile_commands.json" |
  grep -vE "_main\.cc$|^$root/apps/examples/|^$work/" >>"$work/source_units"
sources | grep -v '_test\.cc$' | grep -xFf "$work/changed" | sed "s|^|$root/|" >"$work/alone/units" ||
  true

# check UNITS COMMANDS
check() {
  xargs --no-run-if-empty --max-procs=2 --max-args=1 "$tidy" --quiet \
    --checks=-bugprone-suspicious-include --extra-arg-before=-std=c++17 -p "$2" <"$1"
}
cat "$work/test_units" "$work/source_units" "$work/alone/units"
check "$work/test_units" "$work/tests"
check "$work/source_units" "$work/unity"
check "$work/alone/units" "$work/alone"
