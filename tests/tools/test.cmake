# SPDX-License-Identifier: GPL-3.0-or-later
if(IMOMUSHI_STUDIO)
    imomushi_test(tools imomushi_viewport)
endif()
