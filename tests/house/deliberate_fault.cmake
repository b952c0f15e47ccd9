# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Runs PROGRAM FAULT, which must fail and say WORDS. Run as: cmake -D PROGRAM=… -D FAULT=… -D WORDS=… -P …
execute_process(COMMAND "${PROGRAM}" "${FAULT}" RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(result EQUAL 0)
  message(FATAL_ERROR "the fault ${FAULT} did not end the program: sanitizers of this build make no test fail\n${output}")
endif()
if(NOT output MATCHES "${WORDS}")
  message(FATAL_ERROR "the fault ${FAULT} ended the program with ${result}, but not for being found:\n${output}")
endif()
