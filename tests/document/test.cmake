# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(document imomushi_reports)
target_compile_definitions(test_document PRIVATE IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
