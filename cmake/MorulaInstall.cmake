# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0

# What find_package(morula) and pkg-config find: components `library` (what programs in C need to run) and `development`.
# The command: component `runtime`.
include(CMakePackageConfigHelpers)

set(morula_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/morula")

get_property(morula_extras GLOBAL PROPERTY MORULA_BUILT_EXTRAS)
set(morula_headers "${PROJECT_SOURCE_DIR}/include/morula" "${PROJECT_BINARY_DIR}/include/morula")
foreach(extra IN LISTS morula_extras)
  list(APPEND morula_headers "${PROJECT_SOURCE_DIR}/extras/${extra}/include/morula")
endforeach()
install(DIRECTORY ${morula_headers}
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development
  FILES_MATCHING PATTERN "*.hpp" PATTERN "morula.h")
# The license and the notices of what is compiled in go where the code goes. Each component has a folder of its own, named
# as its package is: two packages may not have the same file.
set(morula_package_of_development libmorula-dev)
set(morula_package_of_library "libmorula${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
set(morula_package_of_runtime morula)
set(morula_components development runtime)
if(TARGET morula_c)
  list(APPEND morula_components library)
endif()
foreach(component IN LISTS morula_components)
  set(documents "${CMAKE_INSTALL_DATAROOTDIR}/doc/${morula_package_of_${component}}")
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${documents}" RENAME copyright COMPONENT ${component})
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/licenses" DESTINATION "${documents}" COMPONENT ${component})
endforeach()

set(morula_installed_targets morula_core morula morula_precompiled)
if(MORULA_IO)
  list(APPEND morula_installed_targets morula_io)
endif()
foreach(extra IN LISTS morula_extras)
  list(APPEND morula_installed_targets morula_${extra})
endforeach()
if(MORULA_STUDY OR MORULA_ROBOT)
  # They link it.
  list(APPEND morula_installed_targets morula_toolbox)
endif()
install(TARGETS ${morula_installed_targets} EXPORT morula_targets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
install(EXPORT morula_targets NAMESPACE morula:: FILE MorulaTargets.cmake
  DESTINATION "${morula_package_dir}" COMPONENT development)

if(TARGET morula_c)
  install(TARGETS morula_c EXPORT morula_targets
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library NAMELINK_COMPONENT development
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT library)
endif()

# For those who ask pkg-config: morula for C, morula-cpp for C++, morula-robot for robots in C++.
file(RELATIVE_PATH MORULA_PC_PREFIX "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" MORULA_PC_PREFIX "${MORULA_PC_PREFIX}")
set(MORULA_PC_LIBS "")
foreach(library study toolbox page grains io core)
  if(TARGET morula_${library})
    string(APPEND MORULA_PC_LIBS "-lmorula_${library} ")
  endif()
endforeach()
string(APPEND MORULA_PC_LIBS "-lpthread")
set(morula_pc_files morula-cpp)
if(TARGET morula_c)
  list(APPEND morula_pc_files morula)
endif()
if(TARGET morula_robot)
  list(APPEND morula_pc_files morula-robot)
endif()
foreach(file IN LISTS morula_pc_files)
  configure_file("${CMAKE_CURRENT_LIST_DIR}/${file}.pc.in" "${PROJECT_BINARY_DIR}/cmake/${file}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/cmake/${file}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
    COMPONENT development)
endforeach()

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/MorulaConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/cmake/morula-config.cmake" INSTALL_DESTINATION "${morula_package_dir}"
  NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/cmake/morula-config-version.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/cmake/morula-config.cmake" "${PROJECT_BINARY_DIR}/cmake/morula-config-version.cmake"
  DESTINATION "${morula_package_dir}" COMPONENT development)

if(TARGET morula_app)
  install(TARGETS morula_app RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
  if(NOT CMAKE_CROSSCOMPILING)
    # What shells complete by, and the manual page: the command prints them.
    set(morula_printed "")
    foreach(kind bash zsh fish man)
      set(printed "${PROJECT_BINARY_DIR}/completion/${kind}")
      add_custom_command(OUTPUT "${printed}" COMMAND morula_app completion ${kind} > "${printed}" DEPENDS morula_app VERBATIM)
      list(APPEND morula_printed "${printed}")
    endforeach()
    file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/completion")
    add_custom_target(morula_completion ALL DEPENDS ${morula_printed})
    set(share "${CMAKE_INSTALL_DATAROOTDIR}")
    install(FILES "${PROJECT_BINARY_DIR}/completion/bash" RENAME morula
      DESTINATION "${share}/bash-completion/completions" COMPONENT runtime)
    install(FILES "${PROJECT_BINARY_DIR}/completion/zsh" RENAME _morula
      DESTINATION "${share}/zsh/vendor-completions" COMPONENT runtime)
    install(FILES "${PROJECT_BINARY_DIR}/completion/fish" RENAME morula.fish
      DESTINATION "${share}/fish/vendor_completions.d" COMPONENT runtime)
    install(FILES "${PROJECT_BINARY_DIR}/completion/man" RENAME morula.1
      DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT runtime)
  endif()
endif()
