# SPDX-License-Identifier: GPL-3.0-or-later
if(IMOMUSHI_STUDIO)
    imomushi_test(tools PRECOMPILED studio_tests imomushi_viewport)
endif()
