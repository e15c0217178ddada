#!/usr/bin/env bash
# Usage: datasets/fetch.sh DIR            downloads the real logs that README.md describes into DIR
#        datasets/fetch.sh --verify DIR   only checks the files that are there
# Files already in DIR with the right checksum are kept. Logs are stored gzip-compressed; the
# checksums are those of their uncompressed content. Exits with 0 if all files are in place.
set -euo pipefail

# Kuemmerle et al., SLAM Benchmarking; page: .../slamevaluation/datasets.php
freiburg_url=${PLUMBLINE_FREIBURG_URL:-http://ais.informatik.uni-freiburg.de/slamevaluation/datasets}

# Name, address, sha256.
files=(
  "fr079.clf.gz $freiburg_url/fr079.clf d7ef6348cf29c2b71702f3a3ac779cb19a28184e11a031ee4150ec3b5f4696e6"
  "fr079.relations $freiburg_url/fr079.relations 7e7f06b4aca455cb68f1f23d04e7c7316c5e17773e872734c860ed7a274cdfc7"
  "intel.clf.gz $freiburg_url/intel.clf 8db0ad6231b48bad4118e6a2dc78e83213b2c306be3b4ed80a90969891abfe7b"
  "intel.relations $freiburg_url/intel.relations 330378f153eeae652d6756c1746f335801f66c3e097d90611548e6c4f593c359"
)

fail() {
  echo "fetch.sh: $*" >&2
  exit 1
}

# content FILE: its uncompressed content.
content() {
  case $1 in
    *.gz) gzip -dc -- "$1" ;;
    *) cat -- "$1" ;;
  esac
}

# checksum FILE: sha256 of its content; empty if it is damaged.
checksum() {
  if command -v sha256sum >/dev/null; then
    content "$1" 2>/dev/null | sha256sum | cut -d' ' -f1 || true
  else
    content "$1" 2>/dev/null | shasum -a 256 | cut -d' ' -f1 || true
  fi
}

# state FILE SHA256: "ok", "missing" or "damaged".
state() {
  if [[ ! -f $1 ]]; then
    echo missing
  elif [[ $(checksum "$1") == "$2" ]]; then
    echo ok
  else
    echo damaged
  fi
}

# download URL FILE
download() {
  if command -v curl >/dev/null; then
    curl --fail --location --silent --show-error --retry 2 --connect-timeout 20 \
      --output "$2" -- "$1"
  elif command -v wget >/dev/null; then
    wget --no-verbose --tries=3 --timeout=20 --output-document="$2" -- "$1"
  else
    fail "needs curl or wget"
  fi
}

verify() {
  local all_ok=0 entry name url sha256 result
  for entry in "${files[@]}"; do
    read -r name url sha256 <<<"$entry"
    result=$(state "$1/$name" "$sha256")
    echo "$result  $1/$name"
    [[ $result == ok ]] || all_ok=1
  done
  return "$all_ok"
}

# A file appears under its name only when it is whole and its checksum is right.
fetch() {
  local entry name url sha256
  for entry in "${files[@]}"; do
    read -r name url sha256 <<<"$entry"
    [[ $(state "$1/$name" "$sha256") == ok ]] && continue
    echo "downloading $url"
    download "$url" "$work/raw" ||
      fail "cannot download $url: is there a network? The page may have moved: see README.md"
    [[ $(checksum "$work/raw") == "$sha256" ]] ||
      fail "$url is not the file it was: its sha256 is $(checksum "$work/raw"), not $sha256"
    if [[ $name == *.gz ]]; then
      gzip -9 -n -c "$work/raw" >"$work/ready"
    else
      mv "$work/raw" "$work/ready"
    fi
    mv "$work/ready" "$1/$name"
  done
}

if (($# == 2)) && [[ $1 == --verify ]]; then
  [[ -d $2 ]] || fail "no folder '$2'"
  verify "$2"
elif (($# == 1)) && [[ $1 != -* ]]; then
  mkdir -p -- "$1" || fail "cannot make the folder '$1'"
  work=$(mktemp -d "$1/.fetch.XXXXXX") || fail "cannot write to '$1'"
  trap 'rm -rf -- "$work"' EXIT
  fetch "$1"
  verify "$1"
else
  sed -n '2,5s/^# //p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
