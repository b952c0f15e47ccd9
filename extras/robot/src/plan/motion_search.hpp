// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The search along an edge: parts are proven free as a whole, or halved for the spheres that could not be proven.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "plan/batch.hpp"
#include "plan/motion_bounds.hpp"

namespace morula::robot {

/// Searches edges, one after the other. It keeps its memory between them.
class MotionSearch {
 public:
  MotionSearch(const ConfigurationQuery::Model& model, const World::Data* world, const MotionOptions& options);

  /// Certified: halves the edge from its start to its end until every part is free, undecided, or after a contact.
  MotionVerdict certified(std::span<const double> from, std::span<const double> to);
  /// Tests configurations at a resolution: the ends, then the middles between tested ones, repeatedly.
  MotionVerdict discrete(std::span<const double> from, std::span<const double> to);

 private:
  /// A node, and the node or obstacle that it may touch.
  struct Item {
    std::uint32_t node = 0, other = 0;
    std::uint32_t pair = 0;  // in MotionBodies::pairs; of_world: `other` is an obstacle
  };
  static constexpr std::uint32_t of_world = 0xffffffff;
  /// An item in the middle of a part.
  struct Gap {
    double gap = 0;        // distance of the surfaces
    double motion = 0;     // bound of how much the gap shrinks within the part
    double allowance = 0;  // bound of all rounding in both
    bool is_free() const { return gap > motion + allowance; }
  };
  /// A part in which a gap shrinks by no more, and the robot is no deeper, is not halved.
  double least_motion(const Gap& gap) const;
  Gap gap_to_obstacle(const Item& item);
  Gap gap_of_pair(const Item& item);
  /// True if a look at the children may prove more than halving.
  bool is_worth_descent(const Item& item, const Gap& gap) const;
  void descend(const Item& item);

  void start_items();
  void search(double start, double end, std::size_t first, std::size_t last);
  bool visit(double start, double middle, double end);
  void give_up(double start, double middle, double end);
  bool is_contact(double time);
  ConfigurationVerdict contact_at(double time);
  bool touches_in_block(MotionVerdict& verdict);

  const ConfigurationQuery::Model& model_;
  const MotionBodies& bodies_;
  const World::Data* world_;
  const MotionOptions& options_;
  MotionBounds bounds_;
  std::vector<Item> items_, stack_;
  std::vector<double> values_;
  std::vector<RigidTransform> poses_;
  std::span<const double> from_{}, to_{};
  static constexpr double never = std::numeric_limits<double>::infinity();
  double contact_ = never, undecided_ = never;  // earliest times so far
  bool end_undecided_ = false;
  // discrete
  std::optional<BatchCheck> batch_;
  std::vector<double> times_, block_;
};

}  // namespace morula::robot
