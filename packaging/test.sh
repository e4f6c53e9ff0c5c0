#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds what changed, and runs all tests; the last lines are ctest's summary.
#   packaging/test.sh [CTEST ARGS]     for example -L mesh, or -R 'mesh/.*winding'
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
"$root/packaging/install.sh" test
"$root/packaging/build.sh" all

# What needs a display brings one of its own, and waits for it: one test more than there are processors.
exec ctest --test-dir "$root/build" --output-on-failure --no-tests=error -j "$(($(nproc) + 1))" "$@"
