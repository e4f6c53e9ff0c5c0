#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds what changed, and runs all tests; the last lines are ctest's summary.
#   packaging/test.sh [CTEST ARGS]     for example -L mesh, or -R 'mesh/.*winding'
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
"$root/packaging/install.sh" test
"$root/packaging/build.sh" all

# Tests write tens of thousands of files, and a disk needs milliseconds for each. They go to memory where there are 3 GB of it.
room=$(df --output=avail /dev/shm 2>/dev/null | tail -1) || room=0  # kB
if [ -z "${TMPDIR:-}" ] && [ "$room" -gt 3000000 ]; then
    TMPDIR=$(mktemp -d /dev/shm/imomushi-tests-XXXXXX)
    export TMPDIR
    trap 'rm -rf "$TMPDIR"' EXIT
fi

# Programs keep the memory that they free: else a tenth of a solve is the kernel that clears new pages.
export GLIBC_TUNABLES=${GLIBC_TUNABLES:-glibc.malloc.mmap_max=0:glibc.malloc.trim_threshold=4000000000}

# What needs a display brings one of its own, and waits for it: one test more than there are processors.
ctest --test-dir "$root/build" --output-on-failure --no-tests=error -j "$(($(nproc) + 1))" "$@"
