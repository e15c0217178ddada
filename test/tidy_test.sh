#!/usr/bin/env bash
# Usage: tidy_test.sh ROOT BUILD [all]
# clang-tidy over the folders that have changed since it last passed over the whole tree, or over
# everything. Most of its time goes into the headers of libraries, so it reads the units of a unity
# build, which include these once.
set -euo pipefail
tidy=clang-tidy-14 root=$1 build=$2 extent=${3:-changed}
source "$root/test/changed_since.sh"

if ! command -v "$tidy" >/dev/null; then
  echo "SKIPPED: $tidy is not installed"
  exit 77
fi
cd "$root"
work=$build/test/tidy
unity=$work/unity
rm -rf "$work"
mkdir -p "$unity/test/joined"
cp .clang-tidy "$work"
cp test/.clang-tidy "$unity/test/joined"
prefix_path=$(sed -n 's/^CMAKE_PREFIX_PATH:[^=]*=//p' "$build/CMakeCache.txt")
cmake -S . -B "$unity" -DPLUMBLINE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_PREFIX_PATH="$prefix_path" >"$work/configure.log"

# As a part of a regular expression, whatever characters the path has.
literal() { sed 's/[][(){}.*+?^$|\\]/\\&/g' <<<"$1"; }
root_re=$(literal "$root")
commands=$unity/compile_commands.json
sed -Ei 's/--param=[^ ]+//g' "$commands"  # clang knows none of gcc's parameters

# The units. The texts that the build generates are no sources of ours.
find "$unity" -name 'unity_*.cxx' -exec grep -L report_assets.cc {} + >"$work/units"
ls "$unity"/test/joined/*.cc >>"$work/units"
sed -nE "s|^ *\"file\": \"($root_re/.*\.cc)\",?$|\1|p" "$commands" | sort -u >"$work/alone"
# Sources that define flags are in no unit of the build; here they are one.
programs=$unity/programs.cc
is_program="^$root_re/apps/(program|run)/"
grep -E "$is_program" "$work/alone" | sed 's|.*|#include "&"|' >"$programs"
sed -i "s|$root_re/apps/run/slam_program\.cc|${programs//&/\\&}|" "$commands"
echo "$programs" >>"$work/units"
grep -vE "$is_program" "$work/alone" >>"$work/units"

# folders_of UNIT: where its sources are, relative to the root.
folders_of() {
  if [[ $1 == "$root"/* && $1 != "$build"/* ]]; then
    dirname "${1#"$root/"}"
  else
    sed -nE "s|^#(include\|line 1) \"$root_re/(.*)/[^/]*\"$|\2|p" "$1" | sort -u
  fi
}

# A unity build includes sources.
checks=-bugprone-suspicious-include
if [[ $extent == changed ]] && changed_since tidy >"$work/changed"; then
  sed 's|/[^/]*$||' "$work/changed" | sort -u >"$work/changed_folders"
  while read -r unit; do
    if folders_of "$unit" | grep -qxFf "$work/changed_folders"; then echo "$unit"; fi
  done <"$work/units" >"$work/selected"
  # The checks that take longest and find least wait for the whole tree: a quarter of the time.
  checks+=,-bugprone-reserved-identifier,-bugprone-stringview-nullptr
else
  mv "$work/units" "$work/selected"
fi

# The largest first, so that both processors are busy to the end.
xargs --no-run-if-empty --delimiter='\n' ls -S <"$work/selected" | tee "$work/log" |
  xargs --no-run-if-empty --delimiter='\n' --max-procs=2 --max-args=1 "$tidy" --quiet \
    --checks="$checks" --extra-arg-before=-std=c++17 -p "$unity"
cat "$work/log"
