# SPDX-License-Identifier: GPL-3.0-or-later
# The hard cases of tests/support/hard_cases.h, through the commands an artist uses. Writes stability.md beside the test's program.
set(hard_cases)
foreach(file bodies checks cases)
    list(APPEND hard_cases ${CMAKE_CURRENT_SOURCE_DIR}/support/hard_${file}.cpp)
endforeach()
imomushi_test(stability COST 100 imomushi_reports)
target_sources(test_stability PRIVATE ${hard_cases})
target_compile_definitions(test_stability PRIVATE
    IMOMUSHI_STABILITY_TABLE="${PROJECT_BINARY_DIR}/stability.md")

# Leaves every hard case as a scene that the studio opens: imomushi_hard_cases [FOLDER]
add_executable(imomushi_hard_cases EXCLUDE_FROM_ALL ${CMAKE_CURRENT_SOURCE_DIR}/stability/maker/main.cpp
    ${CMAKE_CURRENT_SOURCE_DIR}/stability/scene.cpp ${hard_cases})
target_include_directories(imomushi_hard_cases PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(imomushi_hard_cases PRIVATE imomushi_reports)
