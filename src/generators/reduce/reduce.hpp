// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Reducers: they propose a few spheres for a node's samples. All proposals are processed alike: the region is divided
// by power, parts that stick out go to other spheres, and each sphere is fitted again to its own part.
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

/// A reducer's input: one node.
struct ReducerInput {
  std::span<const Vec3> samples;  ///< points of the region: corners of its patches and points spread by area
  std::span<const Vec3> normals;  ///< unit outward normal of the facet of each sample; zero on facets without area
  Sphere sphere;                  ///< sphere of the node
  std::size_t branching;          ///< most spheres of a proposal
  std::uint64_t seed;
  const ObjectShape& shape;
};
/// At most `branching` spheres that together contain the samples, or nearly.
struct Proposal {
  std::string_view reducer;  ///< name of its reducer; the report counts the winners
  std::vector<Sphere> spheres;
  bool fill_places = true;  ///< false: there are fewer spheres on purpose, and free places stay free
};
/// The proposal that is best after fitting is used.
using Proposals = std::vector<Proposal>;
using Reducer = std::function<Proposals(const ReducerInput&)>;

/// How thoroughly proposals are fitted.
struct ReduceSettings {
  NodeFit::Settings fit;
  std::array<int, 3> changes;  ///< changes that are tried on the settled balls, by level of the children: 1, 2, deeper
  int move_every;              ///< every move_every-th change moves a ball elsewhere
  bool all_on_root = false;    ///< every proposal is settled on the root, not just the best
  std::array<float, 2> balance{0, 0};  ///< weights on levels 1 and 2, if there is a demand
};
/// Makes a divider of a reducer. Proposals are compared by their outside volume after a sweep; the best is settled and
/// made exact. input: borrowed.
Divider divide_by(const FitInput& input, const BuildRun& run, Reducer reducer, const ReduceSettings& settings,
                  Demand demand = {});

}  // namespace morula::detail
