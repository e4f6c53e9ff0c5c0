#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Brings build/ up to date in release mode, from nothing or from whatever is there. Everything printed goes to standard error.
#   packaging/build.sh program    the program `imomushi`
#   packaging/build.sh all        everything, tests included
set -euo pipefail
exec >&2
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
build="$root/build"
what="${1:-program}"

# A value of the last configuration; nothing where there was none.
cached() { if [ -e "$build/CMakeCache.txt" ]; then sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; fi; }

# A build folder of another place, generator or compiler that is gone cannot be brought up to date: its configuration is forgotten.
if [ -e "$build/CMakeCache.txt" ]; then
    compiler=$(cached CMAKE_CXX_COMPILER)
    if [ "$(cached CMAKE_HOME_DIRECTORY)" != "$root" ] || [ "$(cached CMAKE_GENERATOR)" != Ninja ] || ! command -v "$compiler" >/dev/null; then
        rm -rf "$build/CMakeCache.txt" "$build/CMakeFiles" "$build/build.ninja"
    fi
fi

options=()
[ "$(cached CMAKE_BUILD_TYPE)" = Release ] || options+=(-DCMAKE_BUILD_TYPE=Release)
tests=$(cached IMOMUSHI_TESTS)
if [ "$what" = all ]; then
    [ "$tests" = ON ] || options+=(-DIMOMUSHI_TESTS=ON)
elif [ -z "$tests" ]; then
    options+=(-DIMOMUSHI_TESTS=OFF)  # the program alone needs none of the test libraries
fi
# In a new build folder everything is compiled, several files at once.
[ -e "$build/CMakeCache.txt" ] || options+=(-DIMOMUSHI_UNITY=ON)
if [ ! -e "$build/build.ninja" ] || [ ${#options[@]} -gt 0 ]; then
    cmake -S "$root" -B "$build" -G Ninja "${options[@]}"
fi

# With ccache, clones in different places share what they compiled.
export CCACHE_BASEDIR="$root" CCACHE_SLOPPINESS=pch_defines,time_macros

# Some files take more than 2 GB to compile: as many at once as processors and memory allow.
jobs=$(nproc)
fit=$(awk '/^MemAvailable:/ {print int($2 / 2500000)}' /proc/meminfo)
[ "$fit" -lt "$jobs" ] && jobs=$fit
[ "$jobs" -ge 1 ] || jobs=1

targets=()
if [ "$what" != all ]; then targets=(imomushi); fi
# Somebody who looks on sees how far it is; a log hears of faults alone.
quiet=(--quiet)
if [ -t 2 ]; then quiet=(); fi
[ -e "$build/app/imomushi" ] || echo "Compiling everything for the first time, $jobs files at once: this takes a while."
ninja -C "$build" "${quiet[@]}" -j "$jobs" "${targets[@]}"
