# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# The tasks print the same in C++ and in C, on the files that docs/reference/c.md makes first.
file(REMOVE_RECURSE "${FOLDER}")
file(MAKE_DIRECTORY "${FOLDER}")
foreach(body limb tool)
  execute_process(COMMAND "${MORULA}" sample ${body} --resolution 24 -o ${body}.obj WORKING_DIRECTORY "${FOLDER}"
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${MORULA}" build ${body}.obj -o ${body}.morula WORKING_DIRECTORY "${FOLDER}"
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(language CPP C)
  execute_process(COMMAND "${${language}}" WORKING_DIRECTORY "${FOLDER}" OUTPUT_VARIABLE ${language}_printed
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
set(line "[^\n]*\n")
if(NOT CPP_printed MATCHES
   "^build: ${line}update: ${line}contacts: ${line}distance: ${line}self-contact: ${line}scene: ${line}$")
  message(FATAL_ERROR "A task printed nothing, or another line:\n${CPP_printed}")
endif()
if(NOT CPP_printed STREQUAL C_printed)
  message(FATAL_ERROR "C++ printed\n${CPP_printed}C printed\n${C_printed}")
endif()
