// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Reducers: they propose a few spheres for a node's samples. What happens to a proposal is the same for all of them:
// the region is divided by power, pieces that stick out are handed over, and each sphere is fitted again to what it
// owns.
#pragma once

#include <array>
#include <morula/query/signed_distance.hpp>
#include <string_view>

#include "generators/divide/node_fit.hpp"
#include "generators/driver/top_down.hpp"

namespace morula::detail {

/// Points that steer a search; cover never depends on them.
struct RegionSamples {
  std::vector<Vec3> points, normals;
};
/// Corners of the region's patches, thinned, and points spread over it by area. orientation: −1 for a mesh inside out.
RegionSamples region_samples(const MeshView& mesh, const Region& region, double orientation, std::uint64_t seed);

/// What a reducer sees of a node.
struct ReducerInput {
  std::span<const Vec3> samples;  ///< points of the region: corners of its patches and points spread by area
  std::span<const Vec3> normals;  ///< unit outward normal of the facet of each sample; zero on facets without area
  Sphere sphere;                  ///< the node's
  std::size_t branching;          ///< most spheres wanted
  std::uint64_t seed;
  const ObjectShape& shape;
};
/// At most `branching` spheres that together contain the samples, or nearly.
struct Proposal {
  std::string_view reducer;  ///< whose it is; the report counts the winners
  std::vector<Sphere> spheres;
  bool fill_places = true;  ///< false: fewer spheres on purpose, so free places stay free
};
/// The best after fitting is taken.
using Proposals = std::vector<Proposal>;
using Reducer = std::function<Proposals(const ReducerInput&)>;

/// How thoroughly proposals are fitted.
struct ReduceSettings {
  NodeFit::Settings fit;
  std::array<int, 3> changes;          ///< tried on what is settled, by level of the children: 1, 2, deeper
  int move_every;                      ///< one of so many changes moves a ball elsewhere
  bool all_on_root = false;            ///< whether every proposal is settled there, not just the best
  std::array<float, 2> balance{0, 0};  ///< on levels 1 and 2, when there is a demand
};
/// The divider made of a reducer: proposals are judged by the empty space they take in after a
/// sweep; the best is settled and made exact. input: borrowed.
Divider divide_by(const FitInput& input, const BuildRun& run, Reducer reducer, const ReduceSettings& settings,
                  Demand demand = {});

}  // namespace morula::detail
