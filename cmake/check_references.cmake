# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Every paper cited as [key2005] or [key2005, sec. 3] in sources and pages is in docs/references.bib.
# Run as: cmake [-D ROOT=folder] -P cmake/check_references.cmake
cmake_minimum_required(VERSION 3.24)

if(NOT DEFINED ROOT)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH ROOT)
endif()

file(STRINGS "${ROOT}/docs/references.bib" entries REGEX "^@[a-z]+{")
list(TRANSFORM entries REPLACE "^@[a-z]+{([^,]*),.*$" "\\1")

set(globs "${ROOT}/docs/*.md" "${ROOT}/extras/*/docs/*.md")
foreach(folder include src extras toolbox apps bench examples scenes tests)
  list(APPEND globs "${ROOT}/${folder}/*.hpp" "${ROOT}/${folder}/*.cpp" "${ROOT}/${folder}/*.inl")
endforeach()
file(GLOB_RECURSE files RELATIVE "${ROOT}" ${globs})

# A citation lists keys, each with or without a place in the paper: [liu1988, hubbard1993], [garcia2005, eq. 6].
set(key "[a-z]+[12][0-9][0-9][0-9]")
set(cited "")
set(unknown "")
foreach(file IN LISTS files)
  file(STRINGS "${ROOT}/${file}" lines REGEX "\\[${key}[],]")
  # A bracket in a list hides the semicolons after it.
  string(REGEX REPLACE "[][]" " " lines "${lines}")
  string(REGEX MATCHALL " ${key}" keys "${lines}")
  foreach(found IN LISTS keys)
    string(SUBSTRING "${found}" 1 -1 found)
    list(APPEND cited "${found}")
    if(NOT found IN_LIST entries)
      string(APPEND unknown "\n  ${file}: ${found}")
    endif()
  endforeach()
endforeach()

if(unknown)
  message(FATAL_ERROR "Cited, but not in docs/references.bib:${unknown}")
endif()
list(REMOVE_DUPLICATES cited)
list(LENGTH cited cited_count)
if(cited_count EQUAL 0)
  message(FATAL_ERROR "no citations in ${ROOT}")
endif()
message(STATUS "${cited_count} papers cited, all of them listed")
