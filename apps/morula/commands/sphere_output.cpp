// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/sphere_output.hpp"

#include <fmt/format.h>

#include <morula/io/tree_file.hpp>

#include "shared/command.hpp"
#include "shared/options.hpp"

namespace morula::cli {

std::string sphere_format(const std::string& given, const std::string& output) {
  const bool is_archive = extension(output) == ".npz";
  if (given.empty()) return is_archive ? "npz" : "sph";
  check_name("format", given, {"sph", "json", "npz"});
  if (is_archive && given != "npz") {
    throw UsageError(fmt::format("{}: --format {} is written into a folder; name one", output, given));
  }
  if (!is_archive && given == "npz") {
    throw UsageError(fmt::format("{}: --format npz is one file; name it {}.npz", output, output));
  }
  return given;
}

void require_sphere_output(const std::string& output, const std::string& format, std::size_t frame_count,
                           const std::vector<std::filesystem::path>& inputs) {
  if (format == "npz") {
    require_output_place(output);
    require_not_input(output, inputs);
  } else {
    require_folder_place(output);
    require_frames_not_input(output, frame_count, "." + format, inputs);
    require_no_foreign_files(output, frame_count, "." + format, {".sph", ".json", ".morula"});
  }
}

SphereOutput::SphereOutput(const std::string& output, const std::string& format, const SphereTree& tree,
                           std::size_t frame_count)
    : output_(output), extension_("." + format), frame_count_(frame_count) {
  if (format == "npz") {
    archive_.emplace(output, tree, frame_count);
  } else {
    folder_.emplace(output);
  }
}

void SphereOutput::write(const Body& body) {
  const SphereTree tree = body.current_tree();
  if (archive_) {
    archive_->write(tree.spheres);
  } else {
    const std::filesystem::path file = folder_->path() / frame_file_name(written_, extension_);
    write_tree(file, tree);
    // Frames are about as long as the first: half of that is plainly needed.
    if (written_ == 0) require_room(output_, std::filesystem::file_size(file) / 2 * frame_count_);
  }
  ++written_;
}

void SphereOutput::commit() {
  if (archive_) {
    archive_->finish();
  } else {
    folder_->commit();
  }
}

std::string SphereOutput::name() const {
  if (archive_) return output_;
  return (std::filesystem::path(output_) / frame_file_name(0, extension_)).string() + " ...";
}

}  // namespace morula::cli
