// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The update rules as plain values, the options that the paper leaves open, and the reports of construction and
// updates.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/status.hpp>
#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// The way a node's sphere follows the deformed surface [garcia2005, sec. 3]. rule_table has the properties of each
/// rule.
enum class Rule : std::uint8_t {
  traditional,  ///< center: mean displacement of the enclosed vertices; radius: the farthest of them
  weighted,     ///< like traditional, with vertices weighted by their share of the area [james2004]
  approach1,    ///< linked vertices; radius by the largest ratio of distances (eq. 2–4)
  approach2,    ///< boxes of linked vertices or child spheres; radius by the ratio of farthest box corners (eq. 1, 5)
  exact,        ///< Morula's own: owned patches, every corner inside; covers by construction
  wrapped,      ///< bottom-up: a sphere around the children's, hence nested; covers if they do. Leaves: `exact`
  modal,        ///< follows the coordinates of a modal model alone, over owned corners [james2004]; covers for these
                ///< coordinates
  skinned,      ///< follows the transforms of a skin's bones alone, over owned corners [jones2017, kavan2005]; covers
                ///< at these transforms
};

/// The properties of a rule, in one place for names, checks and certificates.
struct RuleTraits {
  /// The update that moves the rule: Body::update, update_modal or update_skinned. All three move rules that follow
  /// positions.
  enum class Follows : std::uint8_t { positions, modes, bones };
  /// The input of a rule in every frame: the corners that nodes own; linked vertices and children's spheres; children's
  /// spheres alone (leaves then follow `exact`); or only the coordinates or transforms that it follows.
  enum class Reads : std::uint8_t { corners, links, children, nothing };

  Rule rule;
  std::string_view name;
  Follows follows;
  Reads reads;
  bool covers;  ///< covers by construction; a rule that reads children covers if the children do
};
/// One row per rule, in the order of the enumerators; rules.cpp checks this at compile time.
inline constexpr std::array rule_table{
    RuleTraits{Rule::traditional, "traditional", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::weighted, "weighted", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::approach1, "approach1", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::approach2, "approach2", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::exact, "exact", RuleTraits::Follows::positions, RuleTraits::Reads::corners, true},
    RuleTraits{Rule::wrapped, "wrapped", RuleTraits::Follows::positions, RuleTraits::Reads::children, true},
    RuleTraits{Rule::modal, "modal", RuleTraits::Follows::modes, RuleTraits::Reads::nothing, true},
    RuleTraits{Rule::skinned, "skinned", RuleTraits::Follows::bones, RuleTraits::Reads::nothing, true},
};

/// True for an enumerator, false for other numbers.
constexpr bool is_rule(Rule rule) {
  return static_cast<std::size_t>(rule) < rule_table.size();
}
/// The properties of a rule. rule: an enumerator.
constexpr const RuleTraits& traits(Rule rule) {
  return rule_table[static_cast<std::size_t>(rule)];
}
/// True if the rule covers by construction, with any rules on other levels.
constexpr bool covers_alone(Rule rule) {
  return traits(rule).covers && traits(rule).reads != RuleTraits::Reads::children;
}
std::string_view name(Rule rule);
std::optional<Rule> rule_from_name(std::string_view name);
std::span<const Rule> all_rules();
/// The rules that follow positions; they need only a mesh and its tree.
std::span<const Rule> position_rules();

/// Choices that the papers leave open. Defaults are the literal readings, except modal_bound.
struct RuleOptions {
  enum class Weights : std::uint8_t { uniform, inverse_distance, area };
  Weights approach1_weights = Weights::uniform;  ///< weights of linked vertices in a leaf's center
  enum class InnerCenter : std::uint8_t { children, linked_vertices };
  InnerCenter approach1_inner_center = InnerCenter::children;
  enum class InnerBoxes : std::uint8_t { child_spheres, child_centers };
  InnerBoxes approach2_inner_boxes = InnerBoxes::child_spheres;
  /// Center of `wrapped`. children: it moves with the mean of the children's. smallest: it then moves to where the
  /// radius is least, within a few percent: the smallest sphere around theirs.
  enum class WrappedCenter : std::uint8_t { children, smallest };
  WrappedCenter wrapped_center = WrappedCenter::children;
  /// Distances below this share of the radius are raised before ratios are taken (τ of D.4): 0 is the paper, which then
  /// skips vertices nearer than 1e-9 of the radius; 0.25 is robust.
  double distance_floor = 0.0;
  /// Bound of `modal` for the corners of a node. shift: one displacement per mode and node, and the largest deviation
  /// of corners from it, as in the paper. gradient: also with a linear field per mode and node, which follows strain
  /// and rotation; each node uses the smaller sphere. gradient takes four times the work and is far tighter for smooth
  /// modes.
  enum class ModalBound : std::uint8_t { gradient, shift };
  ModalBound modal_bound = ModalBound::gradient;
  /// Budget of the nodes of `skinned` that are measured on their own corners: 0 to 1, as a share of the estimated cost
  /// of measuring all of them, which is that of `exact` on the same levels with the vertices to move. The constructor
  /// of the body picks the nodes that get most for their cost at UpdateOptions::training; the others follow bones
  /// alone. All nodes still cover. 1 measures each node that gains a hundredth of volume or more, 0 none.
  double skinned_measured = 0;
};

/// One rule per level from the root; the last rule serves all deeper levels.
struct UpdateOptions {
  std::vector<Rule> rules{Rule::exact};
  /// true: grow radii of the other rules to contain owned corners, so that every level covers the surface in the
  /// cheapest sound way. It costs one more pass over the owned corners. Radii of `wrapped` also grow with their
  /// children.
  bool conservative = false;
  RuleOptions details{};
  Modes modes{};  ///< modes of update_modal(), required by `modal`; with a skin, its morph targets
  Skin skin{};    ///< skin of update_skinned(); required by `skinned`
  /// Poses that are typical of the motion to come: the frames of an animation, or bones at and between the limits of
  /// their joints. Frame after frame, one transform per bone of `skin`; needed with RuleOptions::skinned_measured above
  /// 0, unused otherwise. Ten to forty frames are enough; the constructor updates a body at each. The constructor
  /// throws std::invalid_argument for a frame that update_skinned() would reject.
  std::vector<AffineTransform> training{};
};
/// True if all levels cover the surface by construction, in any motion.
bool covers(const UpdateOptions& options);
/// True if the levels of this rule, with these options, cover by construction.
bool covers(const UpdateOptions& options, Rule rule);

/// A rejection, or the work done, which is the same in every run; all 0 if nothing was changed.
struct [[nodiscard]] UpdateStatus : Status {
  std::size_t nodes_updated = 0;
  std::size_t vertices_read = 0;  ///< 0 if no node reads points; `skinned` moves those of measured nodes by itself
  std::size_t cut_points_moved = 0;
  std::size_t points_tested = 0;  ///< vertices and corners that nodes read: measured, or boxed by approach2
};

/// A status of a fault. index: the number of the vertex, coordinate or bone.
inline UpdateStatus refused(Status::Code code, std::size_t index = 0) {
  UpdateStatus status;
  status.code = code;
  status.index = index;
  return status;
}

/// Degenerate cases found when the body was made.
struct BindReport {
  std::size_t void_spheres = 0;  ///< nodes that enclose no vertex (traditional, weighted); they follow a linked facet
  std::size_t unlinked_spheres = 0;    ///< leaves that touch no facet; linked to the nearest one (approaches 1 and 2)
  std::size_t degenerate_anchors = 0;  ///< nodes with fewer than four independent anchors; they follow their mean
  /// Centers far outside the hull of their anchors; the remainder rotates with the anchors.
  std::size_t carried_centers = 0;
  std::size_t corners_owned = 0;   ///< points tested by a leaf level of `exact`
  std::size_t nodes_measured = 0;  ///< nodes of `skinned` that are measured on their own corners
};

/// The rule of a level; the last rule serves all deeper levels.
Rule rule_of_level(std::span<const Rule> rules, std::size_t level);
/// The rules as text: "exact", or "exact on levels 0-1, approach2 on levels 2-3" if levels differ.
std::string describe_rules(std::span<const Rule> rules, std::size_t level_count);

}  // namespace morula
