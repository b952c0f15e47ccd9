// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters.
#include <morula/morula.hpp>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "docstrings.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "motion.hpp"

namespace morula::python {

namespace {

struct HeldSkinBounds {
  SkinBounds bounds;
  std::mutex mutex;

  explicit HeldSkinBounds(SkinBounds&& made) : bounds(std::move(made)) {}
};

// (characters, bones, 3, 4), or (bones, 3, 4) for one.
std::vector<AffineTransform> transforms_of_characters(nb::handle given) {
  nb::object rows = nb::borrow(given);
  const nb::object array = nb::module_::import_("numpy").attr("asarray")(given);
  if (nb::cast<int>(array.attr("ndim")) == 4) {
    const auto rows_of_matrix = nb::cast<std::int64_t>(array.attr("shape")[nb::int_(2)]);
    const auto columns = nb::cast<std::int64_t>(array.attr("shape")[nb::int_(3)]);
    const auto count = nb::cast<std::int64_t>(array.attr("shape")[nb::int_(0)]) *
                       nb::cast<std::int64_t>(array.attr("shape")[nb::int_(1)]);
    rows = array.attr("reshape")(count, rows_of_matrix, columns);
  }
  return transforms_of(rows, "transforms");
}

template <std::size_t words, class Row>
View<std::uint32_t, -1, words> words_of(const std::vector<Row>& rows, nb::handle owner) {
  static_assert(sizeof(Row) == 4 * words);
  return View<std::uint32_t, -1, words>(reinterpret_cast<const std::uint32_t*>(rows.data()), {rows.size(), words},
                                        owner);
}

// (characters, targets), or (targets,) for one; empty: none given.
std::vector<double> morphs_of_characters(const std::optional<ArrayGiven>& given, std::size_t characters,
                                         std::size_t targets) {
  if (!given) return {};
  const nb::object array = nb::module_::import_("numpy").attr("asarray")(given->object);
  std::vector<std::size_t> shape;
  std::vector<double> morphs = nb::cast<int>(array.attr("ndim")) == 2 ? numbers_of(array, "morphs", {-1, -1}, shape)
                                                                      : numbers_of(array, "morphs", {-1}, shape);
  if (shape.back() != targets || morphs.size() != characters * targets)
    throw std::invalid_argument("morphs: there are " + std::to_string(morphs.size()) + ", not " +
                                std::to_string(targets) + " for each of " + std::to_string(characters) + " characters");
  return morphs;
}

nb::tuple bounds_of(HeldSkinBounds& self, ArrayGiven given, std::optional<ArrayGiven> targets, Threads* workers) {
  const std::vector<AffineTransform> transforms = transforms_of_characters(given.object);
  const std::size_t bones = self.bounds.bone_count(), clusters = self.bounds.cluster_count();
  if (transforms.size() % bones != 0)
    throw std::invalid_argument("transforms: there are " + std::to_string(transforms.size()) +
                                ", not a multiple of the " + std::to_string(bones) + " bones");
  const std::size_t characters = transforms.size() / bones;
  const std::vector<double> morphs = morphs_of_characters(targets, characters, self.bounds.target_count());
  std::vector<Spheref> spheres(characters * clusters), whole_spheres(characters);
  std::vector<Boxf> boxes(characters * clusters), whole_boxes(characters);
  require(without_gil([&] {
    CallWorkers call(workers);
    const std::lock_guard lock(self.mutex);
    return self.bounds.bounds(transforms, morphs, {spheres, boxes, whole_spheres, whole_boxes}, call);
  }));
  auto [s, of_s] = kept(std::move(spheres));
  auto [b, of_b] = kept(std::move(boxes));
  auto [ws, of_ws] = kept(std::move(whole_spheres));
  auto [wb, of_wb] = kept(std::move(whole_boxes));
  const auto floats = [](auto* values) { return reinterpret_cast<float*>(values->data()); };
  return nb::make_tuple(Copy<float, -1, -1, 4>(floats(s), {characters, clusters, 4}, of_s),
                        Copy<float, -1, -1, 2, 3>(floats(b), {characters, clusters, 2, 3}, of_b),
                        Copy<float, -1, 4>(floats(ws), {characters, 4}, of_ws),
                        Copy<float, -1, 2, 3>(floats(wb), {characters, 2, 3}, of_wb));
}

}  // namespace

void bind_skin_bounds(nb::module_& m) {
  nb::class_<HeldSkinBounds>(m, "SkinBounds", doc::SkinBounds)
      .def(
          "__init__",
          [](HeldSkinBounds* self, MeshGiven given, ArrayGiven skin, ArrayGiven cluster_of_facet,
             std::optional<ArrayGiven> modes, Threads* workers) {
            const auto mesh = mesh_of(given);
            const Skin weights = skin_of(skin.object, "skin");
            const std::vector<std::uint32_t> clusters = indices_of(cluster_of_facet.object, "cluster_of_facet");
            const Modes targets = modes ? modes_of(modes->object, "modes") : Modes{};
            new (self) HeldSkinBounds(without_gil([&] {
              CallWorkers call(workers);
              return SkinBounds(*mesh, weights, targets, clusters, call);
            }));
          },
          nb::arg("mesh"), nb::arg("skin"), nb::arg("cluster_of_facet"), nb::arg("modes") = nb::none(),
          nb::arg("workers") = nb::none(),
          (std::string(doc::SkinBounds_SkinBounds) + "\n\nmodes: morph targets, Modes or (targets, vertices, 3). " +
           doc::SkinBounds_SkinBounds_2)
              .c_str())
      .def_prop_ro(
          "cluster_count", [](const HeldSkinBounds& self) { return self.bounds.cluster_count(); },
          "Number of clusters.")
      .def_prop_ro(
          "bone_count", [](const HeldSkinBounds& self) { return self.bounds.bone_count(); }, "Number of bones.")
      .def_prop_ro(
          "target_count", [](const HeldSkinBounds& self) { return self.bounds.target_count(); },
          "Number of morph targets.")
      .def_prop_ro(
          "reach", [](const HeldSkinBounds& self) { return self.bounds.data().reach; }, doc::SkinBoundsData_reach)
      .def_prop_ro(
          "largest_size", [](const HeldSkinBounds& self) { return self.bounds.data().largest_size; },
          doc::SkinBoundsData_largest_size)
      .def_prop_ro(
          "clusters",
          [](nb::handle self) { return words_of<12>(nb::cast<HeldSkinBounds&>(self).bounds.data().clusters, self); },
          "(clusters, 12) uint32, read-only, no copy: the words of SkinBoundsCluster, for a buffer of a shader. All "
          "but the last "
          "two are floats: center, radius, half_extent, overhang, growth, rounding, first_row, row_count.")
      .def_prop_ro(
          "rows", [](nb::handle self) { return words_of<8>(nb::cast<HeldSkinBounds&>(self).bounds.data().rows, self); },
          "(rows, 8) uint32, read-only, no copy: the words of SkinBoundsRow. All but the first are floats: bone, "
          "weight, "
          "weight_stray, moment_stray, center, radius.")
      .def_prop_ro(
          "target_begin",
          [](nb::handle self) {
            return own_indices(std::vector<std::uint32_t>(nb::cast<HeldSkinBounds&>(self).bounds.data().target_begin));
          },
          doc::SkinBoundsData_target_begin)
      .def_prop_ro(
          "targets",
          [](nb::handle self) { return words_of<8>(nb::cast<HeldSkinBounds&>(self).bounds.data().targets, self); },
          "(rows, 8) uint32, read-only, no copy: the words of SkinBoundsTarget. All but the last are floats: shift, "
          "radius, half_extent, target.")
      .def(
          "bounds", bounds_of, nb::arg("transforms"), nb::arg("morphs") = nb::none(), nb::arg("workers") = nb::none(),
          nb::sig("def bounds(self, transforms: numpy.typing.ArrayLike, morphs: numpy.typing.ArrayLike | None = None, "
                  "workers: Workers | None = None) -> "
                  "tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32], "
                  "numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.float32]]"),
          "Computes covering bounds in mesh coordinates, rounded outward.\n\n"
          "transforms: relative to rest, (characters, bones, 3, 4), or (bones, 3, 4) for one character; matrices that "
          "act on columns.\n"
          "morphs: numbers of the morph targets, (characters, targets), or (targets,) for one character; None: all 0.\n"
          "Returns spheres (characters, clusters, 4), boxes (characters, clusters, 2, 3) as lower and upper corners, "
          "and the sphere (characters, 4) and box (characters, 2, 3) of each whole character, all float32. A cluster "
          "without facets gets zeros. Raises ValueError for transforms or morphs that are not finite or "
          "larger than largest_size allows.");
  m.def(
      "clusters_of_runs",
      [](ArrayGiven begin) { return own_indices(clusters_of_runs(indices_of(begin.object, "begin"))); },
      nb::arg("begin"), doc::clusters_of_runs);
}

}  // namespace morula::python
