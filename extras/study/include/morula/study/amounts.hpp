// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The amounts of the motions, and the units of looseness, at which the curves of the paper's Fig. 2 end where its
// printed axes end.
#pragma once

#include <array>
#include <cstdint>
#include <morula/study/study.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// The end of the printed axes of Fig. 2 a–d [garcia2005].
inline constexpr double paper_axis_end = 0.14;

/// Readings of "measured in object dimensions": divisors of the volume in the spheres and outside the object.
enum class AmountUnit : std::uint8_t {
  object,     ///< volume of the object in that pose
  box,        ///< volume of the object's box at rest
  grid,       ///< volume of the voxel grid, the box of the level's spheres in that pose
  thickness,  ///< area of the object's surface in that pose times the longest side of its box at rest: a mean thickness
              ///< as a share of the length
  edge,       ///< cube of the longest side; then the cube root: the edge of a cube of that volume
};
inline constexpr std::array amount_units{AmountUnit::object, AmountUnit::box, AmountUnit::grid, AmountUnit::thickness,
                                         AmountUnit::edge};
std::string_view name(AmountUnit unit);
/// The unit as text, for axes.
std::string_view text(AmountUnit unit);

/// The looseness of one level in each unit, in the order of amount_units.
using UnitValues = std::array<double, amount_units.size()>;
/// outside_volume: of the level in that pose. area, longest_side, box_volume: of the object, as the units say.
UnitValues unit_values(const Looseness& grid, double area, double longest_side, double box_volume);

/// Part of Fig. 2: a and b are Approach 1 and 2 on the medial tree, c and d the paper's generators with Approach 2; a
/// and c the upper level, b and d the leaves.
enum class FigurePart : std::uint8_t { a, b, c, d };

struct FoundAmount {
  std::size_t body = 0;
  std::size_t motion = 0;  ///< in the plan
  FigurePart part = FigurePart::a;
  AmountUnit unit = AmountUnit::object;
  /// The share of the motion's full amount at which the largest curve reaches the end of the axis. No value if it does
  /// not at the full amount, and if it is beyond it at rest.
  std::optional<double> share{};
  double at_rest = 0, at_full = 0;  ///< the largest curve
};

/// The least share at which a function that begins below `end` is found at or above it, to 1/256, by bisection; no
/// value for a function that begins at or above it, or ends below.
std::optional<double> share_reaching(double end, const std::function<double(double)>& value);

struct PaperAmounts {
  std::vector<FoundAmount> found;  ///< by body, motion, part and unit
  std::vector<Figure>
      figures;  ///< of the first body's first motion: Fig. 2 at the full amount, then on the paper's axes
};

/// Searches the amounts of the plan's motions for all bodies whose trees are those of generators of the paper. Throws
/// like run().
PaperAmounts find_paper_amounts(const Plan& plan, Workers& workers = serial_workers(), const RunOptions& options = {});

/// One row per body, motion and unit: the amounts for Fig. 2 a–d.
Table amounts_table(const Plan& plan, const PaperAmounts& amounts);
}  // namespace morula::study
