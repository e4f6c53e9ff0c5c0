# SPDX-License-Identifier: GPL-3.0-or-later
# A worker that misbehaves in the way that the name of the file asks for.
add_executable(test_bad_import_worker io/worker/bad_import_worker.cpp)
target_include_directories(test_bad_import_worker PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(test_bad_import_worker PRIVATE imomushi_io)

imomushi_test(io imomushi_io nlohmann_json::nlohmann_json PkgConfig::DRACO meshoptimizer::meshoptimizer)
add_dependencies(test_io test_bad_import_worker)
target_compile_definitions(test_io PRIVATE
    IMOMUSHI_TEST_BAD_IMPORT_WORKER="$<TARGET_FILE:test_bad_import_worker>")
