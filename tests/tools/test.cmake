# SPDX-License-Identifier: GPL-3.0-or-later
if(IMOMUSHI_STUDIO)
    set(IMOMUSHI_PRECOMPILED imomushi_precompiled_studio)
    imomushi_test(tools imomushi_viewport)
    set(IMOMUSHI_PRECOMPILED imomushi_precompiled_tests)
endif()
