// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/geometry/scale.hpp>
#include <morula/io/tree_file.hpp>
#include <stdexcept>

#include "io/tree/formats.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
namespace {

constexpr const char* known_extensions = ".morula .sph .json";

[[noreturn]] void fail_unknown(const std::filesystem::path& path, const std::string& extension) {
  throw FileError(path.string() + ": " + (extension.empty() ? "no extension" : "extension " + in_quotes(extension)) +
                  " says no known tree format; use one of " + known_extensions);
}

void require_writable(const SphereTree& tree) {
  if (const auto faults = validate(tree); !faults.empty())
    throw std::invalid_argument("the sphere tree cannot be written: " + faults.front());
  if (tree.level_count() > max_depth + 1)
    throw std::invalid_argument("the sphere tree cannot be written: it has " + std::to_string(tree.level_count()) +
                                " levels, more than " + std::to_string(max_depth + 1));
}

std::string fault_of_patches(const Cover& cover) {
  const std::size_t patches = cover.patch_count();
  if (cover.corner_begin.size() != patches + 1 || cover.corner_begin.front() != 0 ||
      cover.corner_begin.back() != cover.corners.size())
    return "corner_begin does not span the corners of all patches";
  for (std::size_t p = 0; p < patches; ++p) {
    const auto patch = [p] { return "patch " + std::to_string(p); };
    if (cover.corner_begin[p + 1] < cover.corner_begin[p] || cover.corner_begin[p + 1] - cover.corner_begin[p] < 3)
      return patch() + " has fewer than 3 corners";
    if (cover.patch_facet[p] >= cover.facet_count)
      return patch() + " lies on facet " + std::to_string(cover.patch_facet[p]) + " of " +
             std::to_string(cover.facet_count);
  }
  const std::uint64_t points = std::uint64_t{cover.vertex_count} + cover.cut_points.size();
  for (const std::uint32_t corner : cover.corners)
    if (corner >= points) return "a patch has corner " + std::to_string(corner) + " of " + std::to_string(points);
  return {};
}

std::string fault_of_cut_points(const Cover& cover) {
  for (std::size_t i = 0; i < cover.cut_points.size(); ++i) {
    const CutPoint& point = cover.cut_points[i];
    const auto name = [i] { return "cut point " + std::to_string(i); };
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (point.vertex[k] >= cover.vertex_count)
        return name() + " refers to vertex " + std::to_string(point.vertex[k]) + " of " +
               std::to_string(cover.vertex_count);
      if (!(point.weight[k] >= 0 && point.weight[k] <= 1)) return name() + " has a weight that is not in 0…1";
      sum += point.weight[k];
    }
    // Looser than rounding makes it: validate(mesh, built) is the strict judge.
    if (std::abs(sum - 1) > 1e-9) return name() + " has weights that do not add up to 1";
  }
  return {};
}

std::string fault_of_regions(const SphereTree& tree, const Cover& cover) {
  const std::size_t nodes = tree.node_count();
  if (cover.region_begin.size() != nodes || cover.region_end.size() != nodes)
    return "there is not one region for each node";
  if (cover.region_begin[0] != 0 || cover.region_end[0] != cover.patch_count())
    return "the root's region is not all patches";
  for (std::uint32_t i = 0; i < nodes; ++i) {
    const auto region = [i] { return "the region of node " + std::to_string(i); };
    if (cover.region_begin[i] > cover.region_end[i] || cover.region_end[i] > cover.patch_count())
      return region() + " is not a range of patches";
    std::uint32_t next = cover.region_begin[i];
    for (std::uint32_t k = 0; k < tree.child_count[i]; ++k) {
      const std::uint32_t child = tree.first_child[i] + k;
      if (cover.region_begin[child] != next) return region() + " is not its children's regions one after another";
      next = cover.region_end[child];
    }
    if (!tree.is_leaf(i) && next != cover.region_end[i])
      return region() + " is not its children's regions one after another";
  }
  return {};
}

}  // namespace

std::string cover_fault(const SphereTree& tree, const Cover& cover) {
  for (const std::string& fault : {fault_of_patches(cover), fault_of_cut_points(cover), fault_of_regions(tree, cover)})
    if (!fault.empty()) return fault;
  return {};
}

void require_valid(const std::filesystem::path& path, const SphereTree& tree) {
  if (const auto faults = validate(tree); !faults.empty())
    throw FileError(path.string() + ": the tree is broken: " + faults.front());
}

TreeFile read_tree(const std::filesystem::path& path, const ReadTreeOptions& options) {
  const StandardFloats standard;
  const std::string extension = lower_extension(path);
  if (extension != ".morula" && extension != ".sph" && extension != ".json") fail_unknown(path, extension);
  if (!is_finite(options.sph_origin)) throw std::invalid_argument("sph_origin has a coordinate that is not finite");
  return tree_of_bytes(path, read_whole(path), options);
}

TreeFile tree_of_bytes(const std::filesystem::path& path, std::string_view bytes, const ReadTreeOptions& options) {
  const std::string extension = lower_extension(path);
  if (extension == ".morula") return read_native(path, bytes);
  TreeFile file;
  file.tree = extension == ".sph" ? read_sph(path, bytes, options.sph_origin) : read_json_tree(path, bytes);
  return file;
}

Built read_built(const std::filesystem::path& path, const Mesh& mesh, const ReadTreeOptions& options,
                 Workers& workers) {
  require_usable(mesh);
  return built_of_file(path, read_tree(path, options), mesh, workers);
}

Built built_of_file(const std::filesystem::path& path, TreeFile file, const Mesh& mesh, Workers& workers) {
  if (!file.cover) {
    require_usable_scale(mesh);
    try {
      return cover(mesh, file.tree, workers);
    } catch (const std::invalid_argument& fault) {  // the mesh is usable, so it is of the tree
      throw FileError(path.string() + ": " + fault.what());
    }
  }
  if (file.report.mesh_hash != mesh_hash(mesh) || file.cover->vertex_count != mesh.vertex_count() ||
      file.cover->facet_count != mesh.facet_count())
    throw FileError(path.string() +
                    ": was built for another mesh (mesh hash differs: " + std::to_string(file.cover->vertex_count) +
                    " vertices and " + std::to_string(file.cover->facet_count) + " facets there, " +
                    std::to_string(mesh.vertex_count()) + " and " + std::to_string(mesh.facet_count()) +
                    " here); give the mesh it was built for, or build it again");
  Built built{std::move(file.tree), std::move(*file.cover), std::move(file.report)};
  if (const auto faults = validate(mesh, built); !faults.empty())
    throw FileError(path.string() + ": " + faults.front() +
                    "; the file was not written by this library, build it again");
  return built;
}

void write_tree(const std::filesystem::path& path, const Built& built) {
  if (lower_extension(path) != ".morula") return write_tree(path, built.tree);
  require_writable(built.tree);
  if (const std::string fault = cover_fault(built.tree, built.cover); !fault.empty())
    throw std::invalid_argument("the cover cannot be written: " + fault);
  write_whole(path, native_bytes(built));
}

void write_tree(const std::filesystem::path& path, const SphereTree& tree) {
  const std::string extension = lower_extension(path);
  if (extension == ".morula")
    throw FileError(path.string() +
                    ": a .morula file holds a tree with its cover, but there are spheres alone; make a cover for a " +
                    "mesh first, or write .sph or .json");
  if (extension != ".sph" && extension != ".json") fail_unknown(path, extension);
  require_writable(tree);
  write_whole(path, extension == ".sph" ? sph_text(path, tree) : json_tree_text(tree));
}

}  // namespace morula
