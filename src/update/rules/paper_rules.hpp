// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rules of the paper and of earlier work: traditional, weighted, approach 1, approach 2 [garcia2005, sec. 3], and
// wrapped, which reads children like them.
#pragma once

#include <span>
#include <vector>

#include "update/rules/engine.hpp"

namespace morula::detail {

class PaperRules final : public RuleEngine {
 public:
  /// The nodes of other engines must have their spheres at rest. Spheres of traditional, weighted and wrapped nodes are
  /// replaced by the rules' spheres at rest. Counts void and unlinked spheres in the report.
  explicit PaperRules(const Binding& binding);
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<PaperRules>(*this); }

  /// Does nothing; all is in update_level: approaches 1 and 2 read the children, whatever rule made them.
  void update(const RuleFrame&, std::size_t, std::span<Spheref>, Workers&) noexcept override {}
  void update_level(std::size_t level, const RuleFrame& frame, std::span<Spheref> spheres,
                    Workers& workers) noexcept override;

  std::size_t tested_points() const override { return tested_points_; }
  /// Wrapping repeats all its work after any change; it tests no points.
  bool follows_changes() const override { return only_wraps_; }

 private:
  struct Node {
    std::uint32_t node;
    Rule rule;
    bool keeps_radius = false;  // traditional: a void sphere
    bool has_ratio = false;     // approach 1: a distance at rest is large enough to divide by
    std::uint32_t first_child = no_node, child_count = 0;
    std::uint32_t link_begin = 0,
                  link_end =
                      0;  // end of the link in points_ and weights_; the range is empty if children replace vertices
    std::uint32_t ratio_begin = 0;  // approach 1: begin in divisors_ and raises_, one entry per link or per child
    Spheref rest{};                 // the tree's sphere
    Vec3 rest_sum{};                // sum of the weighted links
    Vec3f rest_box_center{};        // approach 2
    float rest_reach = 0;           // approach 2: reach of the farthest box corner
  };
  struct Boxf {
    Vec3f lower, upper;
    Vec3f center() const { return (lower + upper) * 0.5f; }
  };
  void bind_links(const Binding& binding);
  void bind_rest(const Binding& binding, Node& n);
  void add_ratio(Node& n, float rest_distance);

  std::span<const std::uint32_t> links(const Node& n) const {
    return std::span(points_).subspan(n.link_begin, n.link_end - n.link_begin);
  }
  Vec3 weighted_sum(const Node& n, std::span<const LocalPoint> points) const noexcept;
  Vec3f moved_by_links(const Node& n, std::span<const LocalPoint> points) const noexcept;
  Spheref traditional(const Node& n, std::span<const LocalPoint> points, const Rounding& rounding) const noexcept;
  Spheref wrapped(const Node& n, const Rounding& rounding, std::span<const Spheref> spheres) const noexcept;
  Vec3f moved_by_children(const Node& n, std::span<const Spheref> spheres) const noexcept;
  Spheref approach1(const Node& n, std::span<const LocalPoint> points, std::span<const Spheref> spheres) const noexcept;
  Spheref approach2(const Node& n, std::span<const LocalPoint> points, std::span<const Spheref> spheres) const noexcept;
  Boxf box_of(const Node& n, std::span<const LocalPoint> points, std::span<const Spheref> spheres) const noexcept;

  std::vector<Node> nodes_;                 // ascending
  std::vector<std::uint32_t> level_begin_;  // begins in nodes_, one more than levels
  // Links, padded to whole groups by the last one again, with weight 0.
  std::vector<std::uint32_t> points_;
  std::vector<float> weights_;
  std::vector<float> divisors_, raises_;  // d + k and k of (d' + k) / (d + k)
  std::vector<Spheref> rest_spheres_;     // each rule's spheres of all nodes for the rest positions
  bool boxes_of_centers_ = false, wraps_smallest_ = false, only_wraps_ = true;
  double distance_floor_ = 0;
  std::size_t tested_points_ = 0;
};

}  // namespace morula::detail
