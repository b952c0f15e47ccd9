# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Conan 2: conan create packaging/conan -s compiler.cppstd=20 --build=missing

The clone that holds the recipe is the source. Consumers find Morula by its own configuration: find_package(morula).
"""
import os
import re

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir

required_conan_version = ">=2.0"


class MorulaConan(ConanFile):
    name = "morula"
    description = "Certified sphere trees for deforming triangle meshes"
    license = "Apache-2.0"
    topics = ("sphere-tree", "collision-detection", "bounding-volume-hierarchy", "deformable-bodies", "mesh")
    package_type = "static-library"
    settings = "os", "arch", "compiler", "build_type"
    options = {
        "io": [True, False],
        "gltf": [True, False],
        "grains": [True, False],
        "robot": [True, False],
        "c": [True, False],
        "command": [True, False],
        "threads": [True, False],
        "fPIC": [True, False],
    }
    default_options = {
        "io": True,
        "gltf": False,
        "grains": False,
        "robot": False,
        "c": False,
        "command": False,
        "threads": True,
        "fPIC": True,
    }

    @property
    def _root(self):
        return os.path.join(self.recipe_folder, "..", "..")

    def set_version(self):
        text = load(self, os.path.join(self._root, "CMakeLists.txt"))
        self.version = re.search(r"project\(morula VERSION ([0-9.]+)", text)[1]

    def export_sources(self):
        for pattern in ("CMakeLists.txt", "LICENSE"):
            copy(self, pattern, self._root, self.export_sources_folder)
        for folder in ("apps", "cmake", "extras", "include", "licenses", "scenes", "src", "toolbox"):
            copy(self, "*", os.path.join(self._root, folder), os.path.join(self.export_sources_folder, folder))

    def validate(self):
        check_min_cppstd(self, 20)
        if self.settings.os == "Windows":
            raise ConanInvalidConfiguration("Morula has not been tried on Windows")
        for option in ("gltf", "robot", "c", "command"):
            if self.options.get_safe(option) and not self.options.io:
                raise ConanInvalidConfiguration(f"the option {option} needs io=True")

    def requirements(self):
        if self.options.io:
            self.requires("nlohmann_json/[>=3.10 <4]", visible=False)
        if self.options.gltf:
            self.requires("tinygltf/[>=2.5 <3]", visible=False)
        if self.options.robot:
            self.requires("tinyxml2/[>=9 <12]")
        if self.options.command or self.options.robot:
            self.requires("fmt/[>=9 <12]", visible=False, options={"header_only": True})
        if self.options.command:
            self.requires("cli11/[>=2.1 <3]", visible=False)

    def layout(self):
        cmake_layout(self)

    def generate(self):
        dependencies = CMakeDeps(self)
        # Conan's fmt has one target or the other; the command names fmt::fmt.
        dependencies.set_property("fmt", "cmake_target_aliases", ["fmt::fmt"])
        dependencies.generate()
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False  # nothing is left in the clone
        for option, variable in (("io", "MORULA_IO"), ("gltf", "MORULA_GLTF"), ("grains", "MORULA_GRAINS"),
                                 ("robot", "MORULA_ROBOT"), ("c", "MORULA_C"), ("command", "MORULA_APPS"),
                                 ("threads", "MORULA_THREADS")):
            toolchain.cache_variables[variable] = "ON" if self.options.get_safe(option) else "OFF"
        toolchain.cache_variables["MORULA_INSTALL"] = "ON"
        for variable in ("MORULA_PAGE", "MORULA_STUDY", "MORULA_PYTHON", "MORULA_TESTS", "MORULA_BENCH", "MORULA_BITS",
                         "MORULA_EXAMPLES"):
            toolchain.cache_variables[variable] = "OFF"
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))
        copy(self, "*.txt", os.path.join(self.source_folder, "licenses"), os.path.join(self.package_folder, "licenses"))
        rmdir(self, os.path.join(self.package_folder, "share", "doc"))

    def package_info(self):
        # The project's own configuration has the targets: nothing is generated in its place.
        self.cpp_info.set_property("cmake_find_mode", "none")
        self.cpp_info.builddirs = [os.path.join("lib", "cmake", "morula")]
        # For other generators, in the order of static linking.
        libraries = (("c", "morula"), ("robot", "morula_robot"), ("robot", "morula_toolbox"), ("grains", "morula_grains"),
                     ("io", "morula_io"))
        self.cpp_info.libs = [library for option, library in libraries if self.options.get_safe(option)] + ["morula_core"]
        if self.settings.os in ("Linux", "FreeBSD") and self.options.threads:
            self.cpp_info.system_libs = ["pthread"]
