// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Whether two links of a robot ever meet: a search for a configuration in which they do, and a proof that there is
// none.
#pragma once

#include <morula/parallel/threads.hpp>
#include <optional>

#include "fit/pair_chain.hpp"
#include "fit/sphere_group.hpp"

namespace morula::robot {

/// Two links with spheres, and the joints between them.
struct LinkPair {
  const PairChain& chain;
  const JointRanges& ranges;
  const SphereGroup &a, &b;
};

enum class Verdict {
  meet,       ///< in a configuration that was found
  apart,      ///< in every configuration: proven
  undecided,  ///< within the given work
};

/// Proves that the spheres of two links are apart in every configuration within the ranges, or finds one in which they
/// meet. boxes: the most boxes of configurations that are examined. Undecided also when stopped.
///
/// Why it is a proof. Take a box of configurations, joint j within ±h_j of its value at the center of the box, and cut
/// the chain at some place into the joints of b's side and those of a's. In the axes of that place, a sphere of a can
/// be where the joints of a's side take it. Move them one after the other, that nearest to a first: a ball that
/// contains all places of the sphere, of center c and radius r, becomes under a turn by up to h about an axis at
/// distance R from c a ball whose center runs along an arc of radius R and half angle h. The arc lies in the ball about
/// the middle of its chord of radius R sin h where h ≤ π/2, and about its own center of radius R in any case, so its
/// places lie in the ball that is larger by r. Under a slide by up to h the ball grows by h. So one ball per sphere
/// contains all of its places over the whole box; the same holds for b. Balls that are apart prove that the spheres
/// are, in all of the box. A node of a SphereGroup is a ball that contains its spheres, and moves with them: it may
/// stand for all of them. A box without proof is halved along the coordinate that makes balls grow most.
///
/// Rounding. A pose is a product of at most a few hundred rigid transforms, each rounded by less than 2^-50 of the sum
/// of all lengths in it, and a turn of up to far_turn radians is off by less than 2^-43: balls have to be apart by
/// 2^-33 of this sum (`reach_of` and the extents of both links) on top.
Verdict prove_apart(const LinkPair& pair, std::size_t boxes, const StopToken& stop);

/// Goes downhill from random configurations to one in which the spheres of two links meet: true if it finds one.
bool descend_to_contact(const LinkPair& pair, std::uint64_t seed, const StopToken& stop);

}  // namespace morula::robot
