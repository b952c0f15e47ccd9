# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
from spack_repo.builtin.build_systems.cmake import CMakePackage

from spack.package import *


class Morula(CMakePackage):
    """Certified sphere trees for deforming triangle meshes. Built from a clone, in an environment:
    spack develop --path CLONE morula@0.1.0 and spack install --add morula@0.1.0."""

    license("Apache-2.0")

    version("0.1.0")

    variant("io", default=True, description="Files of meshes, motions and trees")
    variant("gltf", default=False, when="+io", description="Reading of glTF")
    variant("grains", default=False, description="Clumps of spheres for discrete element codes")
    variant("robot", default=False, when="+io", description="Robots: URDF in, spheres of links out")
    variant("c", default=False, when="+io", description="libmorula, the library for C")
    variant("command", default=True, when="+io", description="The morula command")
    variant("threads", default=True, description="Workers that start threads")

    depends_on("cxx", type="build")
    depends_on("cmake@3.24:", type="build")
    depends_on("nlohmann-json@3.10:", when="+io", type="build")
    depends_on("tinygltf", when="+gltf", type="build")
    depends_on("tinyxml2", when="+robot")
    depends_on("fmt@9:", when="+robot", type="build")
    depends_on("fmt@9:", when="+command")
    depends_on("cli11@2.1:", when="+command", type="build")

    conflicts("platform=windows", msg="Morula has not been tried on Windows")

    def cmake_args(self):
        off = ("MORULA_PAGE", "MORULA_STUDY", "MORULA_PYTHON", "MORULA_TESTS", "MORULA_BENCH", "MORULA_BITS", "MORULA_EXAMPLES")
        return [
            self.define("MORULA_INSTALL", True),
            self.define_from_variant("MORULA_IO", "io"),
            self.define("MORULA_GLTF", self.spec.satisfies("+gltf")),
            self.define_from_variant("MORULA_GRAINS", "grains"),
            self.define("MORULA_ROBOT", self.spec.satisfies("+robot")),
            self.define("MORULA_C", self.spec.satisfies("+c")),
            self.define("MORULA_APPS", self.spec.satisfies("+command")),
            self.define_from_variant("MORULA_THREADS", "threads"),
            *(self.define(option, False) for option in off),
        ]
