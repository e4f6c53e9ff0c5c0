# SPDX-License-Identifier: GPL-3.0-or-later
# The studio on a display of its own: a program with its own main(), because OpenGL's software renderer works with floating-point traps off.
if(IMOMUSHI_STUDIO)
    find_program(XVFB_RUN xvfb-run)
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/studio/*.cpp)
    add_executable(test_studio ${sources} ${CMAKE_CURRENT_SOURCE_DIR}/support/failing_new.cpp)
    target_include_directories(test_studio PRIVATE ${PROJECT_SOURCE_DIR})
    target_link_libraries(test_studio PRIVATE imomushi_studio imomushi_doctest Qt6::Test PkgConfig::SDL2)
    target_precompile_headers(test_studio REUSE_FROM imomushi_precompiled_studio_tests)
    target_compile_definitions(test_studio PRIVATE
        IMOMUSHI_SHARED_MESHES="${IMOMUSHI_SHARED_MESHES}"
        IMOMUSHI_TEST_DATA="${CMAKE_CURRENT_SOURCE_DIR}/data"
        IMOMUSHI_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
        IMOMUSHI_LUPDATE="$<TARGET_FILE:Qt6::lupdate>")
    target_compile_options(test_studio PRIVATE ${IMOMUSHI_ASSERTING})
    if(XVFB_RUN)
        # A display for each file: without a window manager two windows would take the focus from each other.
        # LP_NUM_THREADS=0: pictures are drawn by the thread that asks for them; tests run beside each other, and threads that wait cost a sixth more.
        imomushi_register(studio PER_FILE COST 60 TIMEOUT 900 WRAPPER ${XVFB_RUN} -a -s "-screen 0 1600x1000x24"
            # Each has a home of its own; what Mesa compiled (seconds for each) they share.
            ENVIRONMENT LIBGL_ALWAYS_SOFTWARE=1 LP_NUM_THREADS=0 QT_QPA_PLATFORM=xcb LC_ALL=C.UTF-8 MESA_SHADER_CACHE_DIR=${CMAKE_CURRENT_BINARY_DIR}/shaders)
    endif()
endif()
