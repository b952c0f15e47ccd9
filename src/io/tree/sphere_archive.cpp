// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/tree/sphere_archive.hpp"

#include <algorithm>
#include <morula/io/mesh_file.hpp>
#include <numeric>
#include <optional>

#include "io/tree/formats.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& problem) {
  throw FileError(platform::text_of(path) + ": " + problem);
}

std::optional<ZipEntry> entry_of(const std::vector<ZipEntry>& entries, const std::string& array) {
  for (const ZipEntry& entry : entries)
    if (entry.name == array + ".npy") return entry;
  return std::nullopt;
}

ZipEntry require_entry(const ByteSource& source, const std::vector<ZipEntry>& entries, const std::string& array) {
  std::optional<ZipEntry> entry = entry_of(entries, array);
  if (!entry)
    fail(source.name(),
         "has no array '" + array + "'; a tree needs spheres, level_begin, parent, first_child and " + "child_count");
  return *std::move(entry);
}

std::vector<std::uint32_t> indices(const ByteSource& source, const ZipEntry& entry, bool minus_one_is_none) {
  require_sound(source, entry);
  const ByteSource part = zip_part(source, entry);
  const NpyArray array = read_npy_header(part, {.sizes = {0}, .words = "(numbers,)", .integers = true});
  return read_npy_indices(part, array, "the array", minus_one_is_none);
}

NpyArray sphere_header(const ByteSource& part) {
  if (npy_dimensions(part) == 2) return read_npy_header(part, {.sizes = {0, 4}, .words = "(nodes, 4)"});
  return read_npy_header(part, {.sizes = {0, 0, 4}, .words = "(frames, nodes, 4) or (nodes, 4)"});
}

}  // namespace

SphereArchive::SphereArchive(ByteSource source) : source_(std::move(source)), sphere_source_(source_) {
  const std::vector<ZipEntry> entries = zip_entries(source_);
  const ZipEntry spheres = require_entry(source_, entries, "spheres");
  sphere_source_ = zip_part(source_, spheres);
  spheres_ = sphere_header(sphere_source_);
  if (!is_motion()) require_sound(source_, spheres);
  if (frame_count() == 0) fail(source_.name(), "has no frames");
  const std::vector<std::uint32_t> child_count =
      indices(source_, require_entry(source_, entries, "child_count"), false);
  const std::vector<std::uint32_t> level_begin =
      indices(source_, require_entry(source_, entries, "level_begin"), false);
  const std::vector<std::uint32_t> parent = indices(source_, require_entry(source_, entries, "parent"), true);
  const std::vector<std::uint32_t> first_child = indices(source_, require_entry(source_, entries, "first_child"), true);
  const std::uint64_t nodes = spheres_.shape[spheres_.shape.size() - 2];
  if (child_count.size() != nodes || parent.size() != nodes || first_child.size() != nodes)
    fail(source_.name(), "spheres, parent, first_child and child_count differ in the number of nodes");

  std::uint32_t branching = 2;
  for (const std::uint32_t count : child_count) branching = std::max(branching, count);
  if (const std::optional<ZipEntry> entry = entry_of(entries, "branching")) {
    const std::vector<std::uint32_t> given = indices(source_, *entry, false);
    if (given.size() != 1 || given[0] < branching)
      fail(source_.name(), "the branching is not one number that no node has more children than");
    branching = given[0];
  }
  if (branching > max_branching)
    fail(source_.name(),
         "the branching is " + std::to_string(branching) + ", not 2 to " + std::to_string(max_branching));
  bool nested = false;
  if (const std::optional<ZipEntry> entry = entry_of(entries, "nested")) {
    const std::vector<std::uint32_t> given = indices(source_, *entry, false);
    if (given.size() != 1 || given[0] > 1) fail(source_.name(), "the array 'nested' is not one number, 0 or 1");
    nested = given[0] == 1;
  }
  structure_ = tree_of_counts(source_.name(), std::vector<Sphere>(nodes), child_count, level_begin, branching);
  if (structure_.parent != parent || structure_.first_child != first_child)
    fail(source_.name(), "parent or first_child are not those that child_count and level_begin give");
  structure_.nested = nested;
}

SphereTree SphereArchive::frame(std::size_t i) const {
  SphereTree tree = structure_;
  const std::vector<double> numbers = read_npy_values(sphere_source_, spheres_, 4 * i * node_count(), 4 * node_count());
  for (std::size_t node = 0; node < tree.node_count(); ++node) {
    const double* const n = numbers.data() + 4 * node;
    tree.spheres[node] = {{n[0], n[1], n[2]}, n[3]};
  }
  if (const auto faults = validate(tree); !faults.empty())
    fail(source_.name(), (is_motion() ? "frame " + std::to_string(i) + ": " : "the tree is broken: ") + faults.front());
  return tree;
}

SphereTree read_npz_tree(const ByteSource& source) {
  const SphereArchive archive(source);
  if (archive.frame_count() > 1)
    fail(source.name(), "holds the spheres of " + std::to_string(archive.frame_count()) +
                            " frames, where one tree is needed; take one out with morula convert --frame N");
  return archive.frame(0);
}

SphereTree tree_of_counts(const std::filesystem::path& path, std::span<const Sphere> spheres,
                          std::span<const std::uint32_t> child_count, std::span<const std::uint32_t> level_begin,
                          std::uint32_t branching) {
  const std::size_t nodes = spheres.size();
  if (level_begin.size() < 2 || level_begin.size() > max_depth + 2 || level_begin.front() != 0 || level_begin[1] != 1 ||
      level_begin.back() != nodes)
    fail(path, "level_begin does not lead from a single root to the last node in at most " +
                   std::to_string(max_depth + 1) + " levels");
  SphereTree tree;
  tree.branching = branching;
  std::span<const std::uint32_t> parents;  // child counts of the level above
  for (std::size_t level = 0; level + 1 < level_begin.size(); ++level) {
    const std::uint32_t begin = level_begin[level], end = level_begin[level + 1];
    if (begin >= end || end > nodes) fail(path, "level " + std::to_string(level) + " is empty or out of order");
    if (level > 0 && std::accumulate(parents.begin(), parents.end(), std::uint64_t{0}) != end - begin)
      fail(path, "the child counts above level " + std::to_string(level) + " do not add up to its nodes");
    tree.append_level(parents, spheres.subspan(begin, end - begin));
    parents = child_count.subspan(begin, end - begin);
  }
  for (const std::uint32_t count : parents)
    if (count != 0) fail(path, "a node of the last level has children");
  require_valid(path, tree);
  return tree;
}

}  // namespace morula::detail
