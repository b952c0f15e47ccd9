// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The update rules, as plain values, what the paper leaves open about them, and what making and moving a body reports.
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

/// How a node's sphere follows the deformed surface [garcia2005, sec. 3]. rule_table says what is known of each.
enum class Rule : std::uint8_t {
  traditional,  ///< center: mean displacement of the enclosed vertices; radius: farthest of them
  weighted,     ///< as traditional, vertices weighted by their share of the area [james2004]
  approach1,    ///< linked vertices; radius by the largest ratio of distances (eq. 2–4)
  approach2,    ///< boxes of linked vertices or child spheres; radius by the ratio of farthest box corners (eq. 1, 5)
  exact,        ///< Morula's: owned patches, every corner inside; covers by construction
  wrapped,      ///< bottom-up: a sphere around the children's, hence nested; covers when they do. Leaves: `exact`
  modal,        ///< follows the coordinates of a modal model alone, over owned corners [james2004]; covers likewise
  skinned,      ///< moved and resized by the transforms of a skin's bones [jones2017]; may leave surface bare
};

/// What is known of a rule, written once: names, checks and certificates ask here.
struct RuleTraits {
  /// Which update moves it: Body::update, update_modal or update_skinned. All of them move rules that follow positions.
  enum class Follows : std::uint8_t { positions, modes, bones };
  /// What it looks at in every frame: the corners that nodes own; vertices that they are linked with, and children's
  /// spheres; these alone (a leaf, which has none, then follows `exact`); or what it follows and nothing else.
  enum class Reads : std::uint8_t { corners, links, children, nothing };

  Rule rule;
  std::string_view name;
  Follows follows;
  Reads reads;
  bool covers;  ///< by construction; one that reads children covers as far as they do
};
/// One row per rule, in the order of the enumerators: rules.cpp does not compile otherwise.
inline constexpr std::array rule_table{
    RuleTraits{Rule::traditional, "traditional", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::weighted, "weighted", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::approach1, "approach1", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::approach2, "approach2", RuleTraits::Follows::positions, RuleTraits::Reads::links, false},
    RuleTraits{Rule::exact, "exact", RuleTraits::Follows::positions, RuleTraits::Reads::corners, true},
    RuleTraits{Rule::wrapped, "wrapped", RuleTraits::Follows::positions, RuleTraits::Reads::children, true},
    RuleTraits{Rule::modal, "modal", RuleTraits::Follows::modes, RuleTraits::Reads::nothing, true},
    RuleTraits{Rule::skinned, "skinned", RuleTraits::Follows::bones, RuleTraits::Reads::nothing, false},
};

/// Is it an enumerator, not just some number?
constexpr bool is_rule(Rule rule) {
  return static_cast<std::size_t>(rule) < rule_table.size();
}
/// Of an enumerator.
constexpr const RuleTraits& traits(Rule rule) {
  return rule_table[static_cast<std::size_t>(rule)];
}
/// Does it cover by construction, whatever the other levels follow?
constexpr bool covers_alone(Rule rule) {
  return traits(rule).covers && traits(rule).reads != RuleTraits::Reads::children;
}
std::string_view name(Rule rule);
std::optional<Rule> rule_from_name(std::string_view name);
std::span<const Rule> all_rules();
/// Those that follow positions, which need nothing but a mesh and its tree.
std::span<const Rule> position_rules();

/// Questions that the papers leave open. Defaults are the literal readings, but for modal_bound.
struct RuleOptions {
  enum class Weights : std::uint8_t { uniform, inverse_distance, area };
  Weights approach1_weights = Weights::uniform;  ///< of linked vertices in a leaf's center
  enum class InnerCenter : std::uint8_t { children, linked_vertices };
  InnerCenter approach1_inner_center = InnerCenter::children;
  enum class InnerBoxes : std::uint8_t { child_spheres, child_centers };
  InnerBoxes approach2_inner_boxes = InnerBoxes::child_spheres;
  /// Of `wrapped`: the center moves with the mean of the children's, or from there to where it has to reach least,
  /// within a few percent: the smallest sphere around theirs.
  enum class WrappedCenter : std::uint8_t { children, smallest };
  WrappedCenter wrapped_center = WrappedCenter::children;
  /// Distances below this share of the radius are raised before ratios are taken (τ of D.4): 0 is the paper, which then
  /// skips vertices nearer than 1e-9 of the radius; 0.25 is robust.
  double distance_floor = 0.0;
  /// How `modal` bounds the corners of a node. shift: one displacement per mode and node, and how far corners stray
  /// from it, which is the paper. gradient: also with a linear field per mode and node, which follows strain and
  /// turning; per node the smaller sphere. Four times the work, and tighter by far where modes are smooth.
  enum class ModalBound : std::uint8_t { gradient, shift };
  ModalBound modal_bound = ModalBound::gradient;
};

/// One rule per level from the root; the last one serves all deeper levels.
struct UpdateOptions {
  std::vector<Rule> rules{Rule::exact};
  /// Radii of the other rules grow to what owned corners need, where that is more: every level then covers the surface,
  /// in the cheapest way that is sound. One more walk over the owned corners. Those of `wrapped` also grow to what
  /// children that have grown need.
  bool conservative = false;
  RuleOptions details{};
  Modes modes{};  ///< what update_modal() moves the body by; `modal` needs them
  Skin skin{};    ///< what update_skinned() moves the body by; `skinned` needs it
};
/// Do all levels cover the surface by construction, whatever it does?
bool covers(const UpdateOptions& options);
/// Do levels that follow this rule, among those of the options?
bool covers(const UpdateOptions& options, Rule rule);

/// Refused, or the work done: the same on every run; all 0 when nothing was changed.
struct [[nodiscard]] UpdateStatus : Status {
  std::size_t nodes_updated = 0;
  std::size_t vertices_read = 0;  ///< 0 when no level looks at points
  std::size_t cut_points_moved = 0;
  std::size_t points_tested = 0;  ///< vertices and corners that nodes looked at: measured or, by approach2, boxed
};

/// A status of a fault. index: of the vertex, coordinate or bone it is about.
inline UpdateStatus refused(Status::Code code, std::size_t index = 0) {
  UpdateStatus status;
  status.code = code;
  status.index = index;
  return status;
}

/// Degenerate cases met when the body was made.
struct BindReport {
  std::size_t void_spheres = 0;  ///< nodes that enclose no vertex (traditional, weighted): they follow a linked facet
  std::size_t unlinked_spheres = 0;    ///< leaves that touch no facet: linked to the nearest one (approaches 1 and 2)
  std::size_t degenerate_anchors = 0;  ///< nodes with fewer than four independent anchors: they follow their mean
  std::size_t carried_centers = 0;  ///< centers far outside the hull of their anchors: the remainder turns with these
  std::size_t corners_owned = 0;    ///< points tested by a leaf level of `exact`
};

/// The rule of a level: the last one serves all deeper levels.
Rule rule_of_level(std::span<const Rule> rules, std::size_t level);
/// "exact", or "exact on levels 0-1, approach2 on levels 2-3" when levels differ.
std::string describe_rules(std::span<const Rule> rules, std::size_t level_count);

}  // namespace morula
