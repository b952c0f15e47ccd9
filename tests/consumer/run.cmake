# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Configures, builds and runs the consumer's project. WAY: find_package, add_subdirectory, or add_subdirectory_compiles,
# which compiles the consumer's source and links nothing.
cmake_minimum_required(VERSION 3.24)

# A consumer keeps nothing of an earlier run: a header that is no longer installed must not be found.
file(REMOVE_RECURSE "${FOLDER}/prefix")

set(configuration -G ${GENERATOR} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
if(WAY STREQUAL find_package)
  foreach(component library development)
    execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${FOLDER}/prefix" --component ${component}
      OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  endforeach()

  # The example of README, as it stands there, on meshes of those names.
  file(READ "${SOURCE}/README.md" readme)
  if(NOT readme MATCHES "```cpp\n#include <morula/morula.hpp>\n([^`]*)```")
    message(FATAL_ERROR "README.md has no C++ example that starts with #include <morula/morula.hpp>.")
  endif()
  file(CONFIGURE OUTPUT "${FOLDER}/readme_example.cpp" @ONLY CONTENT "#include <morula/morula.hpp>
int main() {
  const std::vector<morula::Vec3> positions = morula::read_mesh(\"limb.obj\").positions;
  bool has_contacts = false, has_surfaces = false;
  const auto use = [&](const morula::Contacts& found) {
    has_contacts = !found.contacts.empty();
    has_surfaces = !found.finished || found.surfaces.size() == found.contacts.size();
  };
@CMAKE_MATCH_1@
  return figures.size() == model.tree.level_count() && has_contacts && has_surfaces ? 0 : 1;
}
")
  configure_file("${MESH}" "${FOLDER}/limb.obj" COPYONLY)
  configure_file("${MESH}" "${FOLDER}/tool.obj" COPYONLY)

  list(APPEND configuration -D CMAKE_BUILD_TYPE=${BUILD_TYPE} -D "CMAKE_PREFIX_PATH=${FOLDER}/prefix"
    -D "README_EXAMPLE=${FOLDER}/readme_example.cpp")
  set(programs body_core body_files body_precompiled readme_example)
  if(STUDY)
    list(APPEND configuration -D "STUDY_EXAMPLE=${SOURCE}/examples/study/main.cpp")
    list(APPEND programs study_example)
  endif()
else()
  # Unoptimized, for speed; assertions are on.
  list(APPEND configuration -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS=-O0 -D "MORULA_SOURCE=${SOURCE}"
    -D MORULA_IO=OFF)
  set(programs body_core)
  if(WAY STREQUAL add_subdirectory_compiles)
    set(programs "")
    set(build_target --target body_core_compiles)
  endif()
endif()

execute_process(COMMAND ${CMAKE_COMMAND} -S "${CMAKE_CURRENT_LIST_DIR}/project" -B "${FOLDER}/build" ${configuration}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build "${FOLDER}/build" ${build_target} COMMAND_ERROR_IS_FATAL ANY)
foreach(program IN LISTS programs)
  execute_process(COMMAND "${FOLDER}/build/${program}" "${MESH}" WORKING_DIRECTORY "${FOLDER}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
