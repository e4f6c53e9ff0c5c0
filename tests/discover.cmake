# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DPROGRAM=test_mesh -DROOM=mesh -DCOST=3 -DTIMEOUT=1500 -DOUTPUT=mesh_cases.cmake -P discover.cmake
# Asks a test program for its cases and writes one add_test per case, "mesh/NAME OF THE CASE", for ctest to include.
# doctest's own module does the same, but breaks names at semicolons.
execute_process(COMMAND ${PROGRAM} --list-test-cases --no-version --no-colors OUTPUT_VARIABLE listed RESULT_VARIABLE status)
if(NOT status EQUAL 0)
    file(REMOVE ${PROGRAM})  # so that the next build asks again
    message(FATAL_ERROR "${PROGRAM} does not list its cases: ${status}\n${listed}")
endif()
# Lists of CMake are broken at semicolons and not inside brackets: neither may stand in the text while it is a list.
string(ASCII 1 semicolon)
string(ASCII 2 open)
string(ASCII 3 close)
string(REPLACE ";" "${semicolon}" listed "${listed}")
string(REPLACE "[" "${open}" listed "${listed}")
string(REPLACE "]" "${close}" listed "${listed}")
string(REPLACE "\n" ";" listed "${listed}")
set(script)
foreach(line IN LISTS listed)
    if(line STREQUAL "" OR line MATCHES "^(=+$|${open}doctest${close})")
        continue()
    endif()
    # What doctest would take for more than a name in its filter.
    string(REPLACE "," "\\," filter "${line}")
    set(test "add_test([==[${ROOM}/${line}]==] [==[${PROGRAM}]==] -nv [==[--test-case=${filter}]==])\n")
    string(APPEND test "set_tests_properties([==[${ROOM}/${line}]==] PROPERTIES LABELS ${ROOM} COST ${COST} TIMEOUT ${TIMEOUT} SKIP_RETURN_CODE 77)\n")
    string(REPLACE "${semicolon}" ";" test "${test}")
    string(REPLACE "${open}" "[" test "${test}")
    string(REPLACE "${close}" "]" test "${test}")
    string(APPEND script "${test}")
endforeach()
file(WRITE ${OUTPUT} "${script}")
