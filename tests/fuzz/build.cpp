// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees of small meshes of any kind, with every method and option: refused in words, or a tree that passes its own
// validation, is finite and covers.
#include <algorithm>
#include <cmath>
#include <morula/generators/build.hpp>
#include <stdexcept>

#include "fuzz.hpp"
#include "small_bodies.hpp"

namespace morula::fuzz {
namespace {

template <class Items>
auto one_of(Bytes& in, const Items& items) {
  return items[in.below(items.size())];
}

BuildOptions options_of(Bytes& in) {
  BuildOptions options;
  options.method = one_of(in, all_methods());
  options.branching = static_cast<int>(2 + in.below(9));
  options.depth = static_cast<int>(in.below(4));
  const std::size_t kind = in.below(8);
  if (kind == 1) options.spheres = 1 + in.below(40);
  if (kind == 2) {
    options.max_protrusion = static_cast<double>(1 + in.byte()) / 16;
    options.spheres = 300;  // a sheet of a few facets may need tens of thousands, and minutes under sanitizers
  }
  options.quality = one_of(in, std::array{Quality::draft, Quality::draft, Quality::fast, Quality::standard});
  options.optimizer = one_of(in, all_optimizers());
  options.seed = in.byte();
  if (options.method == Method::medial && in.flag())
    options.reducers = {one_of(in, std::array{Reduction::merge, Reduction::burst, Reduction::expand})};
  if (options.method == Method::combined)
    options.reducers = {one_of(in, all_reductions()), one_of(in, all_reductions())};
  return options;
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace morula;
  using namespace morula::fuzz;
  Bytes in(data, size);
  const BuildOptions options = options_of(in);
  const Mesh mesh = mesh_of(in);
  if (is_extreme(mesh.positions)) return 0;
  CoveredTree model;
  try {
    model = build(mesh, options);
  } catch (const std::invalid_argument&) {
    return 0;
  }
  for (const Sphere& s : model.tree.spheres)
    require(is_finite(s.center) && std::isfinite(s.radius) && s.radius >= 0, "a sphere is not finite");
  if (const auto faults = validate(mesh, model); !faults.empty()) found("not valid: " + faults.front());
  require(certify(model.cover, mesh.positions, model.tree.spheres).covered, "the tree does not cover");
  require_cover(mesh, mesh.positions, model.tree, model.tree.spheres);
  return 0;
}
