#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes the pictures of the README and of the manual again, in assets/manual/pictures: the real studio on a display of its own (tests/studio/pictures_test.cpp), and
# what the program renders without one (the scripts below). Takes some minutes. Look at each before it is committed.
#   packaging/pictures.sh
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
"$root/packaging/install.sh" test
"$root/packaging/build.sh" all
stage="$root/build/pictures"
rm -rf "$stage"
mkdir -p "$stage/frames" "$root/assets/manual/pictures"
cd "$stage"

LIBGL_ALWAYS_SOFTWARE=1 LP_NUM_THREADS=0 QT_QPA_PLATFORM=xcb LC_ALL=C.UTF-8 IMOMUSHI_SCREENSHOTS="$stage" \
    xvfb-run -a -s "-screen 0 1440x900x24" "$root/build/tests/test_studio" -nv --no-skip -tc="pictures: *"

# A file, the same file made soft (as the sample is), and a pose.
camera='"camera": {"eye": [2.1, 1.55, 4.6], "target": [0.06, 1.0, -0.15], "up": [0, 1, 0], "fov": 0.48}'
cat >soft.jsonl <<EOF
{"do": "import-character", "path": "$root/assets/samples/dragon/dragon.glb", "name": "dragon"}
{"do": "render", "path": "frames/soft1.png", "width": 800, "height": 800, $camera}
{"do": "open", "path": "$root/assets/samples/dragon.imomushi"}
{"do": "render", "path": "frames/soft2.png", "width": 800, "height": 800, "bones": true, $camera}
{"do": "morph", "character": "dragon", "target": "smile", "weight": 1.0}
{"do": "drag", "endpoint": "arm.L/end", "to": [0.52, 1.42, 0.42]}
{"do": "drag", "endpoint": "arm.R/end", "to": [-0.62, 0.5, 0.5]}
{"do": "drag", "endpoint": "tail.3/end", "to": [0.62, 0.85, -0.85]}
{"do": "drag", "endpoint": "head/end", "to": [-0.22, 1.72, 0.3]}
{"do": "turn-part", "character": "dragon", "part": "wing.L", "rotation": [0.0, 0.0, 0.199, 0.98]}
{"do": "turn-part", "character": "dragon", "part": "wing.R", "rotation": [0.0, 0.0, -0.199, 0.98]}
{"do": "turn-part", "character": "dragon", "part": "eye.L", "rotation": [0.0, 0.15, 0.0, 0.9887]}
{"do": "turn-part", "character": "dragon", "part": "eye.R", "rotation": [0.0, 0.15, 0.0, 0.9887]}
{"do": "step", "frames": 180}
{"do": "render", "path": "frames/soft3.png", "width": 800, "height": 800, $camera}
EOF
# Four frames of a take.
camera='"camera": {"eye": [0.9, 1.5, 4.9], "target": [0.1, 0.62, 0], "up": [0, 1, 0], "fov": 0.47}'
cat >performance.jsonl <<EOF
{"do": "open", "path": "$root/assets/samples/octopus.imomushi"}
{"do": "render", "path": "frames/wave1.png", "width": 640, "height": 640, $camera}
{"do": "drag", "endpoint": "arm2-tip-bone/end", "to": [1.0, 1.15, 0.35], "seconds": 0.5}
{"do": "drag", "endpoint": "arm8-tip-bone/end", "to": [-0.75, 0.35, 1.05], "seconds": 0.5}
{"do": "step", "frames": 24}
{"do": "render", "path": "frames/wave2.png", "width": 640, "height": 640, $camera}
{"do": "step", "frames": 21}
{"do": "drag", "endpoint": "arm2-tip-bone/end", "to": [0.75, 1.3, 0.45], "seconds": 0.4}
{"do": "drag", "endpoint": "mantle-bone/end", "to": [-0.15, 1.2, 0.05], "seconds": 0.4}
{"do": "step", "frames": 45}
{"do": "render", "path": "frames/wave3.png", "width": 640, "height": 640, $camera}
{"do": "drag", "endpoint": "arm2-tip-bone/end", "to": [1.15, 1.0, 0.1], "seconds": 0.4}
{"do": "drag", "endpoint": "mantle-bone/end", "to": [0.2, 1.18, 0.05], "seconds": 0.4}
{"do": "step", "frames": 45}
{"do": "render", "path": "frames/wave4.png", "width": 640, "height": 640, $camera}
EOF
# A strong bend without the bend warp and with it.
camera='"camera": {"eye": [0.5, 1.35, 4.2], "target": [-0.15, 0.62, 0.1], "up": [0, 1, 0], "fov": 0.42}'
cat >bend-warp.jsonl <<EOF
{"do": "open", "path": "$root/assets/samples/caterpillar.imomushi"}
{"do": "disable", "effect": "bend-warp"}
{"do": "drag", "endpoint": "head-bone/end", "to": [0.1, 1.25, 0.1]}
{"do": "step", "frames": 240}
{"do": "render", "path": "frames/warp1.png", "width": 960, "height": 800, $camera}
{"do": "enable", "effect": "bend-warp"}
{"do": "step", "frames": 2}
{"do": "render", "path": "frames/warp2.png", "width": 960, "height": 800, $camera}
EOF
for script in soft performance bend-warp; do "$root/build/app/imomushi" run "$script.jsonl" >/dev/null; done
convert frames/soft[123].png +append make-soft.png
convert frames/wave[1234].png +append performance.png
convert frames/warp[12].png +append bend-warp.png

# 256 colours, and no wider than lets the file stay under 200 kB.
for picture in *.png; do
    to="$root/assets/manual/pictures/$picture"
    for width in 1200 1100 1000 900 800 700; do
        convert "$picture" -resize "${width}x${width}>" -strip -dither FloydSteinberg -colors 256 "png8:$to"
        [ "$(stat -c %s "$to")" -ge 200000 ] || break
    done
done
ls -l "$root/assets/manual/pictures"
