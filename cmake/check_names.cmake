# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Files that comments and pages name are there.
# Run as: cmake [-D ROOT=folder] -P cmake/check_names.cmake
#
# In comments, and in pages outside CHANGELOG.md, which tells of the past, two kinds of words are names of files:
#   body.hpp, update/body.hpp    words that end as our sources do: a file of that name is somewhere, or is there from ROOT,
#                                from the folder of the file that says so, or from where our includes begin
#   scripts/test, tests/support  words that begin with a folder of ours: there from ROOT
# Words with * or with capital letters alone (NAME_test.cpp) stand for other words. Links in pages lead to what is there.
cmake_minimum_required(VERSION 3.24)

if(NOT DEFINED ROOT)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH ROOT)
endif()

set(folders include src apps tests bench scripts examples scenes cmake viewer docs)
set(endings "hpp|cpp|inl|cmake|mjs|md|py|tsv|bib")
# Where names begin that do not begin at ROOT.
set(starts include include/morula src apps/morula tests bench viewer/src docs)

set(globs "")
foreach(folder IN LISTS folders)
  list(APPEND globs "${ROOT}/${folder}/*")
endforeach()
file(GLOB_RECURSE files RELATIVE "${ROOT}" ${globs})
list(FILTER files EXCLUDE REGEX "(^|/)(node_modules|findings|dictionaries)/")
set(bare_names CMakeLists.txt)
foreach(file IN LISTS files)
  cmake_path(GET file FILENAME bare)
  string(REGEX REPLACE "[.]in$" "" bare "${bare}")
  list(APPEND bare_names "${bare}")
endforeach()
list(REMOVE_DUPLICATES bare_names)
file(GLOB pages RELATIVE "${ROOT}" "${ROOT}/*.md" "${ROOT}/docs/*.md")
list(REMOVE_ITEM pages CHANGELOG.md)

set(faults "")
set(name_count 0)

# look_for(FILE NAME): adds to the faults when nothing is called so.
function(look_for file name)
  cmake_path(GET file PARENT_PATH beside)
  set(places "${ROOT}/${name}" "${ROOT}/${beside}/${name}")
  foreach(start IN LISTS starts)
    list(APPEND places "${ROOT}/${start}/${name}")
  endforeach()
  foreach(place IN LISTS places)
    if(EXISTS "${place}" OR EXISTS "${place}.in")
      return()
    endif()
  endforeach()
  if(NOT name MATCHES "/" AND name IN_LIST bare_names)
    return()
  endif()
  set(faults "${faults}\n  ${file}: ${name}" PARENT_SCOPE)
endfunction()

# look_through(FILE TEXT): all names in a text.
macro(look_through file text)
  string(REGEX MATCHALL "[A-Za-z0-9_*./-]+" words "${text}")
  foreach(word IN LISTS words)
    if(word MATCHES "[*]" OR word MATCHES "(^|[/_.-])[A-Z][A-Z]+([/_.-]|$)" AND NOT word MATCHES "README|CONTRIBUTING|SECURITY|CHANGELOG")
      continue()
    endif()
    string(REGEX REPLACE "[./-]+$" "" word "${word}")
    if(word MATCHES "^[A-Za-z0-9_./-]*[A-Za-z0-9_]\\.(${endings})$")
      math(EXPR name_count "${name_count} + 1")
      look_for("${file}" "${word}")
    elseif(word MATCHES "^([a-z]+)/[A-Za-z0-9_./-]+$" AND CMAKE_MATCH_1 IN_LIST folders)
      math(EXPR name_count "${name_count} + 1")
      if(NOT EXISTS "${ROOT}/${word}")
        string(APPEND faults "\n  ${file}: ${word}")
      endif()
    endif()
  endforeach()
endmacro()

set(names_a_file "[A-Za-z0-9_]\\.(${endings})|[a-z]+/[a-z]")
foreach(file IN LISTS files)
  if(file MATCHES "\\.(hpp|cpp|inl|mjs|js)$")
    set(comment "(^|[ \t])//.*$")
  elseif(file MATCHES "(\\.(cmake|py|in)|CMakeLists.txt)$|^scripts/[a-z_]+$")
    set(comment "(^|[ \t])# .*$")
  else()
    continue()
  endif()
  file(STRINGS "${ROOT}/${file}" lines REGEX "(//|#).*(${names_a_file})" ENCODING UTF-8)
  # A bracket in a list hides the semicolons after it.
  string(REGEX REPLACE "[][]" " " lines "${lines}")
  foreach(line IN LISTS lines)
    if(line MATCHES "${comment}")
      look_through("${file}" "${CMAKE_MATCH_0}")
    endif()
  endforeach()
endforeach()

foreach(page IN LISTS pages)
  cmake_path(GET page PARENT_PATH beside)
  file(STRINGS "${ROOT}/${page}" lines REGEX "${names_a_file}|\\]\\(" ENCODING UTF-8)
  # A bracket in a list hides the semicolons after it. What has a blank in it is code.
  string(REGEX REPLACE "\\]\\(" " @(" lines "${lines}")
  string(REGEX REPLACE "[][]" " " lines "${lines}")
  string(REGEX MATCHALL "@\\([^()# \t;]+[#)]" links "${lines}")
  foreach(link IN LISTS links)
    string(REGEX REPLACE "^@\\(|[#)]$" "" link "${link}")
    if(NOT link MATCHES "^[a-z]+:")
      math(EXPR name_count "${name_count} + 1")
      if(NOT EXISTS "${ROOT}/${beside}/${link}")
        string(APPEND faults "\n  ${page}: a link to ${link}")
      endif()
    endif()
  endforeach()
  # What links lead to has been looked for, and addresses are not names.
  string(REGEX REPLACE "\\([^()]*\\)|[a-z]+://[^ ]*" " " lines "${lines}")
  look_through("${page}" "${lines}")
endforeach()

if(faults)
  message(FATAL_ERROR "There is no such file:${faults}")
endif()
if(name_count EQUAL 0)
  message(FATAL_ERROR "nothing to check in ${ROOT}")
endif()
message(STATUS "${name_count} names of files, all of them there")
