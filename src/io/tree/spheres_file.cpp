// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cerrno>
#include <morula/io/files.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>

#include "io/array/npy.hpp"
#include "io/array/stored_zip.hpp"
#include "io/byte_reader.hpp"
#include "io/tree/formats.hpp"
#include "io/tree/sphere_archive.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

// no_node becomes -1.
std::string index_array(std::span<const std::uint32_t> indices) {
  std::vector<std::int32_t> values;
  for (const std::uint32_t i : indices) values.push_back(static_cast<std::int32_t>(i));
  return npy_bytes(values, std::array{values.size()});
}

}  // namespace

SphereFramesWriter::~SphereFramesWriter() = default;

SphereFramesWriter::SphereFramesWriter(const std::filesystem::path& path, const SphereTree& tree,
                                       std::size_t frame_count)
    : path_(path), tree_(tree), frame_count_(frame_count) {
  if (lower_extension(path) != ".npz") throw std::invalid_argument(platform::text_of(path) + " does not end in .npz");
  std::error_code error;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, error))
    throw SystemFileError(path, "there is no such folder; make it first", ENOENT);
  // The headers and the arrays of the tree take less than 40 bytes per node plus a few thousand.
  const std::uint64_t nodes = tree.node_count();
  const std::uint64_t room = StoredZip::largest - (1u << 16) - 40 * nodes;
  if (frame_count > room / (32 * nodes))
    throw FileError(platform::text_of(path) + ": " + std::to_string(frame_count) + " frames of " +
                    std::to_string(nodes) +
                    " spheres do not fit the 4 GiB of an archive; write fewer frames at a time, or a folder");
  const std::string start = npy_start("<f8", std::array<std::size_t, 3>{frame_count, tree.node_count(), 4});
  const std::uint64_t size = start.size() + 32 * nodes * frame_count;
  require_room(path, size);
  archive_ = std::make_unique<StoredZip>(path);
  archive_->begin("spheres.npy", size);
  archive_->append(start);
}

void SphereFramesWriter::write(std::span<const Sphere> spheres) {
  if (written_ == frame_count_)
    throw std::invalid_argument("the motion has " + std::to_string(frame_count_) + " frames; this is one more");
  // Checks for interruption ahead of a frame, because a frame is written whole.
  check_interrupt();
  if (spheres.size() != tree_.node_count())
    throw std::invalid_argument("frame " + std::to_string(written_) + " has " + std::to_string(spheres.size()) +
                                " spheres, but the tree has " + std::to_string(tree_.node_count()) + " nodes");
  if (tree_.nested && !certify_nesting(tree_, spheres).nested) tree_.nested = false;
  chunk_.clear();
  for (const Sphere& s : spheres)
    for (const double number : {s.center.x, s.center.y, s.center.z, s.radius}) store(chunk_, number);
  archive_->append(chunk_);
  ++written_;
}

void SphereFramesWriter::finish() {
  const Uninterrupted whole;  // the archive is written once, from here to its end
  if (written_ < frame_count_)
    throw FileError(platform::text_of(path_) + ": " + std::to_string(written_) + " of " + std::to_string(frame_count_) +
                    " frames were written; the file is incomplete");
  archive_->end();
  add_structure(*archive_, tree_);
  archive_->commit();
}

namespace detail {

void add_structure(StoredZip& archive, const SphereTree& tree) {
  archive.add("level_begin.npy", index_array(tree.level_begin));
  archive.add("parent.npy", index_array(tree.parent));
  archive.add("first_child.npy", index_array(tree.first_child));
  archive.add("child_count.npy", index_array(tree.child_count));
  if (tree.nested) archive.add("nested.npy", index_array(std::array{1u}));
}

void write_tree_archive(const std::filesystem::path& path, const SphereTree& tree) {
  const std::uint64_t nodes = tree.node_count();
  if (nodes > (StoredZip::largest - (1u << 16)) / 72)
    throw FileError(platform::text_of(path) + ": " + std::to_string(nodes) +
                    " spheres do not fit the 4 GiB of an archive; write a .morula");
  std::vector<double> numbers;
  numbers.reserve(4 * tree.node_count());
  for (const Sphere& s : tree.spheres) numbers.insert(numbers.end(), {s.center.x, s.center.y, s.center.z, s.radius});
  StoredZip archive(path);
  archive.add("spheres.npy", npy_bytes(numbers, std::array<std::size_t, 2>{tree.node_count(), 4}));
  add_structure(archive, tree);
  archive.add("branching.npy", index_array(std::array{tree.branching}));
  archive.commit();
}

}  // namespace detail

struct SphereFrames::Arrays {
  SphereArchive archive;
};

SphereFrames::~SphereFrames() = default;
SphereFrames::SphereFrames(SphereFrames&&) noexcept = default;
SphereFrames& SphereFrames::operator=(SphereFrames&&) noexcept = default;

SphereFrames::SphereFrames(const std::filesystem::path& path) {
  const StandardFloats standard;
  if (lower_extension(path) != ".npz")
    throw FileError(platform::text_of(path) + ": spheres of frames are read from .npz");
  arrays_ = std::make_unique<const Arrays>(Arrays{SphereArchive(path)});
}

std::size_t SphereFrames::frame_count() const {
  return arrays_->archive.frame_count();
}
std::size_t SphereFrames::node_count() const {
  return arrays_->archive.node_count();
}
bool SphereFrames::is_motion() const {
  return arrays_->archive.is_motion();
}
SphereTree SphereFrames::frame(std::size_t i) const {
  const StandardFloats standard;
  if (i >= frame_count())
    throw std::invalid_argument("frame " + std::to_string(i) + " of " + std::to_string(frame_count()));
  return arrays_->archive.frame(i);
}

bool holds_spheres(const std::filesystem::path& path) {
  if (lower_extension(path) != ".npz") return false;
  try {
    for (const ZipEntry& entry : zip_entries(path))
      if (entry.name == "spheres.npy") return true;
  } catch (const FileError&) {
    return false;
  }
  return false;
}

}  // namespace morula
