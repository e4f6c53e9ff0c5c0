# SPDX-License-Identifier: GPL-3.0-or-later
# Writes OUT, the source of app/build_facts.h, with the commit that SOURCE is at and the versions LIBRARIES, if it is not what is there.
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=10 HEAD OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
    set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT [[
#include "app/build_facts.h"
namespace imomushi {
const char* const kCommit = "@commit@";
const char* const kLibraries = "@LIBRARIES@";
}  // namespace imomushi
]] @ONLY)
