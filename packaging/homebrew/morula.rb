# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Homebrew builds an archive of the clone; a formula of a tap names a release's address and checksum instead.
#   git archive --prefix=morula-0.1.0/ -o morula-0.1.0.tar.gz HEAD
#   HOMEBREW_MORULA_ARCHIVE="$PWD/morula-0.1.0.tar.gz" brew install --build-from-source packaging/homebrew/morula.rb
class Morula < Formula
  desc "Certified sphere trees for deforming triangle meshes"
  url "file://#{ENV.fetch("HOMEBREW_MORULA_ARCHIVE")}"
  version "0.1.0"
  license "Apache-2.0"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "fmt"
  depends_on "tinyxml2"

  def install
    # tinygltf is no formula: glTF is not read.
    system "cmake", "-S", ".", "-B", "build/homebrew", "-G", "Ninja",
           "-DMORULA_INSTALL=ON",
           "-DMORULA_IO=ON",
           "-DMORULA_GLTF=OFF",
           "-DMORULA_GRAINS=ON",
           "-DMORULA_ROBOT=ON",
           "-DMORULA_C=ON",
           "-DMORULA_APPS=ON",
           "-DMORULA_PAGE=OFF",
           "-DMORULA_STUDY=OFF",
           "-DMORULA_PYTHON=OFF",
           "-DMORULA_TESTS=OFF",
           "-DMORULA_BENCH=OFF",
           "-DMORULA_BITS=OFF",
           "-DMORULA_EXAMPLES=OFF",
           *std_cmake_args
    system "cmake", "--build", "build/homebrew"
    system "cmake", "--install", "build/homebrew"
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/morula --version")
    system bin/"morula", "sample", "limb", "-o", "limb.obj"
    system bin/"morula", "build", "limb.obj", "-o", "limb.morula"
    system bin/"morula", "measure", "limb.obj", "limb.morula"
  end
end
