# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Runs tests of the npm package by node, if scripts/web could make it, and checks its types.
# Run as: cmake -D NODE= -D ORACLE=program -D ROOT=folder -D "TESTS=NAME;..." [-D CHROMIUM=program] -P run.cmake
cmake_minimum_required(VERSION 3.24)
if(NOT EXISTS "${ROOT}/build/web/package/dist/morula-full-simd.wasm")
  message("web: skipped: there is no package; scripts/web says why")
  return()
endif()
set(ENV{MORULA_WEB_ORACLE} "${ORACLE}")
set(ENV{MORULA_CHROMIUM} "${CHROMIUM}")
foreach(test IN LISTS TESTS)
  execute_process(COMMAND "${NODE}" --test "${ROOT}/web/tests/${test}.test.js" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(types tsconfig tsconfig_three)
  execute_process(COMMAND "${NODE}" "${ROOT}/build/web/npm/node_modules/typescript/bin/tsc" -p "${ROOT}/web/tests/${types}.json"
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
