#!/usr/bin/env bash
# Usage: tidy_test.sh CLANG_TIDY ROOT BUILD
# clang-tidy over all sources that BUILD compiles. Nearly all of its time goes into the headers of
# libraries, so that sources are joined into few units. What has a main function cannot be joined:
# of these the ones are checked that the last commit or the working tree has changed.
set -euo pipefail
tidy=$1 root=$2 build=$3

# Folders whose sources make one unit, for their anonymous namespaces have no name in common. A
# folder that is not listed makes a unit of its own; where names collide in it, change them.
joined=(
  "core factors"
  "solvers solvers/interface solvers/acceptance solvers/terms solvers/association solvers/landmarks"
  "solvers/front_end solvers/loop_closure"
  "solvers/full solvers/reduced"
  "apps/io apps/program apps/evaluation apps/convert"
  "apps/figures apps/run"
  "apps/pictures apps/simulation"
)

skip() {
  echo "SKIPPED: $1"
  exit 77
}

command -v "$tidy" >/dev/null || skip "clang-tidy-14 is not installed"
cd "$root"
work=$build/test/tidy
rm -rf "$work"
mkdir -p "$work"/{sources,tests}
cp .clang-tidy "$work/sources"
cp test/.clang-tidy "$work/tests"
commands=$build/compile_commands.json

# All sources that are compiled, relative to the root; what has a main function apart.
sed -nE "s|^ *\"file\": \"$root/(.*\.cc)\",?$|\1|p" "$commands" | grep -v "^${build#"$root/"}/" |
  sort -u >"$work/all"
xargs grep -lE '^int main\(|LLVMFuzzerTestOneInput' <"$work/all" >"$work/alone" || true
grep -vxFf "$work/alone" "$work/all" >"$work/joinable"

# add_unit NAME FOLDER...
add_unit() {
  local name=$1 folder file
  shift
  for folder in "$@"; do
    grep -E "^$folder/[^/]+$" "$work/joinable" | while read -r file; do
      echo "#include \"$root/$file\""
    done
  done >"$work/sources/$name.cc"
}
listed=" ${joined[*]} "
for i in "${!joined[@]}"; do
  read -ra folders <<<"${joined[$i]}"
  add_unit "joined$i" "${folders[@]}"
done
grep -v '^test/' "$work/joinable" | xargs dirname | sort -u | while read -r folder; do
  [[ $listed == *" $folder "* ]] || add_unit "${folder//\//_}" "$folder"
done

# Tests are nothing but an anonymous namespace each, which gets a name of its own.
number=0
while read -r file; do
  layer=${file#test/}
  number=$((number + 1))
  {
    echo "#line 1 \"$root/$file\""
    sed "s/^namespace {\$/namespace unit_$number {/" "$file"
  } >>"$work/tests/${layer%%/*}.cc"
done < <(grep '^test/' "$work/joinable")

# What the last change touched of the rest.
if git rev-parse --quiet --verify HEAD~1 >/dev/null 2>&1; then
  {
    git diff --name-only --relative --diff-filter=d HEAD~1 -- '*.cc'
    git ls-files --others --exclude-standard -- '*.cc'
  } | grep -xFf - "$work/alone" | sed "s|^|$root/|" >"$work/changed" || true
fi

# All units see the definitions and the folders of headers of all sources, which do not contradict
# one another. Those that are alone are compiled as they are, but clang reads no precompiled header
# of gcc and knows none of its parameters.
flags=$(grep -oE ' (-D|-I|-isystem )[^ ]+' "$commands" | sort -u | tr -d '\n')
mkdir "$work/alone_commands"
sed -E 's/-Winvalid-pch|--param=[^ ]+|(-Xclang )?-include(-pch)? (-Xclang )?[^ ]+cmake_pch[^ ]+//g' \
  "$commands" >"$work/alone_commands/compile_commands.json"
{
  echo '['
  separator=''
  for unit in "$work"/{sources,tests}/*.cc; do
    printf '%s{"directory": "%s", "file": "%s", "command": "clang++ -std=c++17%s -c %s"}\n' \
      "$separator" "$work" "$unit" "$flags" "$unit"
    separator=,
  done
  echo ']'
} >"$work/compile_commands.json"

check() {
  xargs --no-run-if-empty --max-procs=2 --max-args=1 "$tidy" --quiet \
    --checks=-bugprone-suspicious-include --extra-arg-before=-std=c++17 -p "$1"
}
echo "$(wc -l <"$work/joinable") sources in $(ls "$work"/{sources,tests}/*.cc | wc -l) units," \
  "$(wc -l <"$work/changed" 2>/dev/null || echo 0) alone"
# The largest first, so that both processors are busy to the end.
ls -S "$work"/{tests,sources}/*.cc | check "$work"
if [[ -s $work/changed ]]; then check "$work/alone_commands" <"$work/changed"; fi
