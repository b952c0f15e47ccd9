# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# No page has more words than somebody reads at a time.
# Run as: cmake [-D ROOT=folder] -P cmake/check_pages.cmake
cmake_minimum_required(VERSION 3.24)

if(NOT DEFINED ROOT)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH ROOT)
endif()
set(most 2500)

file(GLOB pages RELATIVE "${ROOT}" "${ROOT}/extras/*/docs/*.md" "${ROOT}/*.md")
file(GLOB_RECURSE pages_of_docs RELATIVE "${ROOT}" "${ROOT}/docs/*.md")
list(APPEND pages ${pages_of_docs})
list(REMOVE_ITEM pages CHANGELOG.md)  # which nobody reads from end to end
set(faults "")
foreach(page IN LISTS pages)
  file(READ "${ROOT}/${page}" text)
  # Marks of generated parts are not read.
  string(REGEX REPLACE "<!--[^>]*-->" "" text "${text}")
  # Who sees a picture does not read its alternative text.
  string(REGEX REPLACE "!\\[[^]]*\\]\\([^() ]*\\)" "" text "${text}")
  # Semicolons separate lists, and brackets hide them.
  string(REGEX REPLACE "[][;\\\\]" "x" text "${text}")
  string(REGEX MATCHALL "[^ \t\n]+" words "${text}")
  list(LENGTH words count)
  if(count GREATER most)
    string(APPEND faults "\n  ${page} has ${count} words, ${most} at most: split it")
  endif()
endforeach()

list(LENGTH pages page_count)
if(faults)
  message(FATAL_ERROR "Lengths of pages:${faults}")
endif()
if(page_count EQUAL 0)
  message(FATAL_ERROR "nothing to check in ${ROOT}")
endif()
message(STATUS "${page_count} pages are no longer than they may be")
