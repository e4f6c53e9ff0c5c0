# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(scene PER_FILE imomushi_headless)
target_compile_definitions(test_scene PRIVATE IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
