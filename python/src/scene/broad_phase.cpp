// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes that move, and which of them are near each other.
#include <limits>
#include <morula/morula.hpp>
#include <morula/scene/broad_phase.hpp>
#include <mutex>
#include <span>
#include <tuple>
#include <vector>

#include "docstrings.hpp"
#include "holders.hpp"
#include "module.hpp"

namespace morula::python {

namespace {

/// For one thread at a time: others wait.
struct HeldBroadPhase {
  BroadPhase boxes;
  mutable std::mutex mutex;
};

IndexPairs own_pairs(std::span<const BoxPair> pairs) {
  auto [values, owner] = kept(std::vector<BoxPair>(pairs.begin(), pairs.end()));
  return IndexPairs(reinterpret_cast<const std::uint32_t*>(values->data()), {values->size(), 2}, owner);
}

}  // namespace

void bind_broad_phase(nb::module_& m) {
  const auto call = [](const HeldBroadPhase& self, const auto& find) {
    return own_indices(without_gil([&] {
      std::vector<std::uint32_t> found;
      const std::scoped_lock lock(self.mutex);
      find(found);
      return found;
    }));
  };
  nb::class_<HeldBroadPhase>(m, "BroadPhase", doc::BroadPhase)
      .def(nb::init<>())
      .def(
          "add",
          [](HeldBroadPhase& self, Vec3 lower, Vec3 upper, bool is_static) {
            return without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return self.boxes.add({lower, upper}, is_static);
            });
          },
          nb::arg("lower"), nb::arg("upper"), nb::arg("is_static") = false, doc::BroadPhase_add)
      .def(
          "remove",
          [](HeldBroadPhase& self, std::uint32_t number) {
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              self.boxes.remove(number);
            });
          },
          nb::arg("number"), doc::BroadPhase_remove)
      .def(
          "move",
          [](HeldBroadPhase& self, std::uint32_t number, Vec3 lower, Vec3 upper) {
            require(without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              return self.boxes.move(number, {lower, upper});
            }));
          },
          nb::arg("number"), nb::arg("lower"), nb::arg("upper"), doc::BroadPhase_move)
      .def(
          "move_all",
          [](HeldBroadPhase& self, ArrayGiven given, ArrayGiven from, ArrayGiven to) {
            const std::vector<std::uint32_t> numbers = indices_of(given.object, "numbers");
            const std::vector<Vec3> lower = points_of(from.object, "lower"), upper = points_of(to.object, "upper");
            require_rows(lower.size(), numbers.size(), "lower", 3, "the numbers");
            require_rows(upper.size(), numbers.size(), "upper", 3, "the numbers");
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              for (std::size_t i = 0; i < numbers.size(); ++i)
                require(self.boxes.move(numbers[i], {lower[i], upper[i]}));
            });
          },
          nb::arg("numbers"), nb::arg("lower"), nb::arg("upper"),
          "move() for many boxes. numbers: (n,); lower, upper: (n, 3). If one is rejected, the boxes ahead of it have "
          "moved.")
      .def(
          "has",
          [](const HeldBroadPhase& self, std::uint32_t number) {
            const std::scoped_lock lock(self.mutex);
            return self.boxes.has(number);
          },
          nb::arg("number"))
      .def(
          "box",
          [](const HeldBroadPhase& self, std::uint32_t number) {
            const std::scoped_lock lock(self.mutex);
            if (!self.boxes.has(number)) throw nb::index_error("number: there is no such box");
            const Box& box = self.boxes.box(number);
            return std::make_tuple(box.lower, box.upper);
          },
          nb::arg("number"), "Lower and upper corner.")
      .def("__len__",
           [](const HeldBroadPhase& self) {
             const std::scoped_lock lock(self.mutex);
             return self.boxes.size();
           })
      .def(
          "update",
          [](HeldBroadPhase& self) {
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              self.boxes.update();
            });
          },
          doc::BroadPhase_update)
      .def(
          "pairs",
          [](const HeldBroadPhase& self) {
            const std::scoped_lock lock(self.mutex);
            return own_pairs(self.boxes.pairs());
          },
          "(n, 2) uint32, ascending; the state of the last update.")
      .def(
          "find",
          [call](const HeldBroadPhase& self, Vec3 lower, Vec3 upper) {
            return call(self, [&](auto& found) { self.boxes.find({lower, upper}, found); });
          },
          nb::arg("lower"), nb::arg("upper"), doc::BroadPhase_find)
      .def(
          "find_behind",
          [call](const HeldBroadPhase& self, Vec3 normal, double offset) {
            return call(self, [&](auto& found) { self.boxes.find_behind(normal, offset, found); });
          },
          nb::arg("normal"), nb::arg("offset"), doc::BroadPhase_find_behind)
      .def(
          "find_along",
          [call](const HeldBroadPhase& self, Vec3 origin, Vec3 direction, double t_end) {
            return call(self, [&](auto& found) { self.boxes.find_along(origin, direction, t_end, found); });
          },
          nb::arg("origin"), nb::arg("direction"), nb::arg("t_end") = std::numeric_limits<double>::infinity(),
          doc::BroadPhase_find_along);
}

}  // namespace morula::python
