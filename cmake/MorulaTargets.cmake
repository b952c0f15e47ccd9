# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0

# How GCC and Clang are asked for less work on code that gains nothing from more; MSVC has no such level between none and
# all.
set(MORULA_GNU_LIKE OFF)
set(MORULA_LESS_OPTIMIZED "")
set(MORULA_NOT_OPTIMIZED "")
if(CMAKE_CXX_COMPILER_ID MATCHES "^(GNU|Clang|AppleClang)$" AND NOT MSVC)
  set(MORULA_GNU_LIKE ON)
  set(MORULA_LESS_OPTIMIZED -O1)
  if(SKBUILD)
    # As long to compile, and half the code of the command: wheels are small. Clang's -Oz takes a fifth less than its -Os; zig takes one
    # for the other unless it hands it on.
    set(MORULA_LESS_OPTIMIZED -Os)
    if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
      set(MORULA_LESS_OPTIMIZED "SHELL:-Xclang -Oz")
    endif()
  endif()
  set(MORULA_NOT_OPTIMIZED -O0)
endif()

# Sources as programs of the target name them: Wine has the files of this machine on the drive Z:.
set(MORULA_SOURCES "${PROJECT_SOURCE_DIR}")
if(WIN32 AND NOT CMAKE_HOST_WIN32)
  set(MORULA_SOURCES "Z:${PROJECT_SOURCE_DIR}")
endif()

# morula_configure(TARGET): what every target of ours is compiled with.
function(morula_configure target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  if(MSVC)
    morula_configure_msvc(${target})
  elseif(MORULA_GNU_LIKE)
    morula_configure_gnu_like(${target})
  endif()
  if(MORULA_SANITIZE)
    morula_sanitizer_options(options)
    target_compile_options(${target} PRIVATE ${options})
    target_link_options(${target} PUBLIC -fsanitize=${MORULA_SANITIZE})
  endif()
  if(MORULA_FUZZ)
    # What a fuzzer steers by; the programs that are none link without it.
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

function(morula_configure_gnu_like target)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wold-style-cast -Wundef -Wnon-virtual-dtor
    # A fused multiply-add rounds once where two instructions round twice: results would depend on the machine.
    -ffp-contract=off
    # Square roots of negative numbers are ours to avoid; without this each one checks errno and blocks vectorization.
    -fno-math-errno)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 warns of overlapping copies inside std::string's own operator+ (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(SKBUILD)
    # The linker leaves out what the extension does not call.
    target_compile_options(${target} PRIVATE -ffunction-sections -fdata-sections)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # GCC collects garbage once its memory has doubled, from 128 MB on; the sources of a batch keep nearly all of it.
      target_compile_options(${target} PRIVATE --param=ggc-min-heapsize=1000000)
    endif()
  endif()
  if(MORULA_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# MSVC has not been tried. /fp:precise fuses nothing before Visual Studio 2022, and nothing since unless /fp:contract says so.
function(morula_configure_msvc target)
  target_compile_options(${target} PRIVATE /W4 /fp:precise /utf-8 /permissive- /Zc:__cplusplus /bigobj)
  # std::min and std::max are called by their names, and what MSVC calls unsafe is the standard's.
  target_compile_definitions(${target} PRIVATE NOMINMAX _CRT_SECURE_NO_WARNINGS)
  if(MORULA_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE /WX)
  endif()
endfunction()

# morula_compile_together(TARGET [COUNT]): its sources are compiled eight at once where MORULA_UNITY says so, for packages COUNT at once
# or all, so that headers are read and templates made once for all of them: most of a build's time where text, JSON and the command
# line are handled. The core is compiled source by source except for packages; the preset dev and the test of a project that adds
# Morula do so with all the rest. A name in a source's namespace without a name is its own among those of its target; a source whose
# headers do not agree with others' sets SKIP_UNITY_BUILD_INCLUSION.
function(morula_compile_together target)
  if(MORULA_UNITY)
    # The templates of CLI11, fmt, nlohmann-json and nanobind cost more than the sources: half the batches take half the time.
    set(batch 8)
    if(MORULA_UNITY_CORE)
      set(batch 0 ${ARGN})
      list(GET batch -1 batch)
    endif()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
    if(MORULA_GNU_LIKE)
      # A local name like a function of another source hides nothing that its own source could see.
      target_compile_options(${target} PRIVATE -Wno-shadow)
    endif()
  endif()
endfunction()

# morula_compile_folders_together(TARGET): the sources of each folder, with those of its subfolders, are compiled at once where
# MORULA_UNITY_CORE says so, for packages: reading headers is most of the time of the core. Kernels stay alone.
function(morula_compile_folders_together target)
  if(NOT MORULA_UNITY_CORE)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH name "${CMAKE_CURRENT_SOURCE_DIR}" "${source}")
    string(REGEX MATCH "^[^/]+" folder "${name}")
    file(STRINGS "${source}" kernels REGEX "every_processor\\.inl" LIMIT_COUNT 1)
    if(NOT kernels)
      set_source_files_properties("${source}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP "${folder}")
    endif()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  if(MORULA_GNU_LIKE)
    target_compile_options(${target} PRIVATE -Wno-shadow)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # A State of its source has members of types without linkage; the source is an included file here.
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
  endif()
endfunction()

# morula_precompile(TARGET HEADERS...): these, and what nearly every source reads of the standard library, are read once for all
# sources of the target where MORULA_PRECOMPILE says so. A source names what it uses all the same: builds without presets, the
# preset dev and the tests of an installed library compile each source by itself, and stop where a header is missing.
# morula_precompile(TARGET REUSE_FROM OTHER): those of another target, which is compiled with the same options.
function(morula_precompile target)
  if(MORULA_PRECOMPILE)
    if("${ARGV1}" STREQUAL "REUSE_FROM")
      target_precompile_headers(${target} REUSE_FROM ${ARGV2})
    else()
      target_precompile_headers(${target} PRIVATE <algorithm> <array> <bit> <charconv> <cmath> <cstdint> <functional> <limits>
        <map> <memory> <numeric> <optional> <set> <span> <stdexcept> <string> <string_view> <utility> <vector> ${ARGN})
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
      # GCC 12 warns of copies inside std::string that are too long where it is precompiled, and nowhere else.
      target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
    endif()
  endif()
endfunction()

# morula_precompile_for_packages(TARGET HEADERS...): the same in builds with MORULA_UNITY_CORE alone, where warnings are no errors.
function(morula_precompile_for_packages target)
  if(MORULA_UNITY_CORE)
    morula_precompile(${target} ${ARGN})
  endif()
endfunction()

# morula_sanitizer_options(VARIABLE): how sources are compiled for MORULA_SANITIZE.
function(morula_sanitizer_options variable)
  # A finding ends the program: one that is only printed makes no test fail.
  set(options -fsanitize=${MORULA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(MORULA_SANITIZE MATCHES "undefined")
    # Undefined, but no part of `undefined`: a number that is NaN or too large, cast to an integer.
    list(APPEND options -fsanitize=float-cast-overflow -fno-sanitize-recover=float-cast-overflow)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC sees what is not there among the checks that it has added: in std::regex, for one.
    list(APPEND options -Wno-maybe-uninitialized)
  endif()
  set(${variable} ${options} PARENT_SCOPE)
endfunction()

# morula_find_bullet(): the target morula_bullet, soft bodies included, where Bullet is found. For a benchmark and an
# example; nothing that is installed uses it.
function(morula_find_bullet)
  if(TARGET morula_bullet)
    return()
  endif()
  # The module of CMake: Debian's own configuration has paths relative to nowhere.
  find_package(Bullet QUIET MODULE)
  if(NOT BULLET_FOUND)
    return()
  endif()
  add_library(morula_bullet INTERFACE)
  target_include_directories(morula_bullet SYSTEM INTERFACE ${BULLET_INCLUDE_DIRS})
  target_link_libraries(morula_bullet INTERFACE ${BULLET_LIBRARIES})
endfunction()

# morula_windows_program(TARGET): on Windows, the program reads and prints UTF-8 and takes long paths (src/platform/windows/
# program.manifest says so to the system). Elsewhere nothing.
function(morula_windows_program target)
  set(manifest "${PROJECT_SOURCE_DIR}/src/platform/windows/program.manifest")
  if(MSVC)
    target_sources(${target} PRIVATE "${manifest}")
  elseif(WIN32)
    # 1 24: the manifest of a program.
    file(CONFIGURE OUTPUT "${PROJECT_BINARY_DIR}/program.rc" CONTENT "1 24 \"${manifest}\"\n")
    target_sources(${target} PRIVATE "${PROJECT_BINARY_DIR}/program.rc")
  endif()
endfunction()
