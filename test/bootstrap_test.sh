#!/usr/bin/env bash
# Usage: bootstrap_test.sh ROOT WORK
# What cmake/bootstrap.sh and cmake/build.sh would install and configure, shown by tools that stand
# in for the real ones: nothing is installed, and no build tree is touched.
set -euo pipefail
root=$1 work=$2
rm -rf "$work"
mkdir -p "$work"/{tools,tree/cmake}
cp "$root"/cmake/{bootstrap,build}.sh "$work/tree/cmake"
export CALLS=$work/calls
for tool in apt-get cmake; do
  printf '#!/bin/sh\necho "%s $*" >>"$CALLS"\n' "$tool" >"$work/tools/$tool"
done
printf '#!/bin/sh\nexec "$@"\n' >"$work/tools/sudo"
printf '#!/bin/sh\necho not-installed\n' >"$work/tools/dpkg-query"
chmod +x "$work"/tools/*

fail() {
  echo "$1; the calls were:"
  cat "$CALLS"
  exit 1
}
# calls_of COMMAND...: what it calls, from now on in $CALLS.
calls_of() {
  : >"$CALLS"
  PATH=$work/tools:$PATH "$@" >/dev/null || fail "$* failed"
}
expect() { grep -qE -- "$1" "$CALLS" || fail "no $1"; }
expect_none() { if grep -qE -- "$1" "$CALLS"; then fail "unwanted: $1"; fi; }

# Each set has those before it.
programs='libcairo2-dev|libgflags-dev|libsqlite3-dev|nlohmann'
calls_of "$work/tree/cmake/bootstrap.sh" library
expect 'install .*libceres-dev'
expect_none "$programs|gtest"
calls_of "$work/tree/cmake/bootstrap.sh" programs
expect 'install .*libceres-dev.*libcairo2-dev.*libbz2-dev'
expect_none 'gtest|chromium|rosbag'
calls_of "$work/tree/cmake/bootstrap.sh" tests
expect 'install .*libceres-dev.*libcairo2-dev.*libgtest-dev'
expect_none 'chromium|doxygen'
calls_of "$work/tree/cmake/bootstrap.sh" all
expect 'install .*libgtest-dev'
for package in chromium doxygen pluginlib-dev petsc-dev cyclonedds-dev; do expect "$package"; done
# What cannot be installed holds up nothing else.
printf '#!/bin/sh\ncase "$*" in *chromium*) exit 100 ;; esac\necho "apt-get $*" >>"$CALLS"\n' \
  >"$work/tools/apt-get"
calls_of "$work/tree/cmake/bootstrap.sh" all 2>"$work/complaints"
for package in libgtest-dev doxygen petsc-dev libfastrtps-dev; do expect "$package"; done
grep -q "no browser" "$work/complaints" || fail "does not say what is missing"
if PATH=$work/tools:$PATH "$work/tree/cmake/bootstrap.sh" everything 2>"$CALLS"; then
  fail "took a set that there is not"
fi
expect "'everything' is none of"

# A build installs and configures what its targets need.
calls_of "$work/tree/cmake/build.sh" plumbline
expect 'BUILD_APPS=OFF.*BUILD_TESTS=OFF$'
expect 'target plumbline$'
expect_none "$programs|gtest|=ON .*=ON"
calls_of "$work/tree/cmake/build.sh" plumbline_slam plumbline
expect 'BUILD_TESTS=OFF.*BUILD_APPS=ON$'
expect_none gtest
calls_of "$work/tree/cmake/build.sh"
expect 'BUILD_APPS=ON -DPLUMBLINE_BUILD_TESTS=ON$'
expect 'target all$'
expect libgtest-dev
# A folder that has more keeps it.
mkdir "$work/tree/build"
touch "$work/tree/build/CMakeCache.txt"
calls_of "$work/tree/cmake/build.sh" plumbline
expect_none 'BUILD_APPS|BUILD_TESTS|UNITY'
