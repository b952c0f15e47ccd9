// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Mass and inertia of a union of spheres.
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_mass(nb::module_& m) {
  Record<UnionMass>(m, "UnionMass", doc::UnionMass)
      .field("volume", &UnionMass::volume, "Mesh units cubed.")
      .field("center", &UnionMass::center)
      .field("inertia", &UnionMass::inertia, doc::UnionMass_inertia);
  Record<ConvergedMass>(m, "ConvergedMass", "A mass, with its uncertainty.")
      .field("solid", &ConvergedMass::solid)
      .field("change", &ConvergedMass::change, doc::ConvergedMass_change);
  m.def(
      "union_mass",
      [](ArrayGiven given, int resolution) {
        const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
        return without_gil([&] { return union_mass(spheres, resolution); });
      },
      nb::arg("spheres"), nb::arg("resolution") = 160, doc::union_mass);
  m.def(
      "converged_union_mass",
      [](ArrayGiven given, double tolerance) {
        const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
        return without_gil([&] { return converged_union_mass(spheres, tolerance); });
      },
      nb::arg("spheres"), nb::arg("tolerance") = 1e-4, doc::converged_union_mass);
}

}  // namespace morula::python
