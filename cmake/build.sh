#!/usr/bin/env bash
# Usage: cmake/build.sh [TARGET...]
# Bootstraps, configures build/ for Release and builds the targets there (default: everything).
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/cmake/bootstrap.sh"
cmake -S "$root" -B "$root/build" -DCMAKE_BUILD_TYPE=Release
cmake --build "$root/build" --parallel "$(nproc)" --target "${@:-all}"
