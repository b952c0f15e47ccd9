// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Haptic probes and tools of the C interface.
#include <limits>

#include "c/handles.hpp"

using namespace morula;
using namespace morula::detail;

namespace {

std::size_t move_count(int moves) {
  if (moves < 1) throw std::invalid_argument("max_moves is " + std::to_string(moves) + ": 1 or more are possible");
  return static_cast<std::size_t>(moves);
}

std::optional<double> skin_of(double skin) {
  return skin <= 0 ? std::nullopt : std::optional(skin);
}

}  // namespace

void morula_haptic_options_defaults(morula_haptic_options* options, size_t size) {
  write_defaults(options, size, [](morula_haptic_options& defaults) {
    const HapticOptions values;
    defaults.radius = values.radius;
    defaults.stiffness = values.stiffness;
    defaults.friction = values.friction;
    defaults.smooth_normals = values.smooth_normals ? 1 : 0;
    defaults.max_moves = static_cast<int>(values.max_moves);
  });
}

morula_status morula_haptic_probe_create(const morula_haptic_options* options, morula_haptic_probe** probe) {
  return guarded([&] {
    require_pointer(probe, "probe");
    *probe = nullptr;
    const morula_haptic_options wanted = over_defaults(options, &morula_haptic_options_defaults);
    *probe = new morula_haptic_probe{HapticProbe({.radius = wanted.radius,
                                                  .skin = skin_of(wanted.skin),
                                                  .stiffness = wanted.stiffness,
                                                  .smooth_normals = wanted.smooth_normals != 0,
                                                  .friction = wanted.friction,
                                                  .max_moves = move_count(wanted.max_moves)})};
    return MORULA_OK;
  });
}

void morula_haptic_probe_destroy(morula_haptic_probe* probe) {
  delete probe;
}

morula_status morula_haptic_probe_step(morula_haptic_probe* probe, const morula_body* body, const double* device,
                                       morula_haptic_step* step) {
  return guarded([&] {
    require_pointer(step, "step");
    *step = {};
    step->facet = std::numeric_limits<std::uint32_t>::max();
    require_pointer(probe, "probe");
    require_pointer(body, "body");
    require_pointer(device, "device");
    const HapticStep found = probe->probe.step(body->collider, {device[0], device[1], device[2]});
    if (!found.status) return code_of(found.status);
    copy(found.proxy, step->proxy);
    copy(found.force, step->force);
    copy(found.normal, step->normal);
    if (found.contact) {
      copy(found.contact->point, step->point);
      std::copy(found.contact->barycentric.begin(), found.contact->barycentric.end(), step->barycentric);
      step->facet = found.contact->facet;
    }
    step->touches = found.touches, step->settled = found.settled;
    step->jammed = found.jammed, step->certified = found.certified;
    step->moves = static_cast<std::uint32_t>(found.moves);
    return MORULA_OK;
  });
}

void morula_haptic_probe_reset(morula_haptic_probe* probe) {
  if (probe != nullptr) probe->probe.reset();
}

void morula_haptic_tool_options_defaults(morula_haptic_tool_options* options, size_t size) {
  write_defaults(options, size, [](morula_haptic_tool_options& defaults) {
    const HapticToolOptions values;
    defaults.stiffness = values.stiffness;
    defaults.rotation_stiffness = -1;
    defaults.max_moves = static_cast<int>(values.max_moves);
  });
}

morula_status morula_haptic_tool_create(const morula_sphere* balls, size_t ball_count,
                                        const morula_haptic_tool_options* options, morula_haptic_tool** tool) {
  return guarded([&] {
    require_pointer(tool, "tool");
    *tool = nullptr;
    require_pointer(balls, "balls");
    const morula_haptic_tool_options wanted = over_defaults(options, &morula_haptic_tool_options_defaults);
    std::vector<Sphere> own;
    for (std::size_t k = 0; k < ball_count; ++k) own.push_back({{balls[k].x, balls[k].y, balls[k].z}, balls[k].radius});
    HapticToolOptions given{.skin = skin_of(wanted.skin), .stiffness = wanted.stiffness};
    if (!(wanted.rotation_stiffness < 0)) given.rotation_stiffness = wanted.rotation_stiffness;
    given.max_moves = move_count(wanted.max_moves);
    *tool = new morula_haptic_tool{HapticTool(own, given), {}};
    return MORULA_OK;
  });
}

void morula_haptic_tool_destroy(morula_haptic_tool* tool) {
  delete tool;
}

morula_status morula_haptic_tool_step(morula_haptic_tool* tool, const morula_body* body, const double* rotation,
                                      const double* translation, morula_haptic_tool_result* step) {
  return guarded([&] {
    require_pointer(step, "step");
    *step = {};
    require_pointer(tool, "tool");
    require_pointer(body, "body");
    require_pointer(rotation, "rotation");
    require_pointer(translation, "translation");
    RigidTransform device;
    for (std::size_t row = 0; row < 3; ++row)
      device.rows[row] = {rotation[3 * row], rotation[3 * row + 1], rotation[3 * row + 2]};
    device.translation = {translation[0], translation[1], translation[2]};
    tool->contacts.clear();
    const HapticToolStep found = tool->tool.step(body->collider, device);
    if (!found.status) return code_of(found.status);
    for (std::size_t row = 0; row < 3; ++row) copy(found.proxy.rows[row], step->rotation + 3 * row);
    copy(found.proxy.translation, step->translation);
    copy(found.force, step->force);
    copy(found.torque, step->torque);
    for (const ToolContact& contact : found.contacts) {
      morula_tool_contact made{};
      copy(contact.point.point, made.point);
      std::copy(contact.point.barycentric.begin(), contact.point.barycentric.end(), made.barycentric);
      copy(contact.normal, made.normal);
      made.distance = contact.distance, made.ball = contact.ball, made.facet = contact.point.facet;
      tool->contacts.push_back(made);
    }
    step->touches = found.touches, step->settled = found.settled;
    step->jammed = found.jammed, step->certified = found.certified;
    step->moves = static_cast<std::uint32_t>(found.moves);
    step->contact_count = static_cast<std::uint32_t>(tool->contacts.size());
    return MORULA_OK;
  });
}

const morula_tool_contact* morula_haptic_tool_contacts(const morula_haptic_tool* tool) {
  return tool == nullptr ? nullptr : tool->contacts.data();
}

void morula_haptic_tool_reset(morula_haptic_tool* tool) {
  if (tool != nullptr) tool->tool.reset();
}
