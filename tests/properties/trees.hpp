// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees by every generator, small, and rules for them.
#pragma once

#include <memory>
#include <morula/generators/build.hpp>
#include <morula/update/rules.hpp>
#include <optional>
#include <string>
#include <vector>

#include "record.hpp"
#include "shapes.hpp"

namespace morula::properties {

/// A mesh with its tree.
struct Specimen {
  std::string name;  ///< mesh and tree, in words
  Mesh mesh;
  std::shared_ptr<const CoveredTree> model;
};

/// Cases in a row share one tree by a generator that takes its time, and have another of their own, by the octree or
/// from spheres strewn about: so a hundred thousand cases take minutes, and a few thousand of their trees are costly.
class Specimens {
 public:
  static constexpr std::uint64_t cases_per_tree = 25;

  /// For a case of a seed: its block's, or one of its own. Each new tree is held against validate() and the judge.
  /// Throws what the library throws.
  Specimen choose(std::uint64_t seed, std::uint64_t number, std::size_t most_facets, Dice& dice, Record& record);

 private:
  std::uint64_t seed_ = 0, block_ = 0;
  Specimen shared_;  // of that block; none yet without a tree
};

/// Builds a tree of a small body far from the origin, and judges it. The largest coordinate is from 2^-99 to 2^99.9,
/// and up to 2^54 times the body's size, where rounding leaves nothing of the body. method: nothing for any.
void far_tree(std::optional<Method> method, Dice& dice, Record& record);

/// Rules of which at least some level covers; the last ones need no modes.
UpdateOptions random_rules(Dice& dice);
std::string name(const UpdateOptions& options);

/// Per node: does the documentation promise that its sphere contains what it owns?
std::vector<std::uint8_t> promised(const SphereTree& tree, const UpdateOptions& options);

/// Written as a file, read again, compared; nothing where the library is built without files.
void round_trip(const Mesh& mesh, const CoveredTree& model, Record& record);

}  // namespace morula::properties
