# SPDX-License-Identifier: GPL-3.0-or-later
# Exported files and drivers in programs that are not ours: the Khronos validator, three.js and tree-sitter's parser of GDScript (packaging/install.sh puts them into
# node_modules here), Chromium, and Blender. What is not installed is left out, with a message.
imomushi_test(clients nlohmann_json::nlohmann_json)
add_dependencies(test_clients imomushi)
target_compile_definitions(test_clients PRIVATE IMOMUSHI_PROGRAM="$<TARGET_FILE:imomushi>" IMOMUSHI_CLIENTS="${CMAKE_CURRENT_SOURCE_DIR}/clients"
    IMOMUSHI_DRIVERS="${PROJECT_SOURCE_DIR}/assets/drivers" IMOMUSHI_SAMPLES="${PROJECT_SOURCE_DIR}/assets/samples")
