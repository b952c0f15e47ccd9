// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres that the caller moves.
#include <memory>
#include <morula/morula.hpp>
#include <mutex>

#include "holders.hpp"
#include "module.hpp"
#include "posed.hpp"

namespace morula::python {

void bind_posed_spheres(nb::module_& m) {
  nb::class_<PosedRows> posed(m, "PosedSpheres", doc::PosedSpheres);
  bind_pose(posed);
  posed
      .def(
          "__init__",
          [](PosedRows* self, const SphereTree& tree, bool covers) {
            auto owned = std::make_unique<PosedSpheres>(tree, covers);
            new (self) PosedRows();
            self->owned = std::move(owned);
          },
          nb::arg("tree"), nb::arg("covers") = false, doc::PosedSpheres_PosedSpheres)
      .def(
          "set",
          [](PosedRows& self, ArrayGiven given) {
            const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
            require_rows(spheres.size(), self.owned->sphere_state().spheres.size(), "spheres", 4, "the tree's nodes");
            // A thread that reads them may wait for the GIL.
            without_gil([&] {
              const std::unique_lock lock(self.mutex);
              self.owned->set(spheres);
            });
          },
          nb::arg("spheres"), doc::PosedSpheres_set);
}

}  // namespace morula::python
