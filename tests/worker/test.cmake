# SPDX-License-Identifier: GPL-3.0-or-later
# The program whose workers these tests ask, and break.
add_executable(test_worker_program worker/program/main.cpp worker/operations.cpp)
target_include_directories(test_worker_program PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(test_worker_program PRIVATE imomushi_worker)

imomushi_test(worker imomushi_worker)
add_dependencies(test_worker test_worker_program)
target_compile_definitions(test_worker PRIVATE IMOMUSHI_TEST_WORKER="$<TARGET_FILE:test_worker_program>")
