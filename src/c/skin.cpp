// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins of the C interface, and bounds of their clusters.
#include <cmath>
#include <limits>
#include <morula/io/skin_file.hpp>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

static_assert(sizeof(morula_spheref) == sizeof(Spheref) && sizeof(morula_boxf) == sizeof(Boxf));

Skin skin_from(std::size_t vertex_count, std::size_t influences, const std::uint32_t* bones, const double* weights,
               std::size_t bone_count) {
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < vertex_count; ++v) {
    double sum = 0;
    for (std::size_t k = v * influences; k < (v + 1) * influences; ++k) {
      if (weights[k] == 0) continue;
      if (!std::isfinite(weights[k]) || bones[k] >= bone_count)
        throw std::invalid_argument("influence " + std::to_string(k - v * influences) + " of vertex " +
                                    std::to_string(v) + " has a weight that is not finite, or no bone");
      sum += weights[k];
    }
    for (std::size_t k = v * influences; sum > 0 && k < (v + 1) * influences; ++k)
      if (weights[k] != 0) skin.bones.push_back(bones[k]), skin.weights.push_back(weights[k] / sum);
    if (skin.bones.size() > std::numeric_limits<std::uint32_t>::max())
      throw std::invalid_argument("the skin has more than 2^32 - 1 influences");
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

Modes modes_from(std::size_t vertex_count, std::size_t mode_count, const double* displacements) {
  Modes modes{vertex_count, mode_count, {}};
  modes.displacements.reserve(vertex_count * mode_count);
  for (const double* u = displacements; modes.displacements.size() < vertex_count * mode_count; u += 3)
    modes.displacements.push_back({u[0], u[1], u[2]});
  return modes;
}

}  // namespace

void morula::detail::read_transforms(const double* rows, std::span<AffineTransform> transforms) {
  for (AffineTransform& t : transforms) {
    for (std::size_t k = 0; k < 3; ++k) t.columns[k] = {rows[k], rows[4 + k], rows[8 + k]};
    t.translation = {rows[3], rows[7], rows[11]};
    rows += 12;
  }
}

morula_status morula_skin_create(size_t vertex_count, size_t influences, const uint32_t* bones, const double* weights,
                                 size_t bone_count, morula_skin** skin) {
  return guarded([&] {
    require_pointer(skin, "skin");
    *skin = nullptr;
    if (vertex_count != 0 && influences != 0) require_pointer(bones, "bones"), require_pointer(weights, "weights");
    *skin = new morula_skin{skin_from(vertex_count, influences, bones, weights, bone_count)};
    return MORULA_OK;
  });
}

morula_status morula_skin_read(const char* path, const morula_mesh* mesh, morula_skin** skin) {
  return guarded([&] {
    require_pointer(skin, "skin");
    *skin = nullptr;
    require_pointer(path, "path");
    require_pointer(mesh, "mesh");
    *skin = new morula_skin{read_skin(path_of(path), *mesh->mesh)};
    return MORULA_OK;
  });
}

void morula_skin_destroy(morula_skin* skin) {
  delete skin;
}

size_t morula_skin_bone_count(const morula_skin* skin) {
  return skin == nullptr ? 0 : skin->skin.bone_count;
}

morula_status morula_skin_positions(const morula_skin* skin, const morula_mesh* mesh, const double* transforms,
                                    size_t bone_count, double* positions) {
  return guarded([&] {
    require_pointer(skin, "skin");
    require_pointer(mesh, "mesh");
    require_pointer(transforms, "transforms");
    require_pointer(positions, "positions");
    const std::size_t count = mesh->mesh->vertex_count();
    if (skin->skin.vertex_count() != count || skin->skin.bone_count != bone_count)
      throw std::invalid_argument("the skin has " + std::to_string(skin->skin.vertex_count()) + " vertices and " +
                                  std::to_string(skin->skin.bone_count) + " bones");
    std::vector<AffineTransform> read(bone_count);
    read_transforms(transforms, read);
    std::vector<Vec3> moved(count);
    move_by_skin(skin->skin, mesh->mesh->positions, read, moved);
    for (std::size_t v = 0; v < count; ++v)
      positions[3 * v] = moved[v].x, positions[3 * v + 1] = moved[v].y, positions[3 * v + 2] = moved[v].z;
    return MORULA_OK;
  });
}

morula_status morula_skin_bounds_create(const morula_mesh* mesh, const morula_skin* skin,
                                        const uint32_t* cluster_of_facet, morula_skin_bounds** bounds) {
  return morula_skin_bounds_create_morphed(mesh, skin, 0, nullptr, cluster_of_facet, bounds);
}

morula_status morula_skin_bounds_create_morphed(const morula_mesh* mesh, const morula_skin* skin, size_t target_count,
                                                const double* displacements, const uint32_t* cluster_of_facet,
                                                morula_skin_bounds** bounds) {
  return guarded([&] {
    require_pointer(bounds, "bounds");
    *bounds = nullptr;
    require_pointer(mesh, "mesh");
    require_pointer(skin, "skin");
    if (target_count != 0) require_pointer(displacements, "displacements");
    if (target_count > 0xffff) throw std::invalid_argument("there are 2^16 morph targets or more");
    const Modes targets = modes_from(mesh->mesh->vertex_count(), target_count, displacements);
    const std::size_t facets = mesh->mesh->facets.size();
    std::vector<std::uint32_t> one_cluster;
    if (cluster_of_facet == nullptr) one_cluster.resize(facets), cluster_of_facet = one_cluster.data();
    *bounds =
        new morula_skin_bounds{SkinBounds(*mesh->mesh, skin->skin, targets, std::span(cluster_of_facet, facets)), {}};
    return MORULA_OK;
  });
}

void morula_skin_bounds_destroy(morula_skin_bounds* bounds) {
  delete bounds;
}

size_t morula_skin_bounds_cluster_count(const morula_skin_bounds* bounds) {
  return bounds == nullptr ? 0 : bounds->bounds.cluster_count();
}

morula_status morula_skin_bounds_compute(morula_skin_bounds* bounds, const double* transforms, size_t character_count,
                                         morula_spheref* spheres, morula_boxf* boxes) {
  return morula_skin_bounds_compute_morphed(bounds, transforms, nullptr, character_count, spheres, boxes);
}

morula_status morula_skin_bounds_compute_morphed(morula_skin_bounds* bounds, const double* transforms,
                                                 const double* morphs, size_t character_count, morula_spheref* spheres,
                                                 morula_boxf* boxes) {
  return guarded([&] {
    require_pointer(bounds, "bounds");
    if (character_count == 0) return MORULA_OK;
    require_pointer(transforms, "transforms");
    SkinBounds& of = bounds->bounds;
    if (character_count > bounds->transforms.max_size() / std::max<std::size_t>(of.bone_count(), 1))
      throw std::length_error("the number of characters");
    bounds->transforms.resize(character_count * of.bone_count());
    read_transforms(transforms, bounds->transforms);
    const std::size_t count = character_count * of.cluster_count();
    SkinBoundsOutput output;
    if (spheres != nullptr) output.spheres = std::span(reinterpret_cast<Spheref*>(spheres), count);
    if (boxes != nullptr) output.boxes = std::span(reinterpret_cast<Boxf*>(boxes), count);
    const std::span<const double> own =
        morphs == nullptr ? std::span<const double>() : std::span(morphs, character_count * of.target_count());
    return code_of(of.bounds(bounds->transforms, own, output));
  });
}
