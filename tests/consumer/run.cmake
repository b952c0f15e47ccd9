# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Configures, builds and runs the consumer's project. WAY: find_package, add_subdirectory, or add_subdirectory_compiles,
# which compiles the consumer's source and links nothing.
cmake_minimum_required(VERSION 3.24)

# A consumer keeps nothing of an earlier run: a header that is no longer installed must not be found.
file(REMOVE_RECURSE "${FOLDER}/prefix")

set(configuration -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
if(WAY STREQUAL find_package)
  foreach(component library development)
    execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${FOLDER}/prefix" --component ${component}
      OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  endforeach()

  # The project of README, as it stands there.
  file(READ "${SOURCE}/README.md" readme)
  foreach(block "cpp:main.cpp" "cmake:CMakeLists.txt")
    string(REPLACE ":" ";" block "${block}")
    list(GET block 0 language)
    list(GET block 1 name)
    if(NOT readme MATCHES "```${language}\n([^`]*)```")
      message(FATAL_ERROR "README.md has no block of ${language} for ${name}.")
    endif()
    file(WRITE "${FOLDER}/readme/${name}" "${CMAKE_MATCH_1}")
  endforeach()

  list(APPEND configuration -D CMAKE_BUILD_TYPE=${BUILD_TYPE} -D "CMAKE_PREFIX_PATH=${FOLDER}/prefix")
  set(programs body_core body_files body_precompiled)
  if(STUDY)
    list(APPEND configuration -D "STUDY_EXAMPLE=${SOURCE}/examples/study/main.cpp")
    list(APPEND programs study_example)
  endif()
else()
  # Unoptimized, for speed; assertions are on.
  list(APPEND configuration -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS=-O0 -D "MORULA_SOURCE=${SOURCE}"
    -D MORULA_IO=OFF)
  set(programs body_core)
  if(WAY STREQUAL add_subdirectory_compiles)
    set(programs "")
    set(build_target --target body_core_compiles)
  endif()
endif()

execute_process(COMMAND ${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}/project" -B "${FOLDER}/build" ${configuration}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build "${FOLDER}/build" ${build_target} COMMAND_ERROR_IS_FATAL ANY)
foreach(program IN LISTS programs)
  execute_process(COMMAND "${FOLDER}/build/${program}" "${MESH}" WORKING_DIRECTORY "${FOLDER}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()

if(WAY STREQUAL find_package)
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${FOLDER}/readme" -B "${FOLDER}/readme/build" ${configuration}
    COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build "${FOLDER}/readme/build" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${FOLDER}/readme/build/app" OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
  # A line for each frame; in some of them the bodies touch.
  # On a busy machine the budget may end every run that finds an overlap.
  if(NOT printed MATCHES "^((overlap [0-9.]+|[0-9]+ places)\n)+$"
     OR NOT printed MATCHES "overlap 0[.][0-9]*[1-9]|[1-9][0-9]* places")
    message(FATAL_ERROR "README's example printed:\n${printed}")
  endif()
endif()
