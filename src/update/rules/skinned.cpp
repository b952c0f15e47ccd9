// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Bounds of a node's corners from the transforms alone. With the names of skin_blend.hpp, r the main bone of the node
// and D_b = T_b - T_r, a corner is at
//   p = T_r c + A_r y + sum_{b != r} w_b D_b c + D_b m_b          (D_b m_b: by the linear part alone)
// because its weights add up to 1 and its moments to y. With the fits w_b = W_b + g_b . y + e_b and
// m_b = M_b + s_b y + f_b this is p = C + F y + sum e_b D_b c + D_b f_b, where
//   C = T_r c + sum W_b D_b c + D_b M_b,   F = A_r + sum (D_b c) g_b^T + s_b D_b.
// So |p - C| <= |F| |y| + strays, with strays = sum |e_b| |D_b c| + |D_b| |f_b|. Weights and moments vary smoothly over
// a patch, so F follows most of their spread, and the strays are of second order in the size of the node. [jones2017]
// has the center alone; its sphere may leave corners outside. Cheaper bounds of strays serve as well: |D_b| is at most
// the root of the sum of the squares of its entries, and with E_b >= |e_b|, by the inequality of Cauchy and Schwarz,
//   sum E_b |D_b c| <= sqrt(sum E_b) sqrt(sum E_b |D_b c|^2).
//
// At joints that bend far these spheres grow. If one of a group has grown by more than `loose`, two more are tried
// for all of the group:
//   shape  y = y_0 + L u with |u| <= 1, hence |p - (C + F y_0)| <= |F L| + strays; a patch is flat, and F may stretch
//          only across it
//   hull   with q_b = m_b / w_b, p - T_r c is a convex combination of the points D_b (c + q_b) + A_r q_b, which are
//          T_b (c + q_b) - T_r c, so it lies in any ball around the moved balls of the bones [kavan2005]. It needs
//          weights of at least 0.
// The smallest is taken. The first has the tree's center at rest, where spheres stick out of the body the least.
//
// Nodes with one main bone, and nearly the same others, are bounded in groups, one in each lane (skin_groups.cpp). A
// bone that moves only some of them has factors and strays of 0 in the others and adds exactly 0; its ball there has
// the radius -infinity and reaches nowhere. Lanes share only the choice above, which is made once for the group:
// no bit depends on the width of registers.
//
// Rounding, all in double, e = 2^-53. X bounds |coordinates| at rest, S those of displacements (T_b - 1) x, L the sum
// of |weights| of a vertex, Q the sum of the factors of a node (factor_sum), n the number of summands. Lengths:
//   the caller's own sum rest + sum w_b (T_b - 1) rest                  1.8 (n + 8) e L (X + S)
//   C: D_b c to 20 e S; factors and their sum                           1.8 (n + 40) e Q (X + S)
//   entries of F, times |y| <= 3.5 X                                    6.1 (n + 16) e (1 + Q) (X + S)
//   hull: q_b below 3.5 X, so D_b (c + q_b) and A_r q_b                 60 e (X + S)
//   fits: strays of rounded weights and moments, times |D_b c|, |D_b|   30 e (L + Q) (X + S)
//   weights made to add up to 1, times |(T_b - 1) x| and |D_b x|        1.8 x 3 n e L S
//   cut corners as weighted sums, here and of positions; y of these     20 e (X + S)
//   reading: origin + center, distances of a certificate                below 10 e (X + S + |origin|)
// Allowed: 16 (n + 16) e ((L + Q) (X + S) + |origin|). Fits refer to the computed y: only A_r multiplies its rounding.
// If the weights of a vertex add up to 1 +- s, its bone with the largest weight gets the rest, which moves it by up to
// s |(T_b - 1) x|; allowed: 2 s S. If those of a cut corner do, it moves by 1.8 s S, and by up to 3.5 s (X + S) against
// the corners of whose hull it is left out (modal.cpp); allowed: 8 s (L + Q) (X + S). Lengths in the radius are
// positive and pay by a share for their own arithmetic. Squares that vanish take less than 2^-500 Q from the strays,
// which is below the pad or, for smaller bodies, below what rounding up to a float adds. The motion of the center by
// narrowing to float is measured.
//
// Morph targets move and enlarge any of these spheres (skin_morphs.hpp).
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "parallel/interruption.hpp"
#include "update/points/ownership.hpp"
#include "update/points/ownership_check.hpp"
#include "update/points/rounding.hpp"
#include "update/rules/engine_table.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_blend.hpp"
#include "update/rules/skin_morphs.hpp"
#include "update/rules/skin_poser.hpp"
#include "update/rules/skin_training.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t groups_per_chunk = 4;
// Contains all that the poser accepts: coordinates about the origin are below 2^57 at rest, and displacements, the
// origin's included, below 2^56.
constexpr double largest_bound = 0x1p59;

// At least the root of the sum of the squares of the entries. Squares may vanish below the first limit and overflow,
// but three times the largest entry is a bound of that root at any size.
double frobenius_norm(const std::array<Vec3, 3>& columns) {
  const double largest = std::max({max_norm(columns[0]), max_norm(columns[1]), max_norm(columns[2])});
  const double root = std::sqrt(squared_length(columns[0]) + squared_length(columns[1]) + squared_length(columns[2]));
  return std::min(std::max(root * (1 + 0x1p-40), 0x1p-450), 3 * largest);
}

class SkinnedRule final : public RuleEngine {
 public:
  explicit SkinnedRule(const Binding& binding) {
    const CoveredTree& model = binding.model;
    // The rule has its own list of points, like `modal`.
    const LeafOrder order = depth_first_leaves(model.tree);
    const std::vector<std::uint8_t> every_leaf(order.leaves.size(), 1);
    const Ownership ownership = share_points(binding.mesh, model.cover, order, every_leaf, 0);
    assert(ownership_faults(binding.mesh, model.tree, model.cover, order, ownership, every_leaf, 0).empty());
    std::vector<NodeBlend> blends;
    for (std::uint32_t node = 0; node < binding.rules.of_node.size(); ++node)
      if (binding.rules.of_node[node] == Rule::skinned) blends.emplace_back().node.node = node;
    const Modes& modes = binding.options.modes;
    std::vector<NodeMorphs> morphs(modes.empty() ? 0 : blends.size());
    parallel_for(binding.workers, blends.size(), 1, [&](std::size_t k, std::size_t) {
      const std::uint32_t node = blends[k].node.node;
      const auto corners = corners_of(ownership, model.cover, order.begin[node], order.end[node]);
      blends[k] = blend_of_node(binding.options.skin, binding.mesh.positions, model.cover, corners,
                                model.tree.spheres[node].center, binding.posers.skin->rest_reach());
      blends[k].node.node = node;
      if (!morphs.empty()) morphs[k] = morphs_of_node(binding.options.skin, modes, model.cover, corners);
    });
    blend_ = SkinBlend(blends);
    binding.posers.skin->add_blend(blend_.factor_sum, blend_.most_terms);
    morphs_ = SkinMorphs(morphs, modes.mode_count, binding.options.skin.bone_count);
    binding.posers.skin->add_morphs(morphs_.factor_sum(), morphs_.most_terms());
    bones_.resize(binding.options.skin.bone_count);
    pairs_.resize(blend_.pairs.size());
    measured_ = trained_nodes(binding, [&](const RuleFrame& frame, std::span<Spheref> spheres) {
      update(frame, spheres.size(), spheres, binding.workers);
    });
  }
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<SkinnedRule>(*this); }

  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
              Workers& workers) noexcept override {
    const Uninterrupted whole;
    move_bones(frame.bones->transforms);
    morphs_.begin(*frame.bones, workers);
    const SkinKernels& kernels = skin_kernels();
    const SkinFrame bones{bones_.data(), pairs_.data(), blend_.terms.data()};
    parallel_for(workers, blend_.groups.size(), groups_per_chunk, [&](std::size_t begin, std::size_t end) {
      GroupSpheres bounds;
      for (const NodeGroup& group : std::span(blend_.groups).subspan(begin, end - begin)) {
        kernels.bound(group, bones, bounds);
        if (!frame.bones->morphs.empty()) add_morphs(group, bounds);
        kernels.narrow(group, frame.origin, frame.bones->pad, bounds);
        for (std::size_t lane = 0; lane < group.count; ++lane)
          if (const std::uint32_t node = blend_.nodes[group.slot[lane]].node; node < node_end)
            spheres[node] = sphere_of(bounds, lane);
      }
    });
    if (measured_) measured_->update(frame, node_end, spheres, workers);
  }
  std::size_t tested_points() const override { return measured_ ? measured_->tested_points() : 0; }
  MovedPoints moved_points() const override { return measured_ ? measured_->moved_points() : MovedPoints{}; }

 private:
  void move_bones(std::span<const AffineTransform> transforms) noexcept {
    for (std::size_t b = 0; b < bones_.size(); ++b) {
      const std::array<Vec3, 3>& columns = transforms[b].columns;
      bones_[b] = {{columns[0] - Vec3{1, 0, 0}, columns[1] - Vec3{0, 1, 0}, columns[2] - Vec3{0, 0, 1}},
                   transforms[b].translation,
                   largest_stretch(columns)};
    }
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      const BoneMotion &main = bones_[blend_.pairs[p].main], &other = bones_[blend_.pairs[p].other];
      for (std::size_t i = 0; i < 3; ++i) pairs_[p].columns[i] = other.columns[i] - main.columns[i];
      pairs_[p].shift = other.shift - main.shift;
      pairs_[p].size = frobenius_norm(pairs_[p].columns);
    }
  }

  void add_morphs(const NodeGroup& group, GroupSpheres& bounds) const noexcept {
    for (std::size_t lane = 0; lane < group.count; ++lane) {
      Sphere s{{bounds.center.x[lane], bounds.center.y[lane], bounds.center.z[lane]}, bounds.radius[lane]};
      morphs_.add_to(group.slot[lane], s);
      bounds.center.x[lane] = s.center.x, bounds.center.y[lane] = s.center.y, bounds.center.z[lane] = s.center.z;
      bounds.radius[lane] = s.radius;
    }
  }

  static Spheref sphere_of(const GroupSpheres& s, std::size_t lane) noexcept {
    // mutant skinned-largest-bound: `s.radius[lane] <= largest_bound` -> `true`
    if (s.radius[lane] <= largest_bound)
      return {Vec3f(Vec3{s.center.x[lane], s.center.y[lane], s.center.z[lane]}), rounded_up(s.radius[lane])};
    return {{}, rounded_up(largest_bound)};
  }

  SkinBlend blend_;
  SkinMorphs morphs_;
  std::vector<BoneMotion> bones_, pairs_;  // of the current frame
  std::optional<MeasuredNodes> measured_{};
};

}  // namespace

std::unique_ptr<RuleEngine> bind_skinned(const Binding& binding) {
  auto engine = std::make_unique<SkinnedRule>(binding);
  const std::vector<AffineTransform> at_rest(binding.options.skin.bone_count);
  const BonePose pose = binding.posers.skin->pose(binding.options.skin, at_rest);
  engine->update({.origin = pose.origin, .bones = &pose}, binding.spheres.size(), binding.spheres, binding.workers);
  return engine;
}

}  // namespace morula::detail
