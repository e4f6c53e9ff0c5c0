# SPDX-License-Identifier: GPL-3.0-or-later
# Needs clang (libFuzzer); see the preset "fuzz".
add_executable(fuzz_import fuzz/import.cpp)
target_include_directories(fuzz_import PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(fuzz_import PRIVATE imomushi_io)
target_compile_options(fuzz_import PRIVATE -fsanitize=fuzzer)
target_link_options(fuzz_import PRIVATE -fsanitize=fuzzer)
