#!/usr/bin/env bash
# Usage: pkg_config_test.sh PREFIX LIBDIR COMPILER SOURCE WORK_FOLDER [FLAG...]
# Builds and runs a program with nothing but what pkg-config says of the library in PREFIX.
set -euo pipefail

prefix=$1 libdir=$2 compiler=$3 source=$4 work=$5
shift 5
export PKG_CONFIG_PATH=$prefix/$libdir/pkgconfig
mkdir -p "$work"
read -ra flags <<<"$(pkg-config --cflags --libs plumbline)"
"$compiler" -std=c++17 "$@" "$source" -o "$work/consumer" "${flags[@]}"
LD_LIBRARY_PATH=$prefix/$libdir "$work/consumer"
