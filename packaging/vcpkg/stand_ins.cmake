# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Runs the portfile without vcpkg, for scripts/packaging: functions of vcpkg are stand-ins that print their arguments.
# Run as: cmake -D PORTFILE=file -D "FEATURES=io;robot" -D CURRENT_PACKAGES_DIR=scratch -P stand_ins.cmake
cmake_minimum_required(VERSION 3.24)

set(PORT morula)
cmake_path(GET PORTFILE PARENT_PATH CURRENT_PORT_DIR)

function(vcpkg_check_features)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "OUT_FEATURE_OPTIONS" "FEATURES")
  set(options "")
  while(arg_FEATURES)
    list(POP_FRONT arg_FEATURES feature option)
    if(feature IN_LIST FEATURES)
      list(APPEND options "-D${option}=ON")
    else()
      list(APPEND options "-D${option}=OFF")
    endif()
    message(STATUS "feature ${feature}")
  endwhile()
  set(${arg_OUT_FEATURE_OPTIONS} "${options}" PARENT_SCOPE)
endfunction()

function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "SOURCE_PATH" "OPTIONS")
  if(arg_UNPARSED_ARGUMENTS OR NOT EXISTS "${arg_SOURCE_PATH}/CMakeLists.txt")
    message(FATAL_ERROR "vcpkg_cmake_configure: ${ARGN}")
  endif()
  foreach(option IN LISTS arg_OPTIONS)
    message(STATUS "option ${option}")
  endforeach()
endfunction()

function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FILE_LIST")
  foreach(file IN LISTS arg_FILE_LIST)
    if(NOT EXISTS "${file}")
      message(FATAL_ERROR "vcpkg_install_copyright: there is no ${file}")
    endif()
    message(STATUS "notice ${file}")
  endforeach()
endfunction()

foreach(name vcpkg_check_linkage vcpkg_cmake_install vcpkg_cmake_config_fixup vcpkg_fixup_pkgconfig vcpkg_copy_tools)
  cmake_language(EVAL CODE "function(${name})\n  message(STATUS \"${name} \${ARGN}\")\nendfunction()")
endforeach()

include("${PORTFILE}")
