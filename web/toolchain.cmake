# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Toolchain: WebAssembly by zig, which the PyPI package ziglang holds; scripts/web installs it. -D MORULA_ZIG=PROGRAM names it.
#
# zig compiles C++ for wasm32-wasi without exceptions and without threads, so web/runtime compiles the runtime of exceptions from
# zig's own sources. Threads: the classes of the standard library exist and lock nothing; a thread that is started throws.
set(CMAKE_SYSTEM_NAME WASI)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES MORULA_ZIG)
if(NOT MORULA_ZIG)
  message(FATAL_ERROR "MORULA_ZIG is not set: run scripts/web, which installs zig and configures with it")
endif()

# A compiler of one word, for tools such as ccache.
foreach(tool cc c++ ar ranlib)
  set(program "${CMAKE_BINARY_DIR}/zig-${tool}")
  if(NOT EXISTS "${program}")
    file(WRITE "${program}" "#!/bin/sh\nexec '${MORULA_ZIG}' ${tool} \"$@\"\n")
    file(CHMOD "${program}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
  endif()
endforeach()
set(CMAKE_C_COMPILER "${CMAKE_BINARY_DIR}/zig-cc")
set(CMAKE_CXX_COMPILER "${CMAKE_BINARY_DIR}/zig-c++")
set(CMAKE_AR "${CMAKE_BINARY_DIR}/zig-ar" CACHE FILEPATH "")
set(CMAKE_RANLIB "${CMAKE_BINARY_DIR}/zig-ranlib" CACHE FILEPATH "")

set(target "-target wasm32-wasi -mbulk-memory -msign-ext -mnontrapping-fptoint -fno-stack-protector -g0 -fno-threadsafe-statics")
set(exceptions "-fwasm-exceptions -mexception-handling -Xclang -exception-model=wasm -mllvm -wasm-enable-eh")
set(library "-U_LIBCPP_HAS_THREADS -D_LIBCPP_HAS_THREADS=1 -U_LIBCPP_HAS_FILESYSTEM -D_LIBCPP_HAS_FILESYSTEM=1")
set(CMAKE_C_FLAGS_INIT "${target} ${exceptions}")
set(CMAKE_CXX_FLAGS_INIT "${target} ${exceptions} ${library}")
# For size; web/CMakeLists.txt asks for speed where time is spent.
set(CMAKE_C_FLAGS_RELEASE "-Oz -DNDEBUG" CACHE STRING "")
set(CMAKE_CXX_FLAGS_RELEASE "-Os -DNDEBUG" CACHE STRING "")
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY NEVER)
