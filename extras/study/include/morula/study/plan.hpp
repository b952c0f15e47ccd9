// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plan of a study: bodies × trees × motions × rules, and what is measured of them, as plain values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/update/rules.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

/// A rule on all levels; or `exact` with rebuilding; or a tree built anew at sampled poses, which no update can be
/// expected to beat.
struct RuleKey {
  enum class Kind : std::uint8_t { update, rebuilt, fresh };
  Kind kind = Kind::update;
  Rule rule = Rule::exact;  ///< of `update`

  RuleKey(Rule update_rule) : rule(update_rule) {}
  RuleKey(Kind other) : kind(other) {}
  bool operator==(const RuleKey& other) const {
    return kind == other.kind && (kind != Kind::update || rule == other.rule);
  }
};
inline constexpr RuleKey::Kind rebuilt = RuleKey::Kind::rebuilt;
inline constexpr RuleKey::Kind fresh = RuleKey::Kind::fresh;

/// "approach1", "rebuilt", "fresh".
std::string name(const RuleKey& key);
/// "Approach 1", as the paper writes it; our own rules by name.
std::string title(const RuleKey& key);
/// All rules that follow positions, `rebuilt`, `fresh`.
std::vector<RuleKey> all_rule_keys();
std::optional<RuleKey> rule_key_from_name(std::string_view name);

/// How spheres follow.
struct FollowRule {
  std::string name;
  RuleKey::Kind kind = RuleKey::Kind::update;
  UpdateOptions options{};  ///< of `update`

  FollowRule() = default;
  FollowRule(RuleKey key);
  FollowRule(Rule rule) : FollowRule(RuleKey(rule)) {}
  FollowRule(RuleKey::Kind other) : FollowRule(RuleKey(other)) {}
  /// What it is one for; nothing of a mix of rules.
  std::optional<RuleKey> key() const;
  /// title() of its key, or the name of a mix.
  std::string title() const;
};

/// A tree of one body: of a generator, or from a file.
struct Source {
  std::size_t body = 0;
  std::string method;  ///< the generator's name, or what a file is said to be of
  std::optional<Method> generator;
  std::filesystem::path file;

  /// The generator that the name is one of; also of a file's.
  std::optional<Method> named() const { return method_from_name(method); }
};

/// What looseness is divided by.
enum class ErrorUnit : std::uint8_t {
  volume,  ///< the object's volume in that sample
  box,     ///< the volume of the object's box at rest: "object dimensions"
};

/// What the centers of a .sph file are measured from.
struct SphOrigin {
  enum class Kind : std::uint8_t { none, box_center, point };
  Kind kind = Kind::none;
  Vec3 point{0, 0, 0};  ///< of `point`

  Vec3 of(const Mesh& mesh) const;
};
/// "none", "bbox-center" or "x,y,z".
std::string name(const SphOrigin& origin);

/// What is measured of every sphere set that is looked at, beside its uncovered area and gap, which always are.
struct Measures {
  bool paper_grid = true;    ///< looseness on the paper's grid
  bool lattice = true;       ///< looseness on one lattice for all samples, `resolution` voxels along the rest diagonal
  bool protrusion = true;    ///< of `rules`, not of `mixes`
  bool certificate = false;  ///< in every sample, of the levels whose rules promise cover
  /// Each update so often, on one thread while nothing else runs; trees are built one at a time with all workers, and
  /// timed. 0: no times.
  int timed_updates = 0;
};

struct Plan {
  std::vector<NamedMesh> bodies{};
  std::vector<Source> sources{};  ///< those of the first body first
  std::vector<Deformations> motions{};
  std::vector<FollowRule> rules{};
  std::vector<FollowRule> mixes{};       ///< on the first source and all motions
  std::size_t samples = 13;              ///< of each motion, from rest to the full amount
  bool and_back = false;                 ///< and back to rest again: frame_parameters()
  std::vector<std::size_t> measured{};   ///< samples that are measured; none: all
  std::vector<std::size_t> of_levels{};  ///< levels that are measured; none: the last two, as in the paper
  Measures measures{};
  int resolution = 192;  ///< of the paper's grid; of the fixed lattice, per diagonal at rest
  int branching = 8;
  int depth = 3;
  bool quick = false;  ///< small bodies, few samples: what is said of the result, not what is done
  std::uint64_t seed = 1;
  std::size_t fresh_poses = 2;  ///< beside rest, of the medial tree; the last at the full amount
  double protrusion_tolerance = 0.05;
  ErrorUnit unit = ErrorUnit::volume;
  std::size_t needle_sides = 64;  ///< of a prism of long thin triangles, for void spheres; 0: none
  int cost_repeats = 9;
  std::vector<Source> press_sources{};                            ///< beside `sources`: trees that are only pressed
  std::vector<FollowRule> press_rules{};                          ///< of kind `update`; none: nothing is pressed
  std::vector<double> press_amounts{0.001, 0.01, 0.02, 0.05};     ///< shares of the diagonal at rest
  std::vector<std::size_t> press_budgets{100, 500, 2000, 10000};  ///< pair tests
  Deformations press_pose{Bend{45.0, Axis::automatic}};
  SphOrigin sph_origin{};
  bool keep_trees = false;  ///< of all bodies, not of the first alone

  /// 0 at rest, 1 at the full amount; one per sample.
  std::vector<double> parameters() const;
  /// The samples at which trees are built anew, rest first. Builds take the most time of a study, so only the trees of
  /// Fig. 2 a and b get more than the full amount.
  std::vector<std::size_t> fresh_samples(const Source& source) const;
  /// Those that are measured, ascending.
  std::vector<std::size_t> measured_samples() const;
  std::vector<std::size_t> levels() const;

  const NamedMesh& body_of(std::size_t source) const { return bodies[sources[source].body]; }
  /// `sources`, then `press_sources`.
  const Source& pressed(std::size_t source) const {
    return source < sources.size() ? sources[source] : press_sources[source - sources.size()];
  }
  /// The first source of a body that is named after the generator.
  std::optional<std::size_t> find_source(std::size_t body, Method method) const;
  std::optional<std::size_t> find_rule(const RuleKey& key) const;
};

/// The generators of the paper, in its order: medial, grid, hubbard, spawn.
std::vector<Method> paper_methods();
/// Its motions: stretch to twice the length, twist by 180°, bend by 90°.
std::vector<Deformations> paper_motions();
/// Every method on every body.
std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods);
/// Every rule on the inner levels with every rule on the leaves, as it is and made to cover.
std::vector<FollowRule> rule_mixes(int depth);

/// "stretch 2, twist 180": as describe() says it; it is also the option of morula deform.
std::string describe_all(const Deformations& deformations);
/// A prism of many sides and no division along: its sides are long thin triangles.
Mesh needle_prism(std::size_t sides);

}  // namespace morula::study
