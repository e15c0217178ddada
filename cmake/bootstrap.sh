#!/usr/bin/env bash
# Usage: cmake/bootstrap.sh [library | programs | tests | all]
# Installs what a build needs and the system lacks: of the library alone, of the programs too, or of
# the tests as well (the default). `all` adds what tests can do without: doxygen for the API
# reference, clang-format, clang-tidy, other locales, what the Python module needs, the browser that
# report.html is tested in (450 MB), what the plug-in of slam_toolbox builds and loads with (190 MB),
# MPI with PETSc, for plumbline_slam_mpi (400 MB), and DDS, for plumbline_live and the robot that it
# is tested with.
# Debian and its kin only: elsewhere it says what is wanted and leaves the rest to CMake.
set -euo pipefail

packages=(
  g++ cmake make pkg-config
  libceres-dev libeigen3-dev libsuitesparse-dev libnanoflann-dev
)
programs=(
  libgflags-dev libgoogle-glog-dev nlohmann-json3-dev zlib1g-dev libcairo2-dev libpng-dev
  libsqlite3-dev liblz4-dev libzstd-dev libbz2-dev libyaml-cpp-dev  # bags of ROS
)
tests=(libgtest-dev libgmock-dev clang-14 ccache)
browser=(chromium-headless-shell)
python=(pybind11-dev python3-dev python3-numpy python3-pytest)
mpi=(petsc-dev libopenmpi-dev openmpi-bin)
dds=(cyclonedds-dev libfastrtps-dev libfastcdr-dev)
plugin=(ament-cmake pluginlib-dev libtbb-dev libboost-dev)

wanted=${1:-tests}
case $wanted in
  library) ;;
  programs) packages+=("${programs[@]}") ;;
  tests | all) packages+=("${programs[@]}" "${tests[@]}") ;;
  *)
    echo "bootstrap: '$wanted' is none of library, programs, tests, all" >&2
    exit 2
    ;;
esac

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "bootstrap: no apt-get here. The build needs what Debian calls: ${packages[*]}" >&2
  if [[ $wanted != library ]]; then
    echo "bootstrap: the Python module wants ${python[*]}, plumbline_slam_mpi ${mpi[*]}," \
      "plumbline_live ${dds[*]}" >&2
  fi
  exit 0
fi

# Installs the packages that are missing.
install_missing() {
  local package status missing=()
  for package in "$@"; do
    status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
    [[ $status == installed ]] || missing+=("$package")
  done
  if ((${#missing[@]} == 0)); then return 0; fi

  local as_root=(env)
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      echo "bootstrap: neither root nor sudo. Have these installed, then run this again:" >&2
      echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo env)
  fi
  echo "bootstrap: installing ${missing[*]}"
  as_root+=(DEBIAN_FRONTEND=noninteractive)
  "${as_root[@]}" apt-get update &&
    "${as_root[@]}" apt-get install --yes --no-install-recommends "${missing[@]}"
}

# optional MESSAGE PACKAGE...: prints MESSAGE if the packages cannot be installed.
optional() { install_missing "${@:2}" || echo "bootstrap: $1" >&2; }

if [[ $wanted != all ]]; then
  install_missing "${packages[@]}"
  exit
fi
tools=(doxygen git clang-tidy-14 clang-format-14 locales)
# One call of apt-get takes half the time of one call per set.
if install_missing "${packages[@]}" "${tools[@]}" "${python[@]}" "${browser[@]}" "${plugin[@]}" \
  "${mpi[@]}" "${dds[@]}"; then
  exit
fi
install_missing "${packages[@]}"
optional "no doxygen; the API reference is not tested" doxygen
optional "no clang-tidy-14; the test tidy is skipped" git clang-tidy-14
optional "no clang-format-14; formatting is not tested" clang-format-14
optional "no locales; the test of decimal commas is skipped" locales
optional "no pybind11; the Python module is not built" "${python[@]}"
optional "no browser; the test of report.html is skipped" "${browser[@]}"
optional "no ament; the plug-in of slam_toolbox is not built" "${plugin[@]}"
optional "no PETSc; plumbline_slam_mpi is not built" "${mpi[@]}"
optional "no Cyclone DDS; plumbline_live is not built" "${dds[@]}"
