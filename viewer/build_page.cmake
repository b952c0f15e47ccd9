# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Fetches the packages, once per lock file, and bundles the page. Nothing is written into the source tree.
# Run as: cmake -D NODE= -D NPM= -D REQUIRED=AUTO|ON -D NO_PAGE= -D SOURCE=viewer -D BINARY=folder -P build_page.cmake
cmake_minimum_required(VERSION 3.24)

# give_up(WHY): the program is built without the page, unless the page was asked for.
macro(give_up why)
  if(NOT REQUIRED STREQUAL "AUTO")
    message(FATAL_ERROR "${why}")
  endif()
  message(WARNING "morula view will have no page: ${why}")
  set(why_no_page "${why}")
  configure_file("${NO_PAGE}" "${BINARY}/page_template.cpp" @ONLY)
  file(WRITE "${BINARY}/page.html" "")
  return()
endmacro()

file(SHA256 "${SOURCE}/package-lock.json" lock)
set(fetched "")
if(EXISTS "${BINARY}/fetched.txt")
  file(READ "${BINARY}/fetched.txt" fetched)
endif()
if(NOT fetched STREQUAL lock)
  file(COPY "${SOURCE}/package.json" "${SOURCE}/package-lock.json" DESTINATION "${BINARY}")
  # esbuild finds its program without the script that npm would run.
  execute_process(
    COMMAND "${NPM}" ci --ignore-scripts --no-audit --no-fund --no-update-notifier --loglevel=error
    WORKING_DIRECTORY "${BINARY}" RESULT_VARIABLE status ERROR_VARIABLE errors OUTPUT_QUIET TIMEOUT 300)
  if(NOT status EQUAL 0)
    file(WRITE "${BINARY}/npm-errors.txt" "${errors}")
    give_up("npm ci could not fetch its packages (${BINARY}/npm-errors.txt says why); with a network, delete ${BINARY} and build again")
  endif()
  file(WRITE "${BINARY}/fetched.txt" "${lock}")
endif()

execute_process(COMMAND "${NODE}" "${SOURCE}/build.mjs" "${BINARY}" RESULT_VARIABLE status ERROR_VARIABLE errors)
if(NOT status EQUAL 0)
  file(WRITE "${BINARY}/bundle-errors.txt" "${errors}")
  give_up("the page could not be bundled (${BINARY}/bundle-errors.txt says why)")
endif()
