# SPDX-License-Identifier: GPL-3.0-or-later
# The studio on a display of its own: a program with its own main(), because OpenGL's software renderer works with floating-point traps off.
if(IMOMUSHI_STUDIO)
    find_package(Qt6 6.4 REQUIRED COMPONENTS Test)
    find_program(XVFB_RUN xvfb-run)
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/studio/*.cpp)
    add_executable(test_studio ${sources})
    target_include_directories(test_studio PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(test_studio PRIVATE imomushi_studio doctest::doctest Qt6::Test)
    target_precompile_headers(test_studio REUSE_FROM imomushi_precompiled_studio)
    target_compile_definitions(test_studio PRIVATE
        IMOMUSHI_TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/data"
        IMOMUSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
        IMOMUSHI_LUPDATE="$<TARGET_FILE:Qt6::lupdate>")
    if(XVFB_RUN)
        add_test(NAME studio COMMAND ${XVFB_RUN} -a -s "-screen 0 1600x1000x24" $<TARGET_FILE:test_studio> -nv)
        set_tests_properties(studio PROPERTIES LABELS studio TIMEOUT 900
            ENVIRONMENT "LIBGL_ALWAYS_SOFTWARE=1;QT_QPA_PLATFORM=xcb;LC_ALL=C.UTF-8")
    endif()
endif()
