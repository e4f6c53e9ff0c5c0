#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what is missing, builds what changed, and starts `imomushi ARGS`.
#   packaging/run.sh [ARGS]
# Without ARGS it opens the studio with the caterpillar; without a display it performs the caterpillar headless.
# Installing and building print to standard error; standard output belongs to the program.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
"$root/packaging/install.sh" build
"$root/packaging/build.sh" program
program="$root/build/app/imomushi"
samples="$root/assets/samples"

if [ $# -gt 0 ]; then
    exec "$program" "$@"
elif [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    exec "$program" "$samples/caterpillar.imomushi"
fi

# No display: perform a copy, so that the sample stays as it is.
stage="$root/build/performance"
mkdir -p "$stage"
cp "$samples/caterpillar.imomushi" "$stage/"
cd "$stage"
"$program" run "$samples/caterpillar_perform.jsonl" >&2
echo "There is no display, so the caterpillar was performed without one."
echo "Picture: $stage/caterpillar.png"
echo "Mesh:    $stage/caterpillar.obj"
