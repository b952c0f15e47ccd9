# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# An overlay port, used from a clone: vcpkg install morula --overlay-ports=CLONE/packaging/vcpkg/morula
# The clone that holds the port is the source; a port of the registry names a release instead.
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../.." ABSOLUTE)

# The libraries are static; the library for C, which is shared, is left out.
vcpkg_check_linkage(ONLY_STATIC_LIBRARY)
vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS
  FEATURES
    io MORULA_IO
    gltf MORULA_GLTF
    grains MORULA_GRAINS
    robot MORULA_ROBOT
    command MORULA_APPS
)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${FEATURE_OPTIONS}
    -DMORULA_INSTALL=ON
    -DMORULA_C=OFF
    -DMORULA_PAGE=OFF
    -DMORULA_STUDY=OFF
    -DMORULA_PYTHON=OFF
    -DMORULA_TESTS=OFF
    -DMORULA_BENCH=OFF
    -DMORULA_BITS=OFF
    -DMORULA_EXAMPLES=OFF
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/morula)
vcpkg_fixup_pkgconfig()
if("command" IN_LIST FEATURES)
  vcpkg_copy_tools(TOOL_NAMES morula AUTO_CLEAN)
endif()
file(REMOVE_RECURSE
  "${CURRENT_PACKAGES_DIR}/debug/include"
  "${CURRENT_PACKAGES_DIR}/debug/share"
  "${CURRENT_PACKAGES_DIR}/share/doc")

# The notices of headers that are compiled in go with the license.
set(notices "${SOURCE_PATH}/LICENSE")
foreach(pair "io nlohmann-json" "gltf tinygltf" "robot tinyxml2" "robot fmt" "command fmt" "command CLI11")
  string(REGEX MATCH "^([^ ]+) (.+)$" matched "${pair}")
  if(CMAKE_MATCH_1 IN_LIST FEATURES)
    list(APPEND notices "${SOURCE_PATH}/licenses/${CMAKE_MATCH_2}.txt")
  endif()
endforeach()
list(REMOVE_DUPLICATES notices)
vcpkg_install_copyright(FILE_LIST ${notices})
file(INSTALL "${CURRENT_PORT_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
