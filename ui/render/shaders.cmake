# SPDX-License-Identifier: GPL-3.0-or-later
# The shaders become part of the program, so that it runs from anywhere.
file(GLOB IMOMUSHI_SHADERS CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/*.vert ${PROJECT_SOURCE_DIR}/shaders/*.frag ${PROJECT_SOURCE_DIR}/shaders/*.glsl)
add_custom_command(
    OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/shaders.cpp
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${PROJECT_SOURCE_DIR}/shaders -DOUTPUT=${CMAKE_CURRENT_BINARY_DIR}/shaders.cpp
            -P ${CMAKE_CURRENT_LIST_DIR}/embed_shaders.cmake
    DEPENDS ${IMOMUSHI_SHADERS} ${CMAKE_CURRENT_LIST_DIR}/embed_shaders.cmake
    VERBATIM)
target_sources(imomushi_render PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/shaders.cpp)
