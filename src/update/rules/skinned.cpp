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
// has the center alone; its sphere may leave corners outside.
//
// At joints that bend far these spheres grow. Where one has grown by more than `loose`, two more are tried:
//   shape  y = y_0 + L u with |u| <= 1, hence |p - (C + F y_0)| <= |F L| + strays; a patch is flat, and F may stretch
//          only across it
//   hull   p is a convex combination of the points T_b (c + m_b / w_b), so it lies in any ball around the moved balls
//          of the bones [kavan2005]. It needs weights of at least 0.
// The smallest is taken. The first has the tree's center at rest, where spheres stick out of the body the least.
//
// Rounding, all in double, e = 2^-53. X bounds |coordinates| at rest, S those of displacements (T_b - 1) x, L the sum
// of |weights| of a vertex, Q the sum of the factors of a node (factor_sum), n the number of summands. Lengths:
//   the caller's own sum rest + sum w_b (T_b - 1) rest                  1.8 (n + 8) e L (X + S)
//   C: D_b c to 20 e S; factors and their sum                           1.8 (n + 40) e Q (X + S)
//   entries of F, times |y| <= 3.5 X                                    6.1 (n + 16) e (1 + Q) (X + S)
//   fits: strays of rounded weights and moments, times |D_b c|, |D_b|   30 e (L + Q) (X + S)
//   weights made to add up to 1, times |(T_b - 1) x| and |D_b x|        1.8 x 3 n e L S
//   cut corners as weighted sums, here and of positions; y of these     20 e (X + S)
//   reading: origin + center, distances of a certificate                below 10 e (X + S + |origin|)
// Allowed: 16 (n + 16) e ((L + Q) (X + S) + |origin|). Fits refer to the computed y: only A_r multiplies its rounding.
// If the weights of a vertex add up to 1 +- s, its bone with the largest weight gets the rest, which moves it by up to
// s |(T_b - 1) x|; allowed: 2 s S. If those of a cut corner do, it moves by 1.8 s S, and by up to 3.5 s (X + S) against
// the corners of whose hull it is left out (modal.cpp); allowed: 8 s (L + Q) (X + S). Lengths in the radius are
// positive and pay by a share for their own arithmetic; the motion of the center by narrowing to float is measured.
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
#include "update/rules/skin_poser.hpp"
#include "update/rules/skin_training.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t nodes_per_chunk = 32;
// Growth of a sphere, over that by its main bone, from which other bounds are tried.
constexpr double loose = 1.25;
// Contains all that the poser accepts: coordinates about the origin are below 2^57 at rest, and displacements, the
// origin's included, below 2^56.
constexpr double largest_bound = 0x1p59;

// A bone's transform less the identity, or less that of another bone.
struct Difference {
  std::array<Vec3, 3> columns;
  Vec3 shift;
  double stretch;  // bound of the largest stretch: of the bone's linear part itself, or of the difference

  Vec3 linear(const Vec3& v) const { return times(columns, v); }
  Vec3 operator()(const Vec3& p) const { return linear(p) + shift; }
};

// A ball around balls: around the two that are nearly farthest apart, then pulled toward the farthest a few times. For
// two balls it is the smallest.
Sphere ball_around(std::span<const Sphere> balls) {
  const auto measure = [&](const Vec3& center, double& reach) -> const Sphere& {
    std::size_t farthest = 0;
    reach = 0;
    for (std::size_t i = 0; i < balls.size(); ++i)
      if (const double r = distance(center, balls[i].center) + balls[i].radius; r > reach) reach = r, farthest = i;
    return balls[farthest];
  };
  Sphere best;
  const bool are_two = balls.size() == 2;
  const Sphere& a = are_two ? balls[0] : measure(balls[0].center, best.radius);
  const Sphere& b = are_two ? balls[1] : measure(a.center, best.radius);
  const double gap = distance(a.center, b.center);
  best.center = a.center;
  if (gap > 0) best.center += (b.center - a.center) * std::clamp(0.5 + (b.radius - a.radius) / (2 * gap), 0.0, 1.0);
  const Sphere* farthest = &measure(best.center, best.radius);
  Sphere pulled = best;
  const int pulls = are_two ? 0 : 4;
  for (int k = 1; k <= pulls; ++k) {
    pulled.center += (farthest->center - pulled.center) * (0.25 / k);
    farthest = &measure(pulled.center, pulled.radius);
    if (pulled.radius < best.radius) best = pulled;
  }
  return best;
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
    parallel_for(binding.workers, blends.size(), 1, [&](std::size_t k, std::size_t) {
      const std::uint32_t node = blends[k].node.node;
      blends[k] = blend_of_node(binding.options.skin, binding.mesh.positions, model.cover,
                                corners_of(ownership, model.cover, order.begin[node], order.end[node]),
                                model.tree.spheres[node].center, binding.posers.skin->rest_reach());
      blends[k].node.node = node;
    });
    blend_ = SkinBlend(blends);
    binding.posers.skin->add_blend(blend_.factor_sum, blend_.most_terms);
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
    parallel_for(workers, blend_.nodes.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        if (const BlendNode& n = blend_.nodes[k]; n.node < node_end) spheres[n.node] = sphere_of(n, frame);
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
      const Difference &main = bones_[blend_.pairs[p].main], &other = bones_[blend_.pairs[p].other];
      for (std::size_t i = 0; i < 3; ++i) pairs_[p].columns[i] = other.columns[i] - main.columns[i];
      pairs_[p].shift = other.shift - main.shift;
      pairs_[p].stretch = largest_stretch(pairs_[p].columns);
    }
  }

  Spheref sphere_of(const BlendNode& n, const RuleFrame& frame) const noexcept {
    const Difference& main = bones_[n.bone];
    Sphere s{main(n.rest.center), main.stretch * n.rest.radius};
    if (n.first_term != n.end_term) s = blended(n, s);
    const Vec3 center = n.rest.center + s.center - frame.origin;
    // Adding zero makes a negative zero positive, like the other rules.
    const Vec3f nearest = Vec3f(center) + Vec3f{};
    // mutant skinned-narrowed-center: `s.radius + distance(Vec3(nearest), center)` -> `s.radius`
    const double radius = (s.radius + distance(Vec3(nearest), center)) * (1 + 0x1p-40) + frame.bones->pad;
    // mutant skinned-largest-bound: `radius <= largest_bound` -> `true`
    return radius <= largest_bound ? Spheref{nearest, rounded_up(radius)} : Spheref{{}, rounded_up(largest_bound)};
  }

  // The smallest of the bounds; its center is a displacement of the node's. of_main: by the main bone alone.
  Sphere blended(const BlendNode& n, const Sphere& of_main) const noexcept {
    std::array<Vec3, 3> columns = bones_[n.bone].columns;
    columns[0].x += 1, columns[1].y += 1, columns[2].z += 1;
    Sphere s = of_main;
    double strays = 0;
    for (std::uint32_t i = n.first_term; i < n.end_term; ++i) {
      const BlendTerm& t = blend_.terms[i];
      const Difference& pair = pairs_[t.pair];
      const Vec3 move = pair(n.rest.center);
      s.center += t.weight * move + pair.linear(t.moment);
      columns[0] += t.slope.x * move + t.scale * pair.columns[0];
      columns[1] += t.slope.y * move + t.scale * pair.columns[1];
      columns[2] += t.slope.z * move + t.scale * pair.columns[2];
      strays += t.weight_stray * length(move) + t.moment_stray * pair.stretch;
    }
    // mutant skinned-strays: `n.rest.radius + strays` -> `n.rest.radius`
    s.radius = largest_stretch(columns) * n.rest.radius + strays;
    if (s.radius <= loose * of_main.radius) return s;

    const PatchShape& shape = blend_.shapes[n.shape];
    std::array<Vec3, 3> axes;
    for (std::size_t k = 0; k < 3; ++k) axes[k] = times(columns, shape.axes[k]);
    // mutant skinned-shape-strays: `(axes) + strays` -> `(axes)`
    const Sphere shaped{s.center + times(columns, shape.center), largest_stretch(axes) + strays};
    if (shaped.radius < s.radius) s = shaped;
    if (const Sphere hull = hull_of_bones(n, s.radius); hull.radius < s.radius) s = hull;
    return s;
  }

  // Infinite if it could not be smaller than `enough`.
  Sphere hull_of_bones(const BlendNode& n, double enough) const noexcept {
    std::array<Sphere, most_balls> moved;
    const std::uint32_t count = n.end_ball - n.first_ball;
    bool is_smaller = count != 0;
    for (std::uint32_t i = 0; i < count && is_smaller; ++i) {
      const BoneBall& ball = blend_.balls[n.first_ball + i];
      const Difference& bone = bones_[ball.bone];
      moved[i] = {ball.center + bone(n.rest.center + ball.center), bone.stretch * ball.radius};
      is_smaller = moved[i].radius < enough;
    }
    if (!is_smaller) return {{}, std::numeric_limits<double>::infinity()};
    return ball_around(std::span(moved).first(count));
  }

  SkinBlend blend_;
  std::vector<Difference> bones_, pairs_;  // of the current frame
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
