#!/usr/bin/env bash
# Usage: apps/demo.sh [LOG] [--plumbline_slam_flag...]
# Builds the programs and maps LOG: a CARMEN log (plain or .gz), or a ROS bag. Without LOG, simulates a drive
# through a small building first and compares the map with the truth. Results: demo_output/.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
output=$root/demo_output
log=
if (($# > 0)) && [[ $1 != -* ]]; then
  log=$1
  shift
  if [[ ! -r $log ]]; then
    echo "demo.sh: cannot read a log at '$log'" >&2
    exit 1
  fi
fi

"$root/cmake/build.sh" plumbline_slam plumbline_simulate
mkdir -p "$output"
compare=()
if [[ -z $log ]]; then
  log=$output/small_building.clf
  compare=(--truth="$output/truth.tum" --hits="$output/hits.txt")
  "$root/build/bin/plumbline_simulate" --world="$root/datasets/small_building.world" \
    --log="$log" "${compare[@]}"
fi
"$root/build/bin/plumbline_slam" --log="$log" --output_dir="$output" "${compare[@]}" "$@"
