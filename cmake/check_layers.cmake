# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Includes point down. Run as: cmake [-D ROOT=folder] -P cmake/check_layers.cmake
#
# Lists every include that breaks a rule, then fails. The rules:
#   library        a folder includes itself and folders of lower height, so no two folders include each other; nothing
#                  outside the library
#   public headers no private ones: everything they include is installed
#   extras         their own headers, the library's public ones, the private ones of few folders, and the extras that they name
#   toolbox        itself alone
#   everyone else  public headers of the library and their own: apps, bench, examples, scenes and the consumer test; apps and bench
#                  also those of platform
#   systems        headers of POSIX and Windows in src/platform/posix and src/platform/windows alone; of tests, in folders of these names
cmake_minimum_required(VERSION 3.24)

# ground
set(height_parallel 0)
set(height_platform 0)  # POSIX and Windows behind the same functions
set(height_simd 0)
set(height_geometry 1)
# shape
set(height_query 3)
set(height_medial 4)
set(height_deform 3)
# tree
set(height_tree 5)
set(height_generators 6)
set(height_update 7)  # a body that rebuilds its tree builds
# uses
set(height_accuracy 8)
set(height_collide 8)
set(height_io 8)
# experiments
set(height_surface 9)
set(height_scene 9)
set(height_c 10)

# Extras: the other extras that each uses; what of the library's private headers all may include.
set(extras grains page robot study)
set(uses_grains "")
set(uses_page "")
set(uses_robot toolbox)
set(uses_study page toolbox)
# simd: kernels that are compiled for each kind of processor.
set(private_for_extras geometry io parallel platform simd)

# Wings: the folders of a folder, the lowest first. What lies beside them may include all of them.
set(wings_generators fit driver divide reduce)
set(wings_update points rules kdop rebuild)
set(wings_collide pairs facets front shapes patches)
set(wings_study svg run claims variants output)
set(wings_robot read fit plan write)
set(wings_surface boxes pairs layers obstacles haptic)
set(wings_geometry enclosing triangles)
set(wings_platform posix windows)
set(wings_io array paraview gltf mesh tree motion)
# Files beside the wings that the wings may include.
set(common_update fitted_body)
set(common_study json words)
set(common_collide require)
set(common_geometry exact_predicates wide_integers)
set(common_platform apart console decimal files interrupt path_text process)
set(common_io interruptible_text first_bytes byte_reader byte_source json_checks number_text text_scanner whole_file)

if(NOT DEFINED ROOT)
  cmake_path(GET CMAKE_CURRENT_LIST_DIR PARENT_PATH ROOT)
endif()
set(faults "")
set(include_count 0)

# includes_of(FILE): sets `includes` to a list of <path> and "path", in the file's order.
macro(includes_of file)
  file(STRINGS "${ROOT}/${file}" includes REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  list(TRANSFORM includes REPLACE "^[ \t]*#[ \t]*include[ \t]*([<\"][^>\"]*[>\"]).*$" "\\1")
endmacro()

macro(fault file include reason)
  list(APPEND faults "${file} includes ${include}: ${reason}")
endmacro()

# wing_of(PATH VARIABLE): PATH is FOLDER/WING/file or FOLDER/file. The place of the wing in the list of its folder's wings; -1 for
# what lies beside them, -2 for what is common to them, -3 for a wing that the list does not know.
function(wing_of path variable)
  set(place -2)
  if(path MATCHES "^([a-z_]+)/([a-z_]+)/")
    list(FIND wings_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}" place)
    if(place EQUAL -1)
      set(place -3)
    endif()
  elseif(path MATCHES "^([a-z_]+)/([a-z_]+)[.]")
    list(FIND common_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}" common)
    if(common EQUAL -1)
      set(place -1)
    endif()
  endif()
  set(${variable} ${place} PARENT_SCOPE)
endfunction()

# check_wings(FILE INCLUDE FROM TO): FILE includes INCLUDE, which are FROM and TO of one folder, as wing_of takes them.
macro(check_wings file include from to)
  wing_of("${from}" wing_of_file)
  wing_of("${to}" wing_of_target)
  if(wing_of_file EQUAL -3 OR wing_of_target EQUAL -3)
    fault("${file}" "${include}" "a wing without a place: give it one in cmake/check_layers.cmake")
  elseif(wing_of_file GREATER_EQUAL 0 AND
         (wing_of_target EQUAL -1 OR wing_of_target GREATER wing_of_file))
    fault("${file}" "${include}" "wings include themselves, those before them, and what is common")
  elseif(wing_of_file EQUAL -2 AND NOT wing_of_target EQUAL -2)
    fault("${file}" "${include}" "what is common to the wings includes none of them")
  endif()
endmacro()

file(GLOB_RECURSE library_files RELATIVE "${ROOT}"
  "${ROOT}/include/morula/*.hpp" "${ROOT}/src/*.hpp" "${ROOT}/src/*.cpp" "${ROOT}/src/*.inl")
foreach(file IN LISTS library_files)
  # The header of everything.
  if(file STREQUAL "include/morula/morula.hpp")
    continue()
  endif()
  if(NOT file MATCHES "^(include/morula|src)/([a-z_]+)/")
    list(APPEND faults "${file} is in no folder of the library")
    continue()
  endif()
  set(root_of_file "${CMAKE_MATCH_1}")
  set(folder "${CMAKE_MATCH_2}")
  if(NOT DEFINED height_${folder})
    list(APPEND faults "${file}: the folder ${folder} has no height: give it one in cmake/check_layers.cmake")
    continue()
  endif()
  includes_of("${file}")
  foreach(include IN LISTS includes)
    if(include MATCHES "^(<morula/|\")([a-z_]+)/")
      set(target "${CMAKE_MATCH_2}")
    elseif(include MATCHES "^<morula/version.hpp>$" OR (folder STREQUAL "c" AND include STREQUAL "<morula/morula.h>"))
      continue()
    elseif(include MATCHES "^<morula/")
      fault("${file}" "${include}" "the library includes what it uses, not everything")
      continue()
    elseif(include MATCHES "^<")
      continue()
    else()
      set(target "${folder}")
    endif()
    math(EXPR include_count "${include_count} + 1")
    if(root_of_file STREQUAL "include/morula" AND include MATCHES "^\"")
      fault("${file}" "${include}" "a public header may include public headers only, in angle brackets")
    elseif(NOT DEFINED height_${target})
      fault("${file}" "${include}" "there is no folder ${target} in the library")
    elseif(NOT target STREQUAL folder AND NOT height_${target} LESS height_${folder})
      fault("${file}" "${include}" "${target} is not below ${folder}")
    elseif(target STREQUAL folder AND DEFINED wings_${folder} AND include MATCHES "^\"(.*)\"$")
      # Public headers are in no wing; private ones have a place.
      set(path "${CMAKE_MATCH_1}")
      string(REGEX REPLACE "^src/" "" from "${file}")
      check_wings("${file}" "${include}" "${from}" "${path}")
    endif()
  endforeach()
endforeach()

foreach(extra IN LISTS extras)
  file(GLOB_RECURSE extra_files RELATIVE "${ROOT}" "${ROOT}/extras/${extra}/include/*.hpp" "${ROOT}/extras/${extra}/src/*.hpp"
    "${ROOT}/extras/${extra}/src/*.cpp")
  foreach(file IN LISTS extra_files)
    includes_of("${file}")
    foreach(include IN LISTS includes)
      math(EXPR include_count "${include_count} + 1")
      if(include MATCHES "^<morula/([a-z_]+)/")
        set(target "${CMAKE_MATCH_1}")
        if(NOT DEFINED height_${target} AND NOT target STREQUAL extra AND NOT target IN_LIST uses_${extra})
          fault("${file}" "${include}" "the extra ${extra} does not use ${target}")
        endif()
      elseif(include MATCHES "^<toolbox/" AND NOT "toolbox" IN_LIST uses_${extra})
        fault("${file}" "${include}" "the extra ${extra} does not use toolbox")
      elseif(include MATCHES "^<toolbox/" AND file MATCHES "/include/")
        fault("${file}" "${include}" "toolbox is private")
      elseif(include MATCHES "^\"(.*)\"$")
        set(path "${CMAKE_MATCH_1}")
        if(file MATCHES "/include/")
          fault("${file}" "${include}" "a public header may include public headers only, in angle brackets")
        elseif(EXISTS "${ROOT}/extras/${extra}/src/${path}")
          if(DEFINED wings_${extra})
            string(REGEX REPLACE "^extras/${extra}/src" "${extra}" from "${file}")
            check_wings("${file}" "${include}" "${from}" "${extra}/${path}")
          endif()
        elseif(NOT path MATCHES "^([a-z_]+)/" OR NOT CMAKE_MATCH_1 IN_LIST private_for_extras)
          fault("${file}" "${include}" "extras include private headers of geometry, io, parallel, platform and simd alone")
        endif()
      endif()
    endforeach()
  endforeach()
endforeach()

file(GLOB toolbox_files RELATIVE "${ROOT}" "${ROOT}/toolbox/*.hpp" "${ROOT}/toolbox/*.cpp")
foreach(file IN LISTS toolbox_files)
  includes_of("${file}")
  foreach(include IN LISTS includes)
    math(EXPR include_count "${include_count} + 1")
    if(include MATCHES "morula/")
      fault("${file}" "${include}" "toolbox includes nothing of the library")
    endif()
  endforeach()
endforeach()

set(outside_globs "")
foreach(folder apps bench examples scenes tests/consumer)
  list(APPEND outside_globs "${ROOT}/${folder}/*.hpp" "${ROOT}/${folder}/*.cpp" "${ROOT}/${folder}/*.inl")
endforeach()
file(GLOB_RECURSE outside_files RELATIVE "${ROOT}" ${outside_globs})
foreach(file IN LISTS outside_files)
  includes_of("${file}")
  cmake_path(GET file PARENT_PATH folder_of_file)
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "^[<\"](.*)[>\"]$" "\\1" path "${include}")
    math(EXPR include_count "${include_count} + 1")
    string(REGEX REPLACE "^morula/([a-z_]+)/.*$" "\\1" target "${path}")
    if(target IN_LIST extras AND file MATCHES "^(apps|scenes)/")
      fault("${file}" "${include}" "what an extra adds stands in extras/${target}/command")
    elseif(path MATCHES "^platform/[a-z_]+[.]hpp$" AND file MATCHES "^(apps|bench)/")
      continue()
    elseif(path MATCHES "(^|/)src/" OR
       (EXISTS "${ROOT}/src/${path}" AND NOT EXISTS "${ROOT}/${folder_of_file}/${path}"))
      fault("${file}" "${include}" "a private header of the library")
    endif()
  endforeach()
endforeach()

# What knows the operating system stands in the platform's two folders; the rest of the code is the same everywhere.
set(system_headers "<(sys/.*|unistd|signal|fcntl|termios|poll|dlfcn|spawn|dirent|windows|io|direct|process|psapi|shellapi)[.]h>")
file(GLOB_RECURSE all_files RELATIVE "${ROOT}" "${ROOT}/src/*.[ch]pp" "${ROOT}/include/*.hpp" "${ROOT}/apps/*.[ch]pp"
  "${ROOT}/toolbox/*.[ch]pp" "${ROOT}/scenes/*.[ch]pp" "${ROOT}/extras/*/src/*.[ch]pp"
  "${ROOT}/extras/*/include/*.hpp" "${ROOT}/extras/*/command/*.[ch]pp" "${ROOT}/extras/*/tests/*.[ch]pp" "${ROOT}/tests/*.[ch]pp")
foreach(file IN LISTS all_files)
  if(file MATCHES "^src/platform/(posix|windows)/" OR file MATCHES "^tests/.*/(posix|windows)/")
    continue()
  endif()
  includes_of("${file}")
  foreach(include IN LISTS includes)
    if(include MATCHES "^${system_headers}$")
      fault("${file}" "${include}" "headers of an operating system belong to src/platform/posix and src/platform/windows, or to folders posix and windows of tests")
    endif()
  endforeach()
endforeach()

list(LENGTH faults fault_count)
if(fault_count GREATER 0)
  foreach(text IN LISTS faults)
    message("${text}")
  endforeach()
  message(FATAL_ERROR "${fault_count} includes break the layers")
endif()
if(include_count EQUAL 0)
  message(FATAL_ERROR "nothing to check in ${ROOT}")
endif()
message(STATUS "${include_count} includes point down")
