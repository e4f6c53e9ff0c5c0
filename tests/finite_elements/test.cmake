# SPDX-License-Identifier: GPL-3.0-or-later
# Second-order finite elements (tests/support/finite_elements.h): an answer to compare with, and what a user would use instead.
# CHOLMOD solves, gmsh fills bodies with tetrahedra.
find_path(GMSH_INCLUDE gmsh.h REQUIRED)
find_library(GMSH_LIBRARY gmsh REQUIRED)
add_library(imomushi_finite_elements STATIC ${CMAKE_CURRENT_SOURCE_DIR}/support/finite_elements.cpp ${CMAKE_CURRENT_SOURCE_DIR}/support/reference_case.cpp)
target_include_directories(imomushi_finite_elements PRIVATE ${CHOLMOD_INCLUDE} ${GMSH_INCLUDE})
target_link_libraries(imomushi_finite_elements PUBLIC imomushi_joints PRIVATE nlohmann_json::nlohmann_json ${CHOLMOD_LIBRARY} ${GMSH_LIBRARY})

imomushi_test(finite_elements NUMERIC imomushi_finite_elements imomushi_reduction)

# Makes the answers of tests/data/reference: imomushi_reference FOLDER NAME [rim crease bulk growth]
add_executable(imomushi_reference EXCLUDE_FROM_ALL ${CMAKE_CURRENT_SOURCE_DIR}/finite_elements/maker/main.cpp)
target_link_libraries(imomushi_reference PRIVATE imomushi_finite_elements nlohmann_json::nlohmann_json)
target_include_directories(imomushi_reference PRIVATE ${PROJECT_SOURCE_DIR})

imomushi_benchmark(finite_elements imomushi_finite_elements imomushi_reduction)
target_sources(bench_finite_elements PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/bench/quadrature_assembly.cpp)
target_compile_definitions(bench_finite_elements PRIVATE IMOMUSHI_TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/data")
# gmsh has a TetGen of its own, which is not ours: the first one is called.
imomushi_benchmark(stated_error ${TETGEN_LIBRARY} imomushi_finite_elements imomushi_reduction)
target_compile_definitions(bench_stated_error PRIVATE IMOMUSHI_TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/data")
