#!/usr/bin/env bash
# Usage: headers_test.sh ROOT BUILD
# Compiles alone every header that has changed since all of them were checked.
set -euo pipefail
root=$1 build=$2
source "$root/test/changed_since.sh"

changed=$(changed_since headers) || changed=$(cd "$root" && find core factors solvers apps -name '*.h')
# Each header has a source of its own in the build, which the build does not compile.
for header in $(grep '\.h$' <<<"$changed"); do
  sed -nE "s|^ *\"command\": \"(.*/test/headers/$header\.cc)\",?$|\1|p" "$build/compile_commands.json"
done | sed 's/\\"/"/g' >"$build/test/header_commands"
echo "headers: $(wc -l <"$build/test/header_commands")"
tr '\n' '\0' <"$build/test/header_commands" |
  xargs --null --no-run-if-empty --max-procs=2 --max-args=1 bash -c 'eval "$1 -fsyntax-only"' bash
