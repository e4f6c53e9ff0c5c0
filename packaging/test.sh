#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds what changed, and runs all tests; the last lines are ctest's summary.
#   packaging/test.sh [CTEST ARGS]     for example -R mesh
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
"$root/packaging/install.sh" test
"$root/packaging/build.sh" all

# The studio's tests need a display; this one has no screen.
exec xvfb-run --auto-servernum --server-args "-screen 0 1600x1000x24" \
    ctest --test-dir "$root/build" --output-on-failure --no-tests=error -j "$(nproc)" "$@"
