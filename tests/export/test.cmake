# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(export imomushi_reports)
target_compile_definitions(test_export PRIVATE IMOMUSHI_EXPORT_TESTS="${CMAKE_CURRENT_SOURCE_DIR}/export" IMOMUSHI_DRIVERS="${PROJECT_SOURCE_DIR}/assets/drivers")
