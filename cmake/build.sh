#!/usr/bin/env bash
# Usage: cmake/build.sh [TARGET...]
# Bootstraps, configures build/ for Release and builds the targets there (default: everything). What
# it installs and configures is what these need: the library (`plumbline`), a program
# (`plumbline_slam`), or all with the tests. Otherwise a build folder that is there keeps its
# settings; one from scratch is a unity build.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
set=library
for target in "${@:-all}"; do
  case $target in
    plumbline) ;;
    plumbline_io | plumbline_slam | plumbline_simulate | plumbline_evaluate | plumbline_convert | \
      plumbline_benchmark | plumbline_live)
      if [[ $set == library ]]; then set=programs; fi ;;
    *) set=tests ;;
  esac
done

settings=()
if [[ ! -f $root/build/CMakeCache.txt ]]; then
  settings=(-DPLUMBLINE_UNITY_BUILD=ON -DPLUMBLINE_BUILD_IO=OFF -DPLUMBLINE_BUILD_APPS=OFF
            -DPLUMBLINE_BUILD_TESTS=OFF)
fi
if [[ $set != library ]]; then
  settings+=(-DPLUMBLINE_BUILD_IO=ON -DPLUMBLINE_BUILD_APPS=ON)
fi
if [[ $set == tests ]]; then settings+=(-DPLUMBLINE_BUILD_TESTS=ON); fi
"$root/cmake/bootstrap.sh" "$set"
cmake -S "$root" -B "$root/build" -DCMAKE_BUILD_TYPE=Release ${settings[@]+"${settings[@]}"}
cmake --build "$root/build" --parallel "$(nproc)" --target "${@:-all}"
