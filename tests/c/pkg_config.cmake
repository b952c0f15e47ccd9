# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# What pkg-config says of the installed libraries is enough: for the example in C, and for a program in C++.
file(REMOVE_RECURSE "${FOLDER}")
foreach(component library development)
  execute_process(COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${FOLDER}/prefix" --component ${component}
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
set(ENV{PKG_CONFIG_PATH} "${FOLDER}/prefix/${LIB}/pkgconfig")
set(ENV{LD_LIBRARY_PATH} "${FOLDER}/prefix/${LIB}")
function(compile_and_run package compiler source)
  execute_process(COMMAND "${PKG_CONFIG}" --cflags --libs ${package} OUTPUT_VARIABLE flags
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  execute_process(COMMAND "${compiler}" ${ARGN} "${source}" ${flags} -lm -o "${FOLDER}/${package}"
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${FOLDER}/${package}" WORKING_DIRECTORY "${FOLDER}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
compile_and_run(morula "${CC}" "${EXAMPLE}" -std=c99 -Wall -Wextra -Wpedantic -Werror)
compile_and_run(morula-cpp "${CXX}" "${CONSUMER}" -std=c++20)
if(ROBOT_CONSUMER)
  compile_and_run(morula-robot "${CXX}" "${ROBOT_CONSUMER}" -std=c++20)
endif()
