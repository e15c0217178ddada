#!/usr/bin/env bash
# Usage: test/check.sh CHECK
# Checks that are too slow for every change, each in a build folder of its own. CHECK is one of
#   sanitizers      all tests under AddressSanitizer and UndefinedBehaviorSanitizer: clang, Debug
#   threads         all tests under ThreadSanitizer: gcc, Debug. They have to reach 90 % of the
#                   lines of core, factors and solvers each
#   compilers       all tests with gcc and with clang, Release; Debug is what the two above build
#   tidy            clang-tidy over everything, by the rules of .clang-tidy
#   fuzz [SECONDS]  every fuzz target for SECONDS each (default: 600)
#   kills [N]       N runs of the programs (default: 500), killed or stopped at random times
# Warnings are errors everywhere. Tests on real logs run if PLUMBLINE_DATASETS names their folder.
# Needs clang, clang-tidy and gcovr besides what cmake/bootstrap.sh all installs; takes ninja
# where there is one.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=$(nproc)
# Fast enough for the tests, with asserts and the lines of what is found.
debug=(-DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1")
# What compiles, installs or shows elsewhere has nothing to say to sanitizers.
elsewhere='^(un)?install|^(shared_)?consumer_|^(public_headers|readme_code|shared_library)$'
elsewhere+='|^(api_reference|report_browser|packages|bootstrap|slam_toolbox_package)$'

# configure FOLDER COMPILER CMAKE_ARGUMENT...
configure() {
  local build=$1 compiler=$2
  shift 2
  local generator=()
  if [[ ! -f $build/CMakeCache.txt ]] && command -v ninja >/dev/null; then generator=(-G Ninja); fi
  cmake -S "$root" -B "$build" "${generator[@]}" -DCMAKE_CXX_COMPILER="$compiler" \
    -DPLUMBLINE_WERROR=ON "$@"
}

# run_tests FOLDER CTEST_ARGUMENT...
run_tests() {
  local build=$1
  shift
  (cd "$build" && ctest --output-on-failure --no-tests=error -j"$jobs" "$@")
}

# run_sanitized FOLDER: findings go to files. A test that wants a program to fail would not notice
# what made it fail.
run_sanitized() {
  local findings=$1/findings common failed=0
  common=log_path=$findings/report:halt_on_error=1
  rm -rf "$findings"
  mkdir "$findings"
  ASAN_OPTIONS=$common UBSAN_OPTIONS=$common:print_stacktrace=1 \
    TSAN_OPTIONS=$common:suppressions=$root/test/thread_suppressions.txt \
    run_tests "$1" --exclude-regex "$elsewhere" || failed=1
  if [[ -n $(ls -A "$findings") ]]; then
    cat "$findings"/*
    failed=1
  fi
  return "$failed"
}

configure_sanitizers() {
  configure "$root/build-sanitizers" clang++ "${debug[@]}" -DPLUMBLINE_BUILD_FUZZERS=ON
}

sanitizers() {
  configure_sanitizers
  cmake --build "$root/build-sanitizers" --parallel "$jobs"
  run_sanitized "$root/build-sanitizers"
}

threads() {
  local build=$root/build-threads folder failed=0
  configure "$build" g++ "${debug[@]}" -DPLUMBLINE_SANITIZE=thread \
    -DCMAKE_CXX_FLAGS="--coverage -fprofile-update=atomic"
  cmake --build "$build" --parallel "$jobs"
  find "$build" -name '*.gcda' -delete
  # A test fills the disk, and what gcov says of that is not for the program's standard error.
  GCOV_ERROR_FILE=/dev/null run_sanitized "$build" || failed=1
  gcovr --root "$root" -j "$jobs" --json "$build/coverage.json" "$build"
  for folder in core factors solvers; do
    gcovr --root "$root" --add-tracefile "$build/coverage.json" --filter "$root/$folder/" \
      --fail-under-line 90 || failed=1
  done
  return "$failed"
}

compilers() {
  local compiler build
  for compiler in g++ clang++; do
    build=$root/build-$compiler
    configure "$build" "$compiler" -DCMAKE_BUILD_TYPE=Release
    cmake --build "$build" --parallel "$jobs"
    run_tests "$build"
  done
}

tidy() {
  # Nothing is built here, so there is no precompiled header to read.
  configure "$root/build-tidy" clang++ "${debug[@]}" -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
  run-clang-tidy -quiet -j "$jobs" -p "$root/build-tidy" "^$root/(core|factors|solvers|apps|test)/"
}

# fuzz_one SECONDS TARGET CORPUS
fuzz_one() {
  local work=$root/build-sanitizers/fuzz/$2
  mkdir -p "$work/found"
  cd "$work"  # where a finding is written
  if ! "$root/build-sanitizers/bin/$2" -max_total_time="$1" \
    -dict="$root/test/fuzz/records.dict" found "$root/test/corpus/$3" >log 2>&1; then
    tail -n 50 log
    echo "$2: a finding, see $work"
    return 1
  fi
  echo "$2: $(tail -n 1 log)"
}

fuzz() {
  configure_sanitizers
  cmake --build "$root/build-sanitizers" --parallel "$jobs" --target plumbline_fuzzers
  # The targets read files, which belong in memory.
  if [[ -w /dev/shm ]]; then export TMPDIR=/dev/shm; fi
  export root
  export -f fuzz_one
  sed -n 's/^ *plumbline_fuzz_target(\([a-z_]*\) \([a-z_]*\))$/\1 \2/p' \
    "$root/test/fuzz/CMakeLists.txt" |
    xargs -P "$jobs" -L 1 bash -euo pipefail -c 'fuzz_one "$@"' fuzz_one "${1:-600}"
}

kills() {
  local build=$root/build-g++
  configure "$build" g++ -DCMAKE_BUILD_TYPE=Release
  cmake --build "$build" --parallel "$jobs" --target plumbline_apps_tests
  PLUMBLINE_KILLS=${1:-500} "$build/test/plumbline_apps_tests" --gtest_filter='KillTest.*'
}

case ${1:-} in
  sanitizers | threads | compilers | tidy | fuzz | kills) "$@" ;;
  *)
    sed -n '2,/^set /s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
    ;;
esac
