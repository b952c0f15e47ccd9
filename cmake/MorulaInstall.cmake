# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0

# What find_package(morula) finds: component `development`. The command: component `runtime`.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(morula_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/morula")

install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/morula" "${PROJECT_BINARY_DIR}/include/morula"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT development FILES_MATCHING PATTERN "*.hpp")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT development)
# Notices of what is compiled in have to go where the code goes, be it the library or the command.
foreach(component development runtime)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/licenses" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT ${component})
endforeach()

set(morula_installed_targets morula_core morula)
if(MORULA_IO)
  list(APPEND morula_installed_targets morula_io)
endif()
if(MORULA_STUDY)
  list(APPEND morula_installed_targets morula_page morula_study)
endif()
if(MORULA_ROBOT)
  list(APPEND morula_installed_targets morula_robot)
endif()
install(TARGETS ${morula_installed_targets} EXPORT morula_targets
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT development)
install(EXPORT morula_targets NAMESPACE morula:: FILE MorulaTargets.cmake
  DESTINATION "${morula_package_dir}" COMPONENT development)

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
endif()
