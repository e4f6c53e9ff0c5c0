# SPDX-License-Identifier: GPL-3.0-or-later
# Black-box tests of the program: scripts in, JSON lines and exit status out.
imomushi_test(run imomushi_io imomushi_input nlohmann_json::nlohmann_json)
add_dependencies(test_run imomushi)
target_compile_definitions(test_run PRIVATE IMOMUSHI_PROGRAM="$<TARGET_FILE:imomushi>" IMOMUSHI_EXPECTED_VERSION="${PROJECT_VERSION}"
    IMOMUSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
