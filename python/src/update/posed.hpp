// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Members that all objects with current spheres share.
#pragma once

#include <cstdint>
#include <morula/morula.hpp>
#include <mutex>
#include <shared_mutex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "docstrings.hpp"
#include "holders.hpp"

namespace morula::python {

/// The spheres of one frame of a body, for as long as that frame lasts.
struct SpheresView {
  nb::object owner;
  const Posed* posed;
  std::uint64_t frame;

  bool is_current() const { return posed->frame() == frame; }
  void visit(References& references) const { references(owner); }
  const SphereState& sphere_state() const {
    if (!is_current()) {
      throw std::runtime_error(
          "spheres of an older frame: the body has been updated since; take body.spheres again, or "
          "keep a copy (body.copy_spheres())");
    }
    return posed->sphere_state();
  }
};

/// Throws ValueError with the words of a status that is not ok.
inline void require(const RebuildStatus& status) {
  require(status.update);
}

/// Updates a body, by update(body, workers), and keeps what it borrows. Throws ValueError for rejected arguments.
template <class Holder, class Update>
auto updated(Holder& self, std::vector<Positions>&& borrowed, Threads* workers, const Update& update) {
  const auto status = without_gil([&] {
    CallWorkers call(workers);
    const std::unique_lock lock(self.mutex);
    const auto done = update(*self.owned, static_cast<Workers&>(call));
    // A rejected update changes nothing: the positions of the previous frame are still borrowed.
    if (done) std::swap(self.last, borrowed);
    return done;
  });
  require(status);
  return status;
}

/// The same members of everything that has spheres of the moment.
template <class Holder>
void bind_pose(nb::class_<Holder>& type) {
  type.def_prop_ro(
          "spheres",
          [](nb::handle self) {
            const Holder& holder = nb::cast<const Holder&>(self);
            return SpheresView{nb::borrow(self), &holder, holder.frame()};
          },
          "The current spheres about the origin, (nodes, 4) float32; reading them after the next update is an error.")
      .def_prop_ro(
          "origin", [](const Holder& self) { return self.sphere_state().origin; }, doc::SphereState_origin)
      .def_prop_ro(
          "frame", [](const Holder& self) { return self.frame(); }, doc::Body_frame)
      .def_prop_ro(
          "is_current", [](const Holder& self) { return self.sphere_state().current; }, doc::Body_is_current)
      .def_prop_ro(
          "covers", [](const Holder& self) { return self.sphere_state().covers; }, doc::SphereState_covers)
      .def_prop_ro(
          "nested", [](const Holder& self) { return self.sphere_state().nested; }, doc::SphereState_nested)
      .def(
          "copy_spheres",
          [](const Holder& self) {
            return own_spheres(without_gil([&] {
              const std::shared_lock lock(self.mutex);
              const SphereState& pose = self.sphere_state();
              std::vector<Sphere> spheres(pose.spheres.size());
              for (std::uint32_t node = 0; node < spheres.size(); ++node) spheres[node] = pose.sphere(node);
              return spheres;
            }));
          },
          "The current spheres in mesh coordinates, (nodes, 4) float64: a copy.")
      .def(
          "sphere",
          [](const Holder& self, std::uint32_t node) {
            if (node >= self.sphere_state().spheres.size()) throw nb::index_error("node");
            return self.sphere_state().sphere(node);
          },
          nb::arg("node"), doc::SphereState_sphere)
      .def_prop_ro(
          "tree", [](const Holder& self) { return *self.sphere_state().tree; }, "The tree at rest: a copy.")
      .def("__len__", [](const Holder& self) { return self.sphere_state().spheres.size(); });
}

}  // namespace morula::python
