#!/usr/bin/env bash
# Usage: tidy_test.sh CLANG_TIDY ROOT BUILD
# clang-tidy over all sources that BUILD compiles, but over tests and over what has a main function
# only if the last commit or the working tree has changed them, or one beside them. Nearly all of its
# time goes into the headers of libraries, so it looks at the units of a unity build.
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
mkdir -p "$work"/{unity/test/joined,alone}
cp .clang-tidy "$work"
cp test/.clang-tidy "$work/unity/test/joined"
commands=$build/compile_commands.json
prefix_path=$(sed -n 's/^CMAKE_PREFIX_PATH:[^=]*=//p' "$build/CMakeCache.txt")
cmake -S . -B "$work/unity" -DPLUMBLINE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_PREFIX_PATH="$prefix_path" >"$work/configure.log"

# What the last change touched; everything where nothing is known of it.
if git rev-parse --quiet --verify HEAD~1 >/dev/null 2>&1; then
  git diff --name-only --relative --diff-filter=d HEAD~1 >"$work/changed"
  git ls-files --others --exclude-standard >>"$work/changed"
else
  find apps test -name '*.cc' >"$work/changed"
fi

# As a part of a regular expression, whatever characters the path has.
literal() { sed 's/[][(){}.*+?^$|\\]/\\&/g' <<<"$1"; }
root_re=$(literal "$root") build_re=$(literal "$build")

# clang reads no precompiled header of gcc and knows none of its parameters.
pch='(\\"[^"]*cmake_pch[^"]*"|[^ ]+cmake_pch[^ ]+)'  # quoted where the path has blanks
for_clang="s/-Winvalid-pch|--param=[^ ]+|(-Xclang )?-include(-pch)? (-Xclang )?$pch//g"
sed -Ei "$for_clang" "$work/unity/compile_commands.json"
sed -E "$for_clang" "$commands" >"$work/alone/compile_commands.json"

# The largest first, so that both processors are busy to the end. Texts that the build makes are no
# sources.
for unit in "$work"/unity/test/joined/*.cc; do
  if sed -nE "s|^#line 1 \"$root_re/(.*)\"$|\1|p" "$unit" | grep -xFf "$work/changed" >/dev/null; then
    echo "$unit"
  fi
done >"$work/test_units"
find "$work/unity" -name 'unity_*.cxx' -exec grep -L report_assets.cc {} + |
  xargs -r -d '\n' ls -S >"$work/source_units"
sed -nE "s|^ *\"file\": \"($root_re/.*\.cc)\",?$|\1|p" "$work/unity/compile_commands.json" |
  grep -vE "_main\.cc$|^$root_re/apps/examples/|^$root_re/test/|^$build_re/" |
  sort -u >"$work/no_unity"
grep -vE "^$root_re/apps/(program|run)/" "$work/no_unity" >>"$work/source_units"
# What the unity build leaves out of its units, mostly for the sake of flags, in one unit all the
# same.
programs=$work/unity/programs.cc
grep -E "^$root_re/apps/(program|run)/" "$work/no_unity" | sed 's|.*|#include "&"|' >"$programs"
sed -i "s|$root_re/apps/run/slam_program\.cc|${programs//&/\\&}|" "$work/unity/compile_commands.json"
echo "$programs" >>"$work/source_units"
sed -nE "s|^ *\"file\": \"$root_re/(.*\.cc)\",?$|\1|p" "$commands" |
  grep -E '_main\.cc$|^apps/examples/|^test/fuzz/' | grep -xFf "$work/changed" |
  sed "s|^|$root/|" >"$work/alone/units" || true

# What takes longest and finds least is left to `test/check.sh tidy`: a quarter of the time.
skipped=-bugprone-suspicious-include,-bugprone-reserved-identifier,-bugprone-stringview-nullptr

# check UNITS COMMANDS
check() {
  xargs --no-run-if-empty --delimiter='\n' --max-procs=2 --max-args=1 "$tidy" --quiet \
    --checks="$skipped" --extra-arg-before=-std=c++17 -p "$2" <"$1"
}
cat "$work/test_units" "$work/source_units" "$work/alone/units"
check "$work/test_units" "$work/unity"
check "$work/source_units" "$work/unity"
check "$work/alone/units" "$work/alone"
