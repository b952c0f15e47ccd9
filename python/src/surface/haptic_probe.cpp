// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A haptic probe.
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
struct HeldProbe {
  HapticProbe probe;
  std::mutex mutex;

  explicit HeldProbe(const HapticOptions& options) : probe(options) {}
};

void make_probe(HeldProbe* self, double radius, std::optional<double> skin, double stiffness, bool smooth_normals,
                double friction, std::size_t max_moves) {
  HapticOptions options;
  options.radius = radius, options.skin = skin, options.stiffness = stiffness;
  options.smooth_normals = smooth_normals, options.friction = friction, options.max_moves = max_moves;
  new (self) HeldProbe(options);
}

HapticStep step_of(HeldProbe& self, ColliderGiven given, Vec3 device) {
  const auto side = side_of(given, "body");
  const HapticStep step = without_gil([&] {
    const std::scoped_lock lock(self.mutex);
    const Reading reading({side.get()});
    return self.probe.step(side->current(), device);
  });
  require(step.status);
  return step;
}

}  // namespace

void bind_haptic_probe(nb::module_& m) {
  Record<HapticStep>(m, "HapticStep", doc::HapticStep)
      .field("proxy", &HapticStep::proxy, doc::HapticStep_proxy)
      .field("force", &HapticStep::force, doc::HapticStep_force)
      .field("touches", &HapticStep::touches, doc::HapticStep_touches)
      .field("settled", &HapticStep::settled, doc::HapticStep_settled)
      .field("jammed", &HapticStep::jammed, doc::HapticStep_jammed)
      .field("certified", &HapticStep::certified, doc::HapticStep_certified)
      .field("contact", &HapticStep::contact, doc::HapticStep_contact)
      .field("normal", &HapticStep::normal, doc::HapticStep_normal)
      .field("moves", &HapticStep::moves, doc::HapticStep_moves)
      .field("sphere_tests", &HapticStep::sphere_tests)
      .field("facet_tests", &HapticStep::facet_tests);
  nb::class_<HeldProbe>(m, "HapticProbe", doc::HapticProbe)
      .def("__init__", &make_probe, nb::kw_only(), nb::arg("radius") = 0.0, nb::arg("skin") = nb::none(),
           nb::arg("stiffness") = 1.0, nb::arg("smooth_normals") = false, nb::arg("friction") = 0.0,
           nb::arg("max_moves") = 8,
           with_arguments(doc::HapticProbe_HapticProbe, {{"radius", doc::HapticOptions_radius},
                                                         {"skin", doc::HapticOptions_skin},
                                                         {"stiffness", doc::HapticOptions_stiffness},
                                                         {"smooth_normals", doc::HapticOptions_smooth_normals},
                                                         {"friction", doc::HapticOptions_friction},
                                                         {"max_moves", doc::HapticOptions_max_moves}})
               .c_str())
      .def("step", &step_of, nb::arg("body"), nb::arg("device"), doc::HapticProbe_step)
      .def(
          "reset",
          [](HeldProbe& self) {
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              self.probe.reset();
            });
          },
          doc::HapticProbe_reset)
      .def(
          "path",
          [](HeldProbe& self) {
            std::vector<Vec3> path = without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return std::vector<Vec3>(self.probe.path().begin(), self.probe.path().end());
            });
            return own_points(std::move(path));
          },
          doc::HapticProbe_path);
}

}  // namespace morula::python
