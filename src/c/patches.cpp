// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of the C interface.
#include <algorithm>
#include <morula/collide/contact_patches.hpp>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

/// The results are those of the last run that succeeded: a run copies them into the lists of the other half, and then
/// takes that half.
struct morula_patches {
  struct Results {
    std::vector<morula_patch> patches;
    std::vector<morula_patch_point> points;
    std::vector<morula_vertex_gradient> gradients;
    double volume = 0;
    bool certified = false;
  };

  morula_patches(std::shared_ptr<morula_body> of_a, std::shared_ptr<morula_body> of_b)
      : a(std::move(of_a)), b(std::move(of_b)), query(a->collider, b->collider) {}

  std::shared_ptr<morula_body> a, b;  // declared ahead of the query, which borrows their colliders
  ContactPatchQuery query;
  Results last, next;
};

namespace {

void copy_point(const SurfacePoint& from, std::uint32_t& facet, double* point, double* barycentric) {
  facet = from.facet;
  copy(from.point, point);
  std::copy(from.barycentric.begin(), from.barycentric.end(), barycentric);
}

morula_patch_point point_of(const PatchPoint& from) {
  morula_patch_point to{};
  to.id = from.id;
  copy(from.point, to.point);
  copy(from.force, to.force);
  to.volume = from.volume;
  to.depth = from.depth;
  copy_point(from.on_a, to.facet_a, to.point_a, to.barycentric_a);
  copy_point(from.on_b, to.facet_b, to.point_b, to.barycentric_b);
  return to;
}

/// The side, with the number of its gradients.
morula_patch_side side_of(const PatchSide& from) {
  morula_patch_side to{};
  copy(from.area_vector, to.area_vector);
  copy(from.moment, to.moment);
  to.area = from.area;
  to.gradient_count = from.gradients.size();
  return to;
}

morula_patch patch_of(const ContactPatch& from) {
  morula_patch to{};
  to.id = from.id;
  to.volume = from.volume;
  copy(from.centroid, to.centroid);
  copy(from.normal, to.normal);
  to.depth = from.depth;
  to.mean_depth = from.mean_depth;
  to.a = side_of(from.a), to.b = side_of(from.b);
  to.point_count = from.points.size();
  return to;
}

void read(const ContactPatchQuery& query, morula_patches::Results& to) {
  to.patches.clear(), to.points.clear(), to.gradients.clear();
  for (const ContactPatch& patch : query.patches()) {
    to.patches.push_back(patch_of(patch));
    for (const PatchPoint& point : patch.points) to.points.push_back(point_of(point));
    for (const PatchSide* side : {&patch.a, &patch.b})
      for (const VertexGradient& gradient : side->gradients) {
        to.gradients.push_back({gradient.vertex, 0, {}});
        copy(gradient.gradient, to.gradients.back().gradient);
      }
  }
  const morula_patch_point* points = to.points.data();
  const morula_vertex_gradient* gradients = to.gradients.data();
  for (morula_patch& patch : to.patches) {
    patch.points = points;
    points += patch.point_count;
    for (morula_patch_side* side : {&patch.a, &patch.b}) {
      side->gradients = gradients;
      gradients += side->gradient_count;
    }
  }
  to.volume = query.volume();
  to.certified = query.certified();
}

ContactPatchOptions patch_options(const morula_patch_options* given) {
  const morula_patch_options wanted = over_defaults(given, &morula_patch_options_defaults);
  if (wanted.max_points < 0 || wanted.max_points > 16)
    throw std::invalid_argument("max_points is " + std::to_string(wanted.max_points) + ": 0 to 16 are possible");
  return {.max_points = static_cast<std::uint32_t>(wanted.max_points), .depths = wanted.depths != 0};
}

}  // namespace

void morula_patch_options_defaults(morula_patch_options* options, size_t size) {
  write_defaults(options, size, [](morula_patch_options& defaults) {
    defaults.max_points = 4;
    defaults.depths = 1;
  });
}

morula_status morula_patches_create(morula_body* a, morula_body* b, morula_patches** patches) {
  return guarded([&] {
    require_pointer(patches, "patches");
    *patches = nullptr;
    require_pointer(a, "a");
    require_pointer(b, "b");
    *patches = new morula_patches(a->of_caller, b->of_caller);
    return MORULA_OK;
  });
}

void morula_patches_destroy(morula_patches* patches) {
  delete patches;
}

morula_status morula_patches_run(morula_patches* patches, const morula_patch_options* options) {
  return guarded([&]() -> morula_status {
    require_pointer(patches, "patches");
    if (const Status status = patches->query.run(patch_options(options)); !status) return code_of(status);
    read(patches->query, patches->next);
    std::swap(patches->last, patches->next);
    return MORULA_OK;
  });
}

size_t morula_patches_count(const morula_patches* patches) {
  return patches == nullptr ? 0 : patches->last.patches.size();
}
const morula_patch* morula_patches_data(const morula_patches* patches) {
  return patches == nullptr ? nullptr : patches->last.patches.data();
}
double morula_patches_volume(const morula_patches* patches) {
  return patches == nullptr ? 0 : patches->last.volume;
}
int morula_patches_certified(const morula_patches* patches) {
  return patches != nullptr && patches->last.certified ? 1 : 0;
}
