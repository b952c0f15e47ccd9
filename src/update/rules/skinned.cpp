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
// The smallest is taken. The first has the smallest sphere at rest.
//
// Nodes with one main bone, and nearly the same others, are bounded in groups, one in each lane (skin_groups.cpp). A
// bone that moves only some of them has factors and strays of 0 in the others and adds exactly 0; its ball there has
// the radius -infinity and reaches nowhere. Lanes share only the choice above, which is made once for the group:
// no bit depends on the width of registers.
//
// The kernels compute in float, and strays pay for it. Lengths are in units of the blend: z is the node's center at
// rest about a pivot, R its radius, and d_b the displacement of the pivot by D_b. D_b and d_b are computed in double
// and then narrowed. u = 2^-24, n is the number of terms of the group, k = (n + 16) u. |.| of a matrix that a rounding
// multiplies is the root of the sum of its squares. These errors are paid for:
//   D_b c = D_b z + d_b                                  6 u |D_b| |z| + 2 u |d_b|
//   C, and F times |y| <= R, of a narrowed term          (n + 11) u (a (|D_b| |z| + |d_b|) + m |D_b|)
//                     a = |W_b| + |g_b| R + E_b, m = |M_b| + |s_b| R
//   C and F of the main bone                             (n + 5) u |T_r - 1| |z|, (n + 1) u |A_r| R
// Since |d_b| <= |D_b c| + |D_b| |z|, E_b grows by k a, and the stray of moments by k (2 a |z| + m). For the main bone
// the strays grow by k |z| |T_r - 1| and by 1.75 k R times its stretch; 1.75 > sqrt(3). A share k is added to all of
// these lengths, for their own sums.
//   shape: the stretch of F L, and F y_0                 6 sqrt(3) u |F| (|L| + |y_0|); allowed: 16 u of the root of
//                                                        the sum of squares of L and y_0
//   hull: A_b (z + q_b) + d_b                            13 u |A_b| |z + q_b| + 2 u |ball's center|
// The radius of a ball pays for the first summand by 16 u. The reach pays for the second, for the distances and for the
// center, by a share of 16 u and by 4 u of the sums of |coordinates|.
//   stretch: G = F^T F, with the mean eigenvalue m       9 u m; the deviator's diagonal 2 u m
//            The deviator's trace is t <= 17 u m instead of 0, and its determinant is off by 118 u p^3 + 3 |t| p^2. The
//            largest eigenvalue grows with p and with the determinant, and the bound of f has a slope of at most 4, so
//            the error is below 4 (59 u 2 p + 2 |t|) + 11 u m + |t| / 3 + 100 u p, and p <= m.
// That is less than 800 u m; allowed: 2^-14 = 1024 u, hence 2^-15 of its root. Numbers below 2^-126, and squares that
// vanish below them, cost less than 2^-60 (1 + Q) moved units, Q as below; the pad of a frame has them, since a body
// can be far smaller than the least unit. A power of two scales transforms beyond 2^40, so that products of matrices
// and lengths at rest stay in the range of float. Where large weights of both signs still leave it, the node gets the
// largest sphere.
//
// Rounding in double, e = 2^-53. X bounds |coordinates| at rest, S those of displacements (T_b - 1) x, L the sum
// of |weights| of a vertex, Q the sum of the factors of a node (factor_sum), n the number of summands. Lengths:
//   the caller's own sum rest + sum w_b (T_b - 1) rest                  1.8 (n + 8) e L (X + S)
//   the moved pivot; D_b, s_b; factors and their sum                    1.8 (n + 40) e Q (X + S)
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
// positive and pay by a share for their own arithmetic. The motion of the center by narrowing to float is measured.
//
// Morph targets move and enlarge any of these spheres (skin_morphs.hpp).
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/rounded_up.hpp"
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

// The main bones of groups, and the bones of pairs.
std::vector<std::uint32_t> used_bones(const SkinBlend& blend) {
  std::vector<std::uint32_t> bones;
  for (const NodeGroup& group : blend.groups) bones.push_back(group.bone);
  for (const BonePair& pair : blend.pairs) bones.push_back(pair.other);
  std::sort(bones.begin(), bones.end());
  bones.erase(std::unique(bones.begin(), bones.end()), bones.end());
  return bones;
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
    morphs_ = SkinMorphs(morphs, modes.mode_count, binding.options.skin.bone_count);
    // Targets can move a body by far more than its size at rest, but not out of the range of float.
    // mutant skinned-morph-unit: `std::min(morphs_.reach(), 0x1p57)` -> `0.0`
    blend_ = SkinBlend(blends, 0x1p-64 * std::min(morphs_.reach(), 0x1p57));
    binding.posers.skin->add_blend(blend_.factor_sum, blend_.most_terms);
    binding.posers.skin->add_morphs(morphs_.factor_sum(), morphs_.most_terms());
    bones_.resize(binding.options.skin.bone_count);
    shifts_.resize(bones_.size());
    rows_.resize(bones_.size() + 1);
    used_ = used_bones(blend_);
    pairs_.resize(blend_.pairs.size());
    measured_ = trained_nodes(binding, [&](const RuleFrame& frame, std::span<Spheref> spheres) {
      update(frame, spheres.size(), spheres, binding.workers);
    });
  }
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<SkinnedRule>(*this); }

  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
              Workers& workers) noexcept override {
    const Uninterrupted whole;
    morphs_.begin(*frame.bones, workers);
    const SkinKernels& kernels = skin_kernels();
    move_bones(frame.bones->transforms, kernels);
    const SkinFrame bones{
        bones_.data(),       pairs_.data(), blend_.terms.data(), shifts_.data(), static_cast<float>(scale_),
        blend_.unit / scale_};
    // mutant skinned-underflow: `0x1p-60 *` -> `0 *`
    const double pad = frame.bones->pad + 0x1p-60 * (1 + blend_.factor_sum) * bones.unit;
    parallel_for(workers, blend_.groups.size(), groups_per_chunk, [&](std::size_t begin, std::size_t end) {
      GroupSpheres bounds;
      for (const NodeGroup& group : std::span(blend_.groups).subspan(begin, end - begin)) {
        kernels.bound(group, bones, bounds);
        if (!frame.bones->morphs.empty()) add_morphs(group, bones.unit, bounds);
        kernels.narrow(group, bones, frame.origin, pad, bounds);
        for (std::size_t lane = 0; lane < group.count; ++lane)
          if (const std::uint32_t node = blend_.nodes[group.slot[lane]].node; node < node_end)
            spheres[node] = {{bounds.center.x[lane], bounds.center.y[lane], bounds.center.z[lane]},
                             bounds.radius[lane]};
      }
    });
    if (measured_) measured_->update(frame, node_end, spheres, workers);
  }
  std::size_t tested_points() const override { return measured_ ? measured_->tested_points() : 0; }
  MovedPoints moved_points() const override { return measured_ ? measured_->moved_points() : MovedPoints{}; }

 private:
  void move_bones(std::span<const AffineTransform> transforms, const SkinKernels& kernels) noexcept {
    double largest = 0;
    for (const std::uint32_t b : used_) {
      const AffineTransform& t = transforms[b];
      shifts_[b] = displacement(t, blend_.pivot);
      const Vec3 row[]{t.columns[0] - Vec3{1, 0, 0}, t.columns[1] - Vec3{0, 1, 0}, t.columns[2] - Vec3{0, 0, 1},
                       shifts_[b] / blend_.unit};
      for (std::size_t k = 0; k < 4; ++k) {
        largest = std::max(largest, max_norm(row[k]));
        for (int axis = 0; axis < 3; ++axis) rows_[b].entries[3 * k + static_cast<std::size_t>(axis)] = row[k][axis];
      }
    }
    // mutant skinned-scale: `largest > 0x1p40` -> `false`
    scale_ = largest > 0x1p40 ? std::ldexp(1.0, -1 - std::ilogb(largest)) : 1.0;
    for (std::size_t first = 0; first < used_.size(); first += lanes_of_group)
      move_lanes(transforms, std::span(used_).subspan(first), kernels);
    kernels.differ(rows_.data(), blend_.pairs, scale_, pairs_.data());
  }
  // The first of the bones, as many as there are lanes.
  void move_lanes(std::span<const AffineTransform> transforms, std::span<const std::uint32_t> bones,
                  const SkinKernels& kernels) noexcept {
    LaneVectors columns[3]{};
    LaneFloats sizes;
    const std::size_t count = std::min(bones.size(), lanes_of_group);
    for (std::size_t lane = 0; lane < count; ++lane)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3f column(transforms[bones[lane]].columns[k] * scale_);
        bones_[bones[lane]].linear[k] = column;
        columns[k].x[lane] = column.x, columns[k].y[lane] = column.y, columns[k].z[lane] = column.z;
      }
    kernels.stretch(columns, sizes);
    for (std::size_t lane = 0; lane < count; ++lane) {
      bones_[bones[lane]].size = sizes[lane];
      const BonePair whole{static_cast<std::uint32_t>(bones_.size()), bones[lane]};
      kernels.differ(rows_.data(), {&whole, 1}, scale_, &bones_[bones[lane]].change);
    }
  }

  // Morph targets are added in double; the radius pays for narrowing the center.
  void add_morphs(const NodeGroup& group, double unit, GroupSpheres& bounds) const noexcept {
    for (std::size_t lane = 0; lane < lanes_of_group; ++lane) {
      const Vec3f at{bounds.center.x[lane], bounds.center.y[lane], bounds.center.z[lane]};
      Sphere s{unit * Vec3(at), unit * static_cast<double>(bounds.radius[lane])};
      morphs_.add_to(group.slot[lane], s);
      const Vec3 center = s.center / unit;
      const Vec3f nearest(center);
      bounds.center.x[lane] = nearest.x, bounds.center.y[lane] = nearest.y, bounds.center.z[lane] = nearest.z;
      // mutant skinned-morphed-center: `+ length(Vec3(nearest) - center)` -> ``
      bounds.radius[lane] = rounded_up((s.radius / unit + length(Vec3(nearest) - center)) * (1 + 0x1p-40));
    }
  }

  SkinBlend blend_;
  SkinMorphs morphs_;
  std::vector<std::uint32_t> used_;  // bones of groups and terms
  // The current frame:
  std::vector<Vec3> shifts_;   // displacements of the pivot, by bone
  std::vector<BoneRow> rows_;  // by bone, and one of zeros
  std::vector<BoneMotion> bones_;
  std::vector<MotionRow> pairs_;
  double scale_ = 1;
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
