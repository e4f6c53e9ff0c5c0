# SPDX-License-Identifier: GPL-3.0-or-later
# The samples as an artist finds them, and as their scripts make them, through the program itself.
imomushi_test(samples COST 100 TIMEOUT 900 imomushi_reports)
add_dependencies(test_samples imomushi)
target_compile_definitions(test_samples PRIVATE IMOMUSHI_PROGRAM="$<TARGET_FILE:imomushi>" IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
