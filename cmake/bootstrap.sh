#!/usr/bin/env bash
# Usage: cmake/bootstrap.sh [--tests]
# Installs what the build needs and the system lacks; with --tests also the browser, some 300 MB,
# that the test of report.html runs in. Debian and its kin only: elsewhere it says what is wanted and
# leaves the rest to CMake.
set -euo pipefail

packages=(
  g++ cmake make pkg-config
  libceres-dev libeigen3-dev libsuitesparse-dev libnanoflann-dev                    # library
  libgflags-dev libgoogle-glog-dev nlohmann-json3-dev zlib1g-dev libcairo2-dev      # programs
  libgtest-dev libgmock-dev                                                         # tests
)
if [[ ${1:-} == --tests ]]; then packages+=(chromium chromium-driver python3-selenium); fi

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "bootstrap: no apt-get here. The build needs what Debian calls: ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then exit 0; fi

if ((EUID == 0)); then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo env)
else
  echo "bootstrap: neither root nor sudo. Have these installed, then run this again:" >&2
  echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
  exit 1
fi

echo "bootstrap: installing ${missing[*]}"
as_root+=(DEBIAN_FRONTEND=noninteractive)
"${as_root[@]}" apt-get update
"${as_root[@]}" apt-get install --yes --no-install-recommends "${missing[@]}"
