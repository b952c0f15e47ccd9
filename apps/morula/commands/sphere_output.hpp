// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Output of an update's spheres: a folder with a tree file per frame, or one NumPy archive. Its write is atomic.
#pragma once

#include <filesystem>
#include <morula/io/spheres_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/files.hpp"

namespace morula::cli {

/// The format meant: that of --format, or, when it is empty, npz for a path that ends so and sph for others. Throws
/// UsageError when there is no such format or the path contradicts it.
std::string sphere_format(const std::string& given, const std::string& output);
/// Throws UsageError when the output cannot be made there, is also an input, or is a folder with files that would be
/// read as frames.
void require_sphere_output(const std::string& output, const std::string& format, std::size_t frame_count,
                           const std::vector<std::filesystem::path>& inputs);

class SphereOutput {
 public:
  SphereOutput(const std::string& output, const std::string& format, const SphereTree& tree, std::size_t frame_count);
  /// The next frame.
  void write(const Body& body);
  void commit();
  /// The name for messages: the file, or the first of the files.
  std::string name() const;

 private:
  std::string output_;
  std::string extension_;
  std::optional<WholeFolder> folder_;
  std::optional<SphereFramesWriter> archive_;
  std::size_t frame_count_;
  std::size_t written_ = 0;
};

}  // namespace morula::cli
