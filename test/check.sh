#!/usr/bin/env bash
# Usage: test/check.sh [--resume] [--commit=REVISION] CHECK...
# Checks that are too slow for every change. CHECK is one of
#   sanitizers  all tests under AddressSanitizer and UndefinedBehaviorSanitizer: clang, Debug
#   threads     all tests under ThreadSanitizer: gcc, Debug
#   coverage    all tests; they have to reach 97 % of the lines of core, factors and solvers each
#   compilers   all tests with gcc and with clang, Release. The gcc build is no unity build, which
#               would hide a missing include
#   headers     every header compiles alone
#   tidy        clang-tidy over everything, by the rules of .clang-tidy
#   kills       500 runs of the programs, killed or stopped at random times
#   fuzz        every fuzz target for 600 s of processor time
#   NAME_fuzz   that fuzz target
#   all         all of these in the background
# Checks the given commit (default: HEAD), not the working tree, so that work can go on meanwhile,
# and writes the results to test/checks.md. --resume skips a check that has passed at that commit or
# at one with the same sources. Builds are in build-checks/, and so are logs. Warnings are errors
# everywhere. Tests on real logs run if PLUMBLINE_DATASETS names their folder. Needs clang,
# clang-tidy and gcovr besides what cmake/bootstrap.sh all installs; takes ninja where there is one.
set -euo pipefail

script=$(readlink -f "${BASH_SOURCE[0]}")
root=$(dirname "$(dirname "$script")")
table=$root/test/checks.md
work=$root/build-checks
source=$work/source  # the commit that is checked
jobs=$(nproc)
kills=500
fuzz_s=600
# Fast enough for the tests, with asserts and the lines of what is found.
debug=(-DCMAKE_BUILD_TYPE=Debug "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1")
# Tests without code of the library, or with a compiler of their own.
elsewhere='^(un)?install|^(shared_)?consumer_|^(public_headers|readme_code|shared_library|headers)$'
elsewhere+='|^(api_reference|report_browser|packages|bootstrap|ros2_package|slam_toolbox_package|format|tidy)$'

# configure FOLDER COMPILER CMAKE_ARGUMENT...
configure() {
  local build=$work/$1 compiler=$2
  shift 2
  local generator=()
  if [[ ! -f $build/CMakeCache.txt ]] && command -v ninja >/dev/null; then generator=(-G Ninja); fi
  cmake -S "$source" -B "$build" "${generator[@]}" -DCMAKE_CXX_COMPILER="$compiler" \
    -DPLUMBLINE_WERROR=ON -DPLUMBLINE_UNITY_BUILD=ON -DPLUMBLINE_TEST_COMPILER= "$@"
}

build() { cmake --build "$work/$1" --parallel "$jobs" "${@:2}"; }

# run_tests FOLDER CTEST_ARGUMENT...
run_tests() { (cd "$work/$1" && ctest --output-on-failure --no-tests=error -j"$jobs" "${@:2}"); }

# run_sanitized FOLDER: findings go to files. A test that wants a program to fail would not notice
# what made it fail.
run_sanitized() {
  local findings=$work/$1/findings common failed=0
  common=log_path=$findings/report:halt_on_error=1
  rm -rf "$findings"
  mkdir "$findings"
  ASAN_OPTIONS=$common UBSAN_OPTIONS=$common:print_stacktrace=1 \
    TSAN_OPTIONS=$common:suppressions=$source/test/thread_suppressions.txt \
    run_tests "$1" --exclude-regex "$elsewhere" || failed=1
  if [[ -n $(ls -A "$findings") ]]; then
    cat "$findings"/*
    failed=1
  fi
  return "$failed"
}

sanitizers() {
  configure sanitizers clang++ "${debug[@]}" -DPLUMBLINE_BUILD_FUZZERS=ON
  build sanitizers
  run_sanitized sanitizers
}

threads() {
  configure threads g++ "${debug[@]}" -DPLUMBLINE_SANITIZE=thread
  build threads
  run_sanitized threads
}

coverage() {
  local folder failed=0
  configure coverage g++ "${debug[@]}" "-DCMAKE_CXX_FLAGS=--coverage -fprofile-update=atomic"
  build coverage
  find "$work/coverage" -name '*.gcda' -delete
  # A test fills the disk, and what gcov says of that is not for the program's standard error.
  GCOV_ERROR_FILE=/dev/null run_tests coverage --exclude-regex "$elsewhere" || failed=1
  gcovr --root "$source" -j "$jobs" --json "$work/coverage.json" "$work/coverage"
  for folder in core factors solvers; do
    gcovr --root "$source" --add-tracefile "$work/coverage.json" --filter "$source/$folder/" \
      --fail-under-line 97 || failed=1
  done
  return "$failed"
}

compilers() {
  configure g++ g++ -DCMAKE_BUILD_TYPE=Release -DPLUMBLINE_UNITY_BUILD=OFF
  build g++
  run_tests g++ --exclude-regex '^tidy$'
  configure clang++ clang++ -DCMAKE_BUILD_TYPE=Release
  build clang++
  run_tests clang++ --exclude-regex '^tidy$'
}

headers() {
  configure headers g++ -DCMAKE_BUILD_TYPE=Debug
  build headers --target plumbline_headers
}

tidy() {
  configure headers g++ -DCMAKE_BUILD_TYPE=Debug
  "$source/test/tidy_test.sh" "$source" "$work/headers" all
}

kills() {
  configure sanitizers clang++ "${debug[@]}" -DPLUMBLINE_BUILD_FUZZERS=ON
  build sanitizers --target plumbline_apps_tests
  PLUMBLINE_KILLS=$kills "$work/sanitizers/test/plumbline_apps_tests" --gtest_filter='KillTest.*'
}

# A line per fuzz target: its name, and the folder of test/corpus that it begins with.
fuzz_targets=$(sed -n 's/^plumbline_fuzz_target(\([a-z_0-9]*\) \([a-z_]*\))$/\1 \2/p' \
  "$root/test/fuzz/CMakeLists.txt")

# fuzz TARGET: ends with the first finding.
fuzz() {
  local folder=$work/fuzz/$1 corpus TIMEFORMAT='%0U' used=0
  corpus=$source/test/corpus/$(sed -n "s/^$1 //p" <<<"$fuzz_targets")
  (
    flock 9
    configure sanitizers clang++ "${debug[@]}" -DPLUMBLINE_BUILD_FUZZERS=ON
    build sanitizers --target plumbline_fuzzers
  ) 9>"$work/build_lock"
  # The targets read files, which belong in memory.
  if [[ -w /dev/shm ]]; then export TMPDIR=/dev/shm; fi
  mkdir -p "$folder/found"
  cd "$folder"  # where a finding is written
  while ((used < fuzz_s)); do
    { time "$work/sanitizers/bin/$1" -max_total_time=60 -dict="$source/test/fuzz/records.dict" \
      found "$corpus" 2>&1 | tail -n 50; } 2>user_s
    used=$((used + $(tail -n 1 user_s)))
  done
}

# inputs_of CHECK: the paths that its result depends on, for git.
inputs_of() {
  case $1 in
    headers | tidy) echo '*.h' '*.cc' '*.clang-tidy' ;;
    *_fuzz)  # the readers, and what they call
      echo core factors solvers/pose_graph apps/{io,bags,saved_maps,evaluation,program,simulation} \
        test/fuzz test/corpus
      ;;
    *) echo . ':!*.md' ;;
  esac
}

# has_passed CHECK: whether it has passed and its inputs are still the same.
has_passed() {
  local passed inputs
  read -ra inputs <<<"$(inputs_of "$1")"
  passed=$(sed -nE "s/^\| $1 \| passed \| ([0-9a-f]+) \|.*/\1/p" "$table")
  [[ -n $passed ]] && git -C "$root" cat-file -e "$passed^{commit}" 2>/dev/null &&
    git -C "$root" diff --quiet "$passed" "$commit" -- "${inputs[@]}"
}

# run_check CHECK: sets result, and writes the check's row of the table in place of the last one.
run_check() {
  local command=$1 begin=$SECONDS row
  result=passed
  if [[ $1 == *_fuzz ]]; then command="fuzz $1"; fi
  echo "$1: begins, see $work/$1.log"
  set +e
  (
    set -e
    $command
  ) >"$work/$1.log" 2>&1
  if (($? != 0)); then result=FAILED; fi
  set -e
  row="| $1 | $result | ${commit:0:10} | $(date --iso-8601) | $((SECONDS - begin)) |"
  (
    flock 9
    sed -i "/^| $1 |/d" "$table"
    echo "$row" >>"$table"
  ) 9>"$work/table_lock"
  echo "$1: $result in $((SECONDS - begin)) s"
}

# parse ARGUMENT...: sets wanted, commit, options and background.
parse() {
  local revision=HEAD check
  wanted=()
  options=()
  background=no
  for check; do
    case $check in
      --resume) options=(--resume) ;;
      --commit=*) revision=${check#--commit=} ;;
      headers | tidy | coverage | compilers | sanitizers | threads | kills | *_fuzz) wanted+=("$check") ;;
      fuzz) mapfile -t -O "${#wanted[@]}" wanted < <(sed 's/ .*//' <<<"$fuzz_targets") ;;
      all)
        background=yes
        wanted=(headers tidy coverage compilers sanitizers threads kills fuzz)
        ;;
      *) usage ;;
    esac
  done
  if ((${#wanted[@]} == 0)); then usage; fi
  commit=$(git -C "$root" rev-parse --verify "$revision^{commit}")
}

usage() {
  sed -n '2,/^set /s/^# \{0,1\}//p' "$script" | head -n -1 >&2
  exit 2
}

# require_tools CHECK...: a tool that is missing is better noticed before a check than after it.
require_tools() {
  local check tool missing=()
  for check; do
    case $check in
      coverage) tool=gcovr ;;
      tidy) tool=clang-tidy ;;
      compilers | sanitizers | kills | *_fuzz) tool=clang++ ;;
      *) continue ;;
    esac
    if ! command -v "$tool" >/dev/null; then missing+=("$check needs $tool."); fi
  done
  if ((${#missing[@]} == 0)); then return; fi
  printf 'check.sh: %s\n' "${missing[@]}" >&2
  exit 1
}

main() {
  local check failed=0
  parse "$@"
  require_tools "${wanted[@]}"
  mkdir -p "$work"
  if [[ $background == yes ]]; then
    setsid --fork "$script" "${options[@]}" --commit="$commit" "${wanted[@]}" \
      </dev/null >"$work/log" 2>&1
    echo "check.sh: runs in the background, see $work/log"
    return
  fi
  if [[ ! -d $source ]]; then git clone --quiet --shared --no-checkout "$root" "$source"; fi
  git -C "$source" fetch --quiet origin "$commit"
  git -C "$source" checkout --quiet --detach "$commit"

  for check in "${wanted[@]}"; do
    if [[ ${options[*]} == --resume ]] && has_passed "$check"; then
      echo "$check: has passed, and nothing has changed"
    elif [[ $check == *_fuzz ]]; then  # as many at a time as there are processors
      while (($(jobs -rp | wc -l) >= jobs)); do wait -n || failed=1; done
      {
        run_check "$check"
        [[ $result == passed ]]
      } &
    else
      # Not behind ||, where bash would go on after the first error of a check, and not in the
      # background, where SIGINT is ignored.
      run_check "$check"
      if [[ $result != passed ]]; then failed=1; fi
    fi
  done
  while (($(jobs -p | wc -l) > 0)); do wait -n || failed=1; done
  return "$failed"
}

main "$@"
exit
