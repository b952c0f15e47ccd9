# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Toolchain: zig as a compiler for other systems, with its own C and C++ libraries for each of them. Needs a POSIX host.
#
#   cmake -B build/windows -D CMAKE_TOOLCHAIN_FILE=cmake/zig.cmake -D MORULA_ZIG_TARGET=x86_64-windows-gnu
#
# MORULA_ZIG_TARGET   processor-system-library: x86_64-windows-gnu, aarch64-macos, x86_64-macos, x86_64-linux-musl,
#                     aarch64-linux-gnu.2.28 (the oldest glibc that the program runs with)
# MORULA_ZIG          the program zig; by default the one that scripts/zig installs, else the one in PATH
# MORULA_CROSS_PREFIX the only folder where packages are looked for: those of this machine are for this machine. Headers
#                     of others come from MORULA_THIRD_PARTY or MORULA_FETCH (cmake/MorulaThirdParty.cmake)
# CMAKE_CROSSCOMPILING_EMULATOR is Wine or QEMU if the target needs one and this machine has it.
cmake_minimum_required(VERSION 3.24)
get_filename_component(morula_build "${CMAKE_CURRENT_LIST_DIR}/../build" ABSOLUTE)
set(MORULA_CROSS_PREFIX "${morula_build}/cross/prefix" CACHE PATH "The only folder where packages for the target are")
file(GLOB morula_installed_zig "${morula_build}/zig/venv/lib/python*/site-packages/ziglang")
find_program(MORULA_ZIG zig HINTS ${morula_installed_zig} REQUIRED NO_CMAKE_FIND_ROOT_PATH)
# Projects that CMake makes to try the compiler know these, too.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES MORULA_ZIG MORULA_ZIG_TARGET MORULA_ZIG_TOOLS MORULA_CROSS_PREFIX)

if(NOT MORULA_ZIG_TARGET MATCHES "^(x86_64|aarch64|wasm32)-(windows|macos|linux|wasi)(-[a-z0-9.]+)?$")
  message(FATAL_ERROR "MORULA_ZIG_TARGET is '${MORULA_ZIG_TARGET}'; cmake/zig.cmake has examples")
endif()
set(CMAKE_SYSTEM_PROCESSOR ${CMAKE_MATCH_1})
if(CMAKE_MATCH_2 STREQUAL "windows")
  set(CMAKE_SYSTEM_NAME Windows)
  # Debian installs wine64 outside of PATH.
  find_program(MORULA_WINE NAMES wine64 wine HINTS /usr/lib/wine NO_CMAKE_FIND_ROOT_PATH)
  set(morula_emulator ${MORULA_WINE})
elseif(CMAKE_MATCH_2 STREQUAL "macos")
  set(CMAKE_SYSTEM_NAME Darwin)
  # CMake asks for it to change the paths of libraries in installed programs; zig has none, so such an install fails.
  find_program(CMAKE_INSTALL_NAME_TOOL NAMES install_name_tool false NO_CMAKE_FIND_ROOT_PATH)
elseif(CMAKE_MATCH_2 STREQUAL "wasi")
  set(CMAKE_SYSTEM_NAME Generic)
else()
  set(CMAKE_SYSTEM_NAME Linux)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64" AND NOT CMAKE_HOST_SYSTEM_PROCESSOR STREQUAL "aarch64")
    find_program(MORULA_QEMU NAMES qemu-aarch64-static qemu-aarch64 NO_CMAKE_FIND_ROOT_PATH)
    set(morula_emulator ${MORULA_QEMU} -L /usr/aarch64-linux-gnu)  # the loader and glibc of Debian's cross packages
  endif()
endif()
list(GET morula_emulator 0 morula_emulator_program)
if(morula_emulator_program AND NOT DEFINED CMAKE_CROSSCOMPILING_EMULATOR)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${morula_emulator})
endif()

# CMake wants a program for each tool; zig is one program with a command for each.
if(NOT MORULA_ZIG_TOOLS)
  set(MORULA_ZIG_TOOLS "${CMAKE_BINARY_DIR}/zig")
endif()
function(morula_zig_tool name)
  set(file "${MORULA_ZIG_TOOLS}/zig-${name}")
  list(JOIN ARGN " " arguments)
  set(text "#!/bin/sh\nexec '${MORULA_ZIG}' ${arguments} \"$@\"\n")
  if(EXISTS "${file}")
    file(READ "${file}" there)
  endif()
  if(NOT "${there}" STREQUAL text)
    file(WRITE "${file}" "${text}")
    file(CHMOD "${file}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  endif()
endfunction()
morula_zig_tool(cc cc -target ${MORULA_ZIG_TARGET})
morula_zig_tool(c++ c++ -target ${MORULA_ZIG_TARGET})
foreach(tool ar ranlib rc dlltool)
  morula_zig_tool(${tool} ${tool})
endforeach()
set(CMAKE_C_COMPILER "${MORULA_ZIG_TOOLS}/zig-cc")
set(CMAKE_CXX_COMPILER "${MORULA_ZIG_TOOLS}/zig-c++")
set(CMAKE_AR "${MORULA_ZIG_TOOLS}/zig-ar" CACHE FILEPATH "")
set(CMAKE_RANLIB "${MORULA_ZIG_TOOLS}/zig-ranlib" CACHE FILEPATH "")
set(CMAKE_RC_COMPILER "${MORULA_ZIG_TOOLS}/zig-rc" CACHE FILEPATH "")
set(CMAKE_DLLTOOL "${MORULA_ZIG_TOOLS}/zig-dlltool" CACHE FILEPATH "")

set(CMAKE_FIND_ROOT_PATH "${MORULA_CROSS_PREFIX}")
list(APPEND CMAKE_PREFIX_PATH "${MORULA_CROSS_PREFIX}")
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind LIBRARY INCLUDE PACKAGE)
  if(NOT DEFINED CMAKE_FIND_ROOT_PATH_MODE_${kind})
    set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
  endif()
endforeach()
