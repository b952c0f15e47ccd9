// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies of the C interface.
#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

std::vector<Rule> rules_from(std::string_view names, bool has_skin) {
  std::vector<Rule> rules;
  while (true) {
    const std::size_t comma = names.find(',');
    const std::string_view one = names.substr(0, comma);
    const std::optional<Rule> rule = rule_from_name(one);
    const bool follows_bones = rule && has_skin && traits(*rule).follows == RuleTraits::Follows::bones;
    if (!rule || !(follows_bones || traits(*rule).follows == RuleTraits::Follows::positions))
      throw std::invalid_argument("rules: \"" + std::string(one) + "\" is no rule that follows positions" +
                                  (has_skin ? " or bones" : ""));
    rules.push_back(*rule);
    if (comma == std::string_view::npos) return rules;
    names.remove_prefix(comma + 1);
  }
}

template <class Scalar>
PositionView view_of(const Scalar* positions, std::size_t vertex_count, std::size_t stride_bytes) {
  constexpr std::size_t packed = 3 * sizeof(Scalar);
  if (vertex_count != 0) require_pointer(positions, "positions");
  if (stride_bytes != 0 && stride_bytes < packed)
    throw std::invalid_argument("stride_bytes is " + std::to_string(stride_bytes) + ": a vertex takes " +
                                std::to_string(packed));
  return PositionView::strided(positions, vertex_count, stride_bytes == 0 ? packed : stride_bytes);
}

template <class Scalar>
morula_status update(morula_body* body, const Scalar* positions, std::size_t vertex_count, std::size_t stride_bytes) {
  return guarded([&] {
    require_pointer(body, "body");
    return code_of(body->body.update(view_of(positions, vertex_count, stride_bytes), body->workers));
  });
}

}  // namespace

void morula_body_options_defaults(morula_body_options* options, size_t size) {
  write_defaults(options, size, [](morula_body_options& defaults) {
    defaults.rules = "exact";
    defaults.threads = 1;
  });
}

morula_status morula_body_create(const morula_mesh* mesh, const morula_model* model, const morula_body_options* options,
                                 morula_body** body) {
  return guarded([&] {
    require_pointer(body, "body");
    *body = nullptr;
    require_pointer(mesh, "mesh");
    require_pointer(model, "model");
    const morula_body_options wanted = over_defaults(options, &morula_body_options_defaults);
    require_pointer(wanted.rules, "rules");
    UpdateOptions rules{.rules = rules_from(wanted.rules, wanted.skin != nullptr),
                        .conservative = wanted.conservative != 0};
    if (wanted.skin != nullptr) rules.skin = wanted.skin->skin;
    const auto made = std::make_shared<morula_body>(*mesh, *model, rules, thread_count(wanted.threads));
    made->of_caller = made;
    *body = made.get();
    return MORULA_OK;
  });
}

void morula_body_destroy(morula_body* body) {
  if (body == nullptr) return;
  const std::shared_ptr<morula_body> last = std::move(body->of_caller);
}

morula_status morula_body_update_double(morula_body* body, const double* positions, size_t vertex_count,
                                        size_t stride_bytes) {
  return update(body, positions, vertex_count, stride_bytes);
}
morula_status morula_body_update_float(morula_body* body, const float* positions, size_t vertex_count,
                                       size_t stride_bytes) {
  return update(body, positions, vertex_count, stride_bytes);
}

morula_status morula_body_update_skinned(morula_body* body, const double* transforms, size_t bone_count) {
  return guarded([&] {
    require_pointer(body, "body");
    if (body->transforms.empty()) throw std::invalid_argument("the body has no skin");
    if (bone_count != body->transforms.size()) return code_of(refused(Status::Code::wrong_transform_count, bone_count));
    require_pointer(transforms, "transforms");
    read_transforms(transforms, body->transforms);
    return code_of(body->body.update_skinned(body->transforms, body->workers));
  });
}

morula_status morula_body_set_transform(morula_body* body, const double* rotation, const double* translation) {
  return guarded([&] {
    require_pointer(body, "body");
    require_pointer(rotation, "rotation");
    require_pointer(translation, "translation");
    RigidTransform transform;
    for (std::size_t row = 0; row < 3; ++row)
      transform.rows[row] = {rotation[3 * row], rotation[3 * row + 1], rotation[3 * row + 2]};
    transform.translation = {translation[0], translation[1], translation[2]};
    body->collider.set_transform(transform);
    return MORULA_OK;
  });
}

size_t morula_body_node_count(const morula_body* body) {
  return body == nullptr ? 0 : body->body.spheres().size();
}

morula_status morula_body_spheres(const morula_body* body, morula_sphere* spheres) {
  return guarded([&] {
    require_pointer(body, "body");
    require_pointer(spheres, "spheres");
    for (std::uint32_t node = 0; node < body->body.spheres().size(); ++node) {
      const Sphere sphere = body->body.sphere(node);
      spheres[node] = {sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius};
    }
    return MORULA_OK;
  });
}

morula_status morula_body_certify(const morula_body* body, const double* positions, size_t vertex_count, int* covered) {
  return guarded([&] {
    require_pointer(covered, "covered");
    *covered = 0;
    require_pointer(body, "body");
    *covered = body->body.certify(view_of(positions, vertex_count, 0)).covered ? 1 : 0;
    return MORULA_OK;
  });
}
