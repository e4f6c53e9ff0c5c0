# SPDX-License-Identifier: GPL-3.0-or-later
imomushi_test(comparison NUMERIC PER_FILE imomushi_comparison imomushi_mesh_cgal)
target_sources(test_comparison PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/support/deformer_cases.cpp)
