#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# What takes hours, for before a release:
#   packaging/thorough.sh [STEP...]    all of them unless named
#   repeats    all tests, those of chance as often as they can be asked to (IMOMUSHI_THOROUGH)
#   frames     a million frames of each sample with all effects on, and 100,000 of it on the ground
#   flood      an hour of 15,000 OSC messages a second on each sample, on one that is recorded, and beside MIDI, a pad, a hand and a take
#   address    all tests with the address and undefined-behaviour sanitizers
#   thread     all tests with the thread sanitizer
#   fuzz       each fuzzer for ten minutes
# It goes on after a step that fails, says at the end which did, and leaves what they printed in build-thorough/.
set -uo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
cd "$root"
steps=("$@")
[ ${#steps[@]} -gt 0 ] || steps=(repeats frames flood address thread fuzz)
mkdir -p build-thorough

# Whole tests may take many times as long as usual.
all_tests() { ctest --test-dir "$1" --output-on-failure --no-tests=error --timeout 20000 -j "$(nproc)" "${@:2}"; }
built() { cmake --preset "$1" && cmake --build --preset "$1"; }

repeats() { packaging/install.sh test && packaging/build.sh all && IMOMUSHI_THOROUGH=1 all_tests build; }
frames() { packaging/install.sh test && packaging/build.sh all && IMOMUSHI_SOAK_FRAMES=1000000 all_tests build -R 'document/effects: '; }
flood() { packaging/install.sh test && packaging/build.sh all && IMOMUSHI_FLOOD_SECONDS=3600 all_tests build -R 'run/flood: |live/everything'; }
# What lives until the end of the program is no leak; libraries keep much of it.
address() { packaging/install.sh test && built asan && ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 all_tests build-asan; }
# Libraries are not instrumented: what they do among themselves is not judged.
thread() { packaging/install.sh test && built tsan && TSAN_OPTIONS="ignore_noninstrumented_modules=1 halt_on_error=1" all_tests build-tsan; }
fuzz() {
    packaging/install.sh fuzz && built fuzz || return 1
    local fuzzer failed=0
    for fuzzer in build-fuzz/tests/fuzz_*; do
        [ -x "$fuzzer" ] && [ ! -d "$fuzzer" ] || continue
        "$fuzzer" -max_total_time=600 -artifact_prefix=build-thorough/ || failed=1
    done
    return $failed
}

failed=()
for step in "${steps[@]}"; do
    case "$step" in
        repeats | frames | flood | address | thread | fuzz) ;;
        *) echo "thorough.sh: \"$step\" is none of repeats, frames, flood, address, thread, fuzz." >&2; exit 2 ;;
    esac
    echo "$step: see build-thorough/$step.log"
    start=$SECONDS
    "$step" >"build-thorough/$step.log" 2>&1 || failed+=("$step")
    echo "$step: $((SECONDS - start)) s, $(grep -E "tests passed|tests failed" "build-thorough/$step.log" | tail -1)"
done
[ ${#failed[@]} -eq 0 ] || { echo "failed: ${failed[*]}"; exit 1; }
