# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(scene PER_FILE imomushi_headless PkgConfig::SDL2)
target_compile_definitions(test_scene PRIVATE IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
