# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Private headers declare nothing in namespace morula itself. Run as: cmake [-D ROOT=folder] -P cmake/check_namespaces.cmake
#
# That namespace is for what public headers declare. Private code is in morula::detail, or in a namespace of its folder.
# The one thing that may stand there is a nested type that a public header has declared: struct Body::State {...}.
# Reads lines that begin in the first column, as clang-format sets what a namespace holds.
cmake_minimum_required(VERSION 3.24)

if(NOT DEFINED ROOT)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH ROOT)
endif()

file(GLOB_RECURSE headers RELATIVE "${ROOT}" "${ROOT}/src/*.hpp" "${ROOT}/src/*.inl" "${ROOT}/extras/*/src/*.hpp" "${ROOT}/toolbox/*.hpp")
set(faults "")
foreach(header IN LISTS headers)
  file(STRINGS "${ROOT}/${header}" lines REGEX "^([A-Za-z]|}  //|\\[\\[)" ENCODING UTF-8)
  # A bracket in a list hides the semicolons after it.
  string(REGEX REPLACE "[][]" " " lines "${lines}")
  set(is_in_morula FALSE)
  set(outer FALSE)  # of a namespace inside it
  foreach(line IN LISTS lines)
    if(line MATCHES "^namespace ")
      set(outer ${is_in_morula})
      string(COMPARE EQUAL "${line}" "namespace morula {" is_in_morula)
    elseif(line MATCHES "^}  // namespace")
      set(is_in_morula ${outer})
      set(outer FALSE)
    elseif(is_in_morula AND NOT line MATCHES "^(struct|class) [A-Za-z0-9_]+::[A-Za-z0-9_]+ |^using namespace ")
      string(STRIP "${line}" line)
      string(APPEND faults "\n  ${header}: ${line}")
    endif()
  endforeach()
endforeach()

if(faults)
  message(FATAL_ERROR "In namespace morula itself, where private code is in morula::detail:${faults}")
endif()
list(LENGTH headers count)
if(count EQUAL 0)
  message(FATAL_ERROR "nothing to check in ${ROOT}")
endif()
message(STATUS "${count} private headers, nothing of theirs in namespace morula itself")
