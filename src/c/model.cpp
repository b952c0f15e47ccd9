// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes and models of the C interface.
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

// Callers get both as arrays of numbers.
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Facet) == 3 * sizeof(std::uint32_t));
static_assert(sizeof(Sphere) == sizeof(morula_sphere) && offsetof(Sphere, radius) == offsetof(morula_sphere, radius));

namespace {

morula_mesh* handle_of(Mesh&& mesh) {
  return new morula_mesh{std::make_shared<const Mesh>(std::move(mesh))};
}
morula_model* handle_of(CoveredTree&& model) {
  return new morula_model{std::make_shared<const CoveredTree>(std::move(model))};
}

template <class Value>
Value named(const char* name, std::optional<Value> (*from)(std::string_view), const char* what) {
  require_pointer(name, what);
  if (const std::optional<Value> value = from(name)) return *value;
  throw std::invalid_argument(std::string(what) + ": there is no \"" + name + "\"");
}

}  // namespace

morula_status morula_mesh_create(const double* positions, size_t vertex_count, const uint32_t* facets,
                                 size_t facet_count, morula_mesh** mesh) {
  return guarded([&] {
    require_pointer(mesh, "mesh");
    *mesh = nullptr;
    if (vertex_count != 0) require_pointer(positions, "positions");
    if (facet_count != 0) require_pointer(facets, "facets");
    Mesh made;
    made.positions.reserve(vertex_count);
    for (const double* p = positions; made.positions.size() < vertex_count; p += 3)
      made.positions.push_back({p[0], p[1], p[2]});
    made.facets.reserve(facet_count);
    for (const std::uint32_t* f = facets; made.facets.size() < facet_count; f += 3)
      made.facets.push_back({f[0], f[1], f[2]});
    require_usable(made);
    *mesh = handle_of(std::move(made));
    return MORULA_OK;
  });
}

morula_status morula_mesh_read(const char* path, morula_mesh** mesh) {
  return guarded([&] {
    require_pointer(mesh, "mesh");
    *mesh = nullptr;
    require_pointer(path, "path");
    *mesh = handle_of(read_mesh(path_of(path)));
    return MORULA_OK;
  });
}

morula_status morula_mesh_write(const morula_mesh* mesh, const char* path) {
  return guarded([&] {
    require_pointer(mesh, "mesh");
    require_pointer(path, "path");
    write_mesh(path_of(path), *mesh->mesh);
    return MORULA_OK;
  });
}

morula_status morula_mesh_sample(const char* name, int resolution, morula_mesh** mesh) {
  return guarded([&] {
    require_pointer(mesh, "mesh");
    *mesh = nullptr;
    require_pointer(name, "name");
    *mesh = handle_of(sample_body(name, resolution));
    return MORULA_OK;
  });
}

void morula_mesh_destroy(morula_mesh* mesh) {
  delete mesh;
}
size_t morula_mesh_vertex_count(const morula_mesh* mesh) {
  return mesh == nullptr ? 0 : mesh->mesh->vertex_count();
}
size_t morula_mesh_facet_count(const morula_mesh* mesh) {
  return mesh == nullptr ? 0 : mesh->mesh->facet_count();
}
const double* morula_mesh_positions(const morula_mesh* mesh) {
  return mesh == nullptr ? nullptr : &mesh->mesh->positions.data()->x;
}
const uint32_t* morula_mesh_facets(const morula_mesh* mesh) {
  return mesh == nullptr ? nullptr : mesh->mesh->facets.data()->data();
}

void morula_build_options_defaults(morula_build_options* options, size_t size) {
  write_defaults(options, size, [](morula_build_options& defaults) {
    defaults.method = "optimized";
    defaults.quality = "default";
    defaults.branching = 8;
    defaults.depth = -1;
    defaults.seed = 1;
    defaults.threads = 0;
  });
}

morula_status morula_build(const morula_mesh* mesh, const morula_build_options* options, morula_model** model) {
  return guarded([&] {
    require_pointer(model, "model");
    *model = nullptr;
    require_pointer(mesh, "mesh");
    const morula_build_options wanted = over_defaults(options, &morula_build_options_defaults);
    StopSource stop;
    BuildOptions by{.method = named(wanted.method, &method_from_name, "method"),
                    .branching = wanted.branching,
                    .nested = wanted.nested != 0,
                    .seed = wanted.seed,
                    .quality = named(wanted.quality, &quality_from_name, "quality"),
                    .stop = stop.get_token()};
    if (wanted.depth != -1) by.depth = wanted.depth;
    if (wanted.spheres != 0) by.spheres = wanted.spheres;
    if (wanted.max_protrusion != 0) by.max_protrusion = wanted.max_protrusion;
    if (wanted.time_limit_seconds != 0) by.time_limit_seconds = wanted.time_limit_seconds;
    if (wanted.progress != nullptr)
      by.progress = [&](const BuildProgress& progress) {
        if (wanted.progress(progress.share, wanted.user) != 0) stop.request_stop();
      };
    Workers workers(wanted.threads == 0 ? 0 : thread_count(wanted.threads));
    *model = handle_of(build(*mesh->mesh, by, workers));
    return MORULA_OK;
  });
}

morula_status morula_model_read(const char* path, const morula_mesh* mesh, morula_model** model) {
  return guarded([&] {
    require_pointer(model, "model");
    *model = nullptr;
    require_pointer(path, "path");
    require_pointer(mesh, "mesh");
    *model = handle_of(read_covered_tree(path_of(path), *mesh->mesh));
    return MORULA_OK;
  });
}

morula_status morula_model_write(const morula_model* model, const char* path) {
  return guarded([&] {
    require_pointer(model, "model");
    require_pointer(path, "path");
    write_tree(path_of(path), *model->model);
    return MORULA_OK;
  });
}

void morula_model_destroy(morula_model* model) {
  delete model;
}
size_t morula_model_node_count(const morula_model* model) {
  return model == nullptr ? 0 : model->model->tree.node_count();
}
size_t morula_model_level_count(const morula_model* model) {
  return model == nullptr ? 0 : model->model->tree.level_count();
}
size_t morula_model_leaf_count(const morula_model* model) {
  return model == nullptr ? 0 : model->model->tree.leaf_count();
}
const morula_sphere* morula_model_spheres(const morula_model* model) {
  // Two standard-layout structs of four doubles each, in the same order, as asserted above.
  return model == nullptr ? nullptr : reinterpret_cast<const morula_sphere*>(model->model->tree.spheres.data());
}
const uint32_t* morula_model_first_child(const morula_model* model) {
  return model == nullptr ? nullptr : model->model->tree.first_child.data();
}
const uint32_t* morula_model_child_count(const morula_model* model) {
  return model == nullptr ? nullptr : model->model->tree.child_count.data();
}
const uint32_t* morula_model_parent(const morula_model* model) {
  return model == nullptr ? nullptr : model->model->tree.parent.data();
}

morula_status morula_model_level_set(const morula_model* model, size_t level, uint32_t* nodes, size_t capacity,
                                     size_t* count) {
  return guarded([&] {
    require_pointer(count, "count");
    *count = 0;
    require_pointer(model, "model");
    if (capacity != 0) require_pointer(nodes, "nodes");
    const std::vector<std::uint32_t> set = level_set(model->model->tree, level);
    *count = set.size();
    std::copy_n(set.begin(), std::min(capacity, set.size()), nodes);
    return MORULA_OK;
  });
}
