#!/usr/bin/env bash
# Usage: cmake/build.sh [TARGET...]
# Bootstraps, configures build/ for Release and builds the targets there (default: everything). A
# build folder that is there keeps its settings, one from scratch is a unity build.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/cmake/bootstrap.sh"
unity=()
if [[ ! -f $root/build/CMakeCache.txt ]]; then unity=(-DPLUMBLINE_UNITY_BUILD=ON); fi
cmake -S "$root" -B "$root/build" -DCMAKE_BUILD_TYPE=Release ${unity[@]+"${unity[@]}"}
cmake --build "$root/build" --parallel "$(nproc)" --target "${@:-all}"
