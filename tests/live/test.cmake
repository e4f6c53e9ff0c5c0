# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(live imomushi_reports PkgConfig::SDL2)
target_compile_definitions(test_live PRIVATE IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
