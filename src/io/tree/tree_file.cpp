// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <morula/geometry/scale.hpp>
#include <morula/io/files.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>

#include "io/mesh/formats.hpp"
#include "io/tree/formats.hpp"
#include "io/tree/sphere_archive.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr const char* known_extensions = ".morula .sph .json .npz";

[[noreturn]] void fail_unknown(const std::filesystem::path& path, const std::string& extension) {
  throw FileError(platform::text_of(path) + ": " +
                  (extension.empty() ? "no extension" : "extension " + in_quotes(extension)) +
                  " says no known tree format; use one of " + known_extensions);
}

bool is_tree_extension(std::string_view extension) {
  return extension == ".morula" || extension == ".sph" || extension == ".json" || extension == ".npz";
}

SphereTree tree_of_ply(const std::filesystem::path& path, std::string_view bytes) {
  const std::vector<Sphere> balls = read_ply_balls(path, bytes);
  try {
    return tree_from_spheres(balls);
  } catch (const std::invalid_argument& problem) {
    throw FileError(platform::text_of(path) + ": " + problem.what());
  }
}

void require_writable(const SphereTree& tree) {
  if (const auto faults = validate(tree); !faults.empty())
    throw std::invalid_argument("the sphere tree cannot be written: " + faults.front());
  if (tree.level_count() > max_depth + 1)
    throw std::invalid_argument("the sphere tree cannot be written: it has " + std::to_string(tree.level_count()) +
                                " levels, more than " + std::to_string(max_depth + 1));
}

}  // namespace

void detail::require_valid(const std::filesystem::path& path, const SphereTree& tree) {
  if (const auto faults = validate(tree); !faults.empty())
    throw FileError(platform::text_of(path) + ": the tree is broken: " + faults.front());
}

TreeFile read_tree(const std::filesystem::path& path, const ReadTreeOptions& options) {
  const StandardFloats standard;
  const std::string extension = lower_extension(path);
  if (extension.empty() && !std::filesystem::exists(path))
    throw SystemFileError(path, "there is no such file or folder; check the name, or where you are", ENOENT);
  if (!is_tree_extension(extension) && extension != ".ply") fail_unknown(path, extension);
  if (!is_finite(options.sph_origin)) throw std::invalid_argument("sph_origin has a coordinate that is not finite");
  return tree_of_bytes(path, read_whole(path), options);
}

TreeFile detail::tree_of_bytes(const std::filesystem::path& path, std::string_view bytes,
                               const ReadTreeOptions& options) {
  const std::string extension = lower_extension(path);
  if (extension == ".morula") return read_native(path, bytes);
  TreeFile file;
  file.tree = extension == ".sph"   ? read_sph(path, bytes, options.sph_origin)
              : extension == ".npz" ? read_npz_tree(ByteSource(path, bytes))
              : extension == ".ply" ? tree_of_ply(path, bytes)
                                    : read_json_tree(path, bytes);
  return file;
}

CoveredTree read_covered_tree(const std::filesystem::path& path, const MeshView& mesh, const ReadTreeOptions& options,
                              WorkersOrAll given) {
  Workers& workers = given;
  require_usable(mesh);
  return built_of_file(path, read_tree(path, options), mesh, workers);
}

CoveredTree detail::built_of_file(const std::filesystem::path& path, TreeFile file, const MeshView& mesh,
                                  Workers& workers) {
  if (file.cover) return covered_by_file(path, std::move(file), mesh);
  require_usable_scale(mesh);
  try {
    return cover(mesh, file.tree, {}, workers);
  } catch (const std::invalid_argument& fault) {  // the mesh is usable, so the fault is in the tree
    throw FileError(platform::text_of(path) + ": " + fault.what());
  }
}

CoveredTree detail::covered_by_file(const std::filesystem::path& path, TreeFile file, const MeshView& mesh) {
  if (file.report.mesh_hash != mesh_hash(mesh) || file.cover->vertex_count != mesh.vertex_count() ||
      file.cover->facet_count != mesh.facet_count())
    throw FileError(platform::text_of(path) +
                    ": was built for another mesh (mesh hash differs: " + std::to_string(file.cover->vertex_count) +
                    " vertices and " + std::to_string(file.cover->facet_count) + " facets there, " +
                    std::to_string(mesh.vertex_count()) + " and " + std::to_string(mesh.facet_count()) +
                    " here); give the mesh it was built for, or build it again");
  CoveredTree model{std::move(file.tree), std::move(*file.cover), std::move(file.report), std::move(file.poses)};
  if (const auto faults = validate(mesh, model); !faults.empty())
    throw FileError(platform::text_of(path) + ": " + faults.front() +
                    "; the file was not written by this library, build it again");
  return model;
}

void write_tree(const std::filesystem::path& path, const CoveredTree& model) {
  if (lower_extension(path) != ".morula") return write_tree(path, model.tree);
  require_writable(model.tree);
  if (const auto faults = validate(model.tree, model.cover); !faults.empty())
    throw std::invalid_argument("the cover cannot be written: " + faults.front());
  for (const KnownPose& pose : model.poses)
    if (!pose.model || pose.positions.size() != model.cover.vertex_count || !pose.model->poses.empty() ||
        !validate(pose.model->tree).empty() || !validate(pose.model->tree, pose.model->cover).empty())
      throw std::invalid_argument("the known pose \"" + pose.name +
                                  "\" cannot be written: its tree is broken, or not " + "of this mesh");
  write_whole(path, native_bytes(model));
}

void write_tree(const std::filesystem::path& path, const SphereTree& tree) {
  const std::string extension = lower_extension(path);
  if (extension == ".morula")
    throw FileError(platform::text_of(path) +
                    ": a .morula file holds a tree with its cover, but there are spheres alone; make a cover for a " +
                    "mesh first, or write .sph or .json");
  if (!is_tree_extension(extension)) fail_unknown(path, extension);
  require_writable(tree);
  if (extension == ".npz") return write_tree_archive(path, tree);
  write_whole(path, extension == ".sph" ? sph_text(path, tree) : json_tree_text(tree));
}

}  // namespace morula
