# SPDX-License-Identifier: GPL-3.0-or-later
# Exported files in programs that are not ours: the Khronos validator and three.js (packaging/install.sh puts them into node_modules here), and Blender.
# What is not installed is left out, with a message.
imomushi_test(clients nlohmann_json::nlohmann_json)
add_dependencies(test_clients imomushi)
target_compile_definitions(test_clients PRIVATE IMOMUSHI_PROGRAM="$<TARGET_FILE:imomushi>" IMOMUSHI_CLIENTS="${CMAKE_CURRENT_SOURCE_DIR}/clients"
    IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
