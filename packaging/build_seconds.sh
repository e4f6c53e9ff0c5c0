#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints processor seconds of every file that the compiler works on, largest first, and how long a build from nothing takes: without ccache, in build-seconds/, which is emptied first.
#   packaging/build_seconds.sh [program|all]     all unless given
# Processor seconds depend little on what else runs; minutes by the clock do.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
folder="$root/build-seconds"

# As CMAKE_CXX_COMPILER_LAUNCHER: runs the compiler and writes down what it took.
if [ "${1:-}" = --compile ]; then
    shift
    for ((k = 1; k < $#; ++k)); do
        if [ "${!k}" = -o ]; then next=$((k + 1)); output=${!next}; fi
    done
    TIMEFORMAT="%U %S ${output:-?}"
    { time "$@" 2>&3; } 3>&2 2>>"$folder/seconds"
    exit
fi

what="${1:-all}"
tests=ON
targets=()
if [ "$what" = program ]; then tests=OFF; targets=(imomushi); fi
rm -rf "$folder"
mkdir -p "$folder"
began=$SECONDS
cmake -S "$root" -B "$folder" -G Ninja -DIMOMUSHI_UNITY=ON -DIMOMUSHI_TESTS=$tests "-DCMAKE_CXX_COMPILER_LAUNCHER=$root/packaging/build_seconds.sh;--compile" >&2
ninja -C "$folder" --quiet "${targets[@]}" >&2
awk -v clock=$((SECONDS - began)) '
    { seconds = $1 + $2; sub(/CMakeFiles\//, "", $3); sub(/\.o$/, "", $3); sum += seconds; printf "%7.1f  %s\n", seconds, $3 | "sort -nr" }
    END { close("sort -nr"); printf "%7.1f  all %d files, %.1f minutes by the clock\n", sum, NR, clock / 60 }' "$folder/seconds"
