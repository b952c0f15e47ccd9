# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Every source, CMake file, script and workflow starts with the two SPDX lines (after a script's #! line).
# Run as: cmake [-D ROOT=folder] -P cmake/check_license.cmake
cmake_minimum_required(VERSION 3.24)

if(NOT DEFINED ROOT)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH ROOT)
endif()

set(globs "${ROOT}/CMakeLists.txt" "${ROOT}/pyproject.toml" "${ROOT}/cmake/*.in" "${ROOT}/scripts/*" "${ROOT}/.ci/*")
file(GLOB_RECURSE workflows "${ROOT}/.github/*.yml")
list(APPEND globs ${workflows} "${ROOT}/.pre-commit-config.yaml")
foreach(folder include src extras toolbox apps bench examples scenes tests cmake viewer playground web python packaging)
  foreach(pattern *.hpp *.cpp *.inl *.hpp.in *.cpp.in *.py *.sh *.mjs *.js *.cmake CMakeLists.txt)
    list(APPEND globs "${ROOT}/${folder}/${pattern}")
  endforeach()
endforeach()
foreach(pattern *.rb *.nix *.yaml)
  list(APPEND globs "${ROOT}/packaging/${pattern}")
endforeach()
file(GLOB_RECURSE files RELATIVE "${ROOT}" ${globs})
# The first pattern recurses too.
list(FILTER files EXCLUDE REGEX "^(build|\\.git)/")
list(REMOVE_DUPLICATES files)

set(without "")
foreach(file IN LISTS files)
  file(READ "${ROOT}/${file}" head LIMIT 300)
  if(NOT head MATCHES "^(#![^\n]*\n)?(//|#) SPDX-FileCopyrightText: [0-9]+ The Morula authors\n(//|#) SPDX-License-Identifier: Apache-2.0\n")
    list(APPEND without "${file}")
  endif()
endforeach()

list(LENGTH files file_count)
list(LENGTH without without_count)
if(without_count GREATER 0)
  list(JOIN without "\n  " text)
  message(FATAL_ERROR "${without_count} of ${file_count} files do not start with the two SPDX lines:\n  ${text}")
endif()
if(file_count EQUAL 0)
  message(FATAL_ERROR "nothing to check in ${ROOT}")
endif()
message(STATUS "${file_count} files carry their license lines")
