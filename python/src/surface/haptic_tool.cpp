// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A haptic tool.
#include <morula/morula.hpp>
#include <mutex>
#include <optional>

#include "arrays.hpp"
#include "docstrings.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// One call at a time; others wait without the GIL.
struct HeldTool {
  HapticTool tool;
  std::mutex mutex;

  HeldTool(std::span<const Sphere> balls, const HapticToolOptions& options) : tool(balls, options) {}
};

/// A step with contacts of its own.
struct OwnStep : HapticToolStep {
  explicit OwnStep(const HapticToolStep& step)
      : HapticToolStep(step), own(step.contacts.begin(), step.contacts.end()) {}
  std::vector<ToolContact> own;
};

void make_tool(HeldTool* self, ArrayGiven balls, std::optional<double> skin, double stiffness,
               std::optional<double> rotation_stiffness, std::size_t max_moves) {
  HapticToolOptions options;
  options.skin = skin, options.stiffness = stiffness;
  options.rotation_stiffness = rotation_stiffness, options.max_moves = max_moves;
  new (self) HeldTool(spheres_of(balls.object, "balls"), options);
}

OwnStep tool_step_of(HeldTool& self, ColliderGiven given, TransformGiven pose) {
  const auto side = side_of(given, "body");
  const RigidTransform device = transform_of(pose, "device");
  const OwnStep step = without_gil([&] {
    const std::scoped_lock lock(self.mutex);
    const Reading reading({side.get()});
    return OwnStep(self.tool.step(side->current(), device));
  });
  require(step.status);
  return step;
}

}  // namespace

void bind_haptic_tool(nb::module_& m) {
  m.def(
      "leaf_spheres",
      [](ColliderGiven given) {
        const auto side = side_of(given, "body");
        const Reading reading({side.get()});
        return own_spheres(leaf_spheres(side->current().sphere_state()));
      },
      nb::arg("body"), doc::leaf_spheres);
  Record<ToolContact>(m, "ToolContact", doc::ToolContact)
      .field("ball", &ToolContact::ball, doc::ToolContact_ball)
      .field("point", &ToolContact::point, doc::ToolContact_point)
      .field("normal", &ToolContact::normal, doc::ToolContact_normal)
      .field("distance", &ToolContact::distance, doc::ToolContact_distance);
  Record<OwnStep>(m, "HapticToolStep", doc::HapticToolStep)
      .field("proxy", &OwnStep::proxy, doc::HapticToolStep_proxy)
      .field("force", &OwnStep::force, doc::HapticToolStep_force)
      .field("torque", &OwnStep::torque, doc::HapticToolStep_torque)
      .field("touches", &OwnStep::touches, doc::HapticToolStep_touches)
      .field("settled", &OwnStep::settled, doc::HapticToolStep_settled)
      .field("jammed", &OwnStep::jammed, doc::HapticToolStep_jammed)
      .field("certified", &OwnStep::certified, doc::HapticToolStep_certified)
      .field("contacts", &OwnStep::own, "Contacts of balls with the surface.")
      .field("moves", &OwnStep::moves, doc::HapticToolStep_moves)
      .field("sphere_tests", &OwnStep::sphere_tests)
      .field("facet_tests", &OwnStep::facet_tests);
  nb::class_<HeldTool>(m, "HapticTool", doc::HapticTool)
      .def(
          "__init__", &make_tool, nb::arg("balls"), nb::kw_only(), nb::arg("skin") = nb::none(),
          nb::arg("stiffness") = 1.0, nb::arg("rotation_stiffness") = nb::none(), nb::arg("max_moves") = 16,
          with_arguments(doc::HapticTool_HapticTool, {{"skin", doc::HapticToolOptions_skin},
                                                      {"stiffness", doc::HapticToolOptions_stiffness},
                                                      {"rotation_stiffness", doc::HapticToolOptions_rotation_stiffness},
                                                      {"max_moves", doc::HapticToolOptions_max_moves}})
              .c_str())
      .def("step", &tool_step_of, nb::arg("body"), nb::arg("device"), doc::HapticTool_step)
      .def(
          "reset",
          [](HeldTool& self) {
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              self.tool.reset();
            });
          },
          doc::HapticTool_reset)
      .def_prop_ro(
          "center", [](HeldTool& self) { return self.tool.center(); }, doc::HapticTool_center)
      .def(
          "path",
          [](HeldTool& self) {
            return without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return std::vector<RigidTransform>(self.tool.path().begin(), self.tool.path().end());
            });
          },
          doc::HapticTool_path);
}

}  // namespace morula::python
