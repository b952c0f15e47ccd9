// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plan of a study: bodies × trees × motions × rules, and their measurements, as plain values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/study/own.hpp>
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

/// A rule on all levels; or `exact` with rebuilds; or a new tree at sampled poses, as a bound for updates; or one's
/// own.
struct RuleKey {
  enum class Kind : std::uint8_t { update, rebuilt, fresh, own };
  Kind kind = Kind::update;
  Rule rule = Rule::exact;  ///< rule of `update`
  std::string own{};        ///< name of `own`

  RuleKey(Rule update_rule) : rule(update_rule) {}
  RuleKey(Kind other) : kind(other) {}
  RuleKey(const OwnRule& rule_of_ones_own) : kind(Kind::own), own(rule_of_ones_own.name) {}
  bool operator==(const RuleKey& other) const {
    return kind == other.kind && (kind != Kind::update || rule == other.rule) && own == other.own;
  }
};
inline constexpr RuleKey::Kind rebuilt = RuleKey::Kind::rebuilt;
inline constexpr RuleKey::Kind fresh = RuleKey::Kind::fresh;

/// The name: "approach1", "rebuilt", "fresh".
std::string name(const RuleKey& key);
/// The title in the paper's spelling, such as "Approach 1"; Morula's own rules by name.
std::string title(const RuleKey& key);
/// All rules that follow positions, `rebuilt`, `fresh`.
std::vector<RuleKey> all_rule_keys();
std::optional<RuleKey> rule_key_from_name(std::string_view name);

/// The way spheres follow a motion.
struct FollowRule {
  std::string name;
  RuleKey::Kind kind = RuleKey::Kind::update;
  UpdateOptions options{};  ///< options of `update`
  std::shared_ptr<const OwnRule> own{};

  FollowRule() = default;
  FollowRule(std::shared_ptr<const OwnRule> rule) : name(rule->name), kind(RuleKey::Kind::own), own(std::move(rule)) {}
  FollowRule(RuleKey key);
  FollowRule(Rule rule) : FollowRule(RuleKey(rule)) {}
  FollowRule(RuleKey::Kind other) : FollowRule(RuleKey(other)) {}
  /// The key of a single rule; no value for a mix of rules.
  std::optional<RuleKey> key() const;
  /// title() of its key, or the name of a mix.
  std::string title() const;
};

/// A tree of one body: from a generator or from a file.
struct Source {
  std::size_t body = 0;
  std::string method;  ///< the generator's name, or the declared method of a file
  std::optional<Method> generator;
  std::filesystem::path file{};
  std::shared_ptr<const OwnGenerator> own{};

  /// False for a tree from a file.
  bool can_build() const { return generator.has_value() || own != nullptr; }
  /// The generator with this name, also for a file.
  std::optional<Method> named() const { return method_from_name(method); }
};

/// The divisor of looseness.
enum class ErrorUnit : std::uint8_t {
  volume,  ///< the object's volume in that sample
  box,     ///< the volume of the object's box at rest: "object dimensions"
};

/// The origin of the centers of a .sph file.
struct SphOrigin {
  enum class Kind : std::uint8_t { none, box_center, point };
  Kind kind = Kind::none;
  Vec3 point{0, 0, 0};  ///< the origin for `point`

  Vec3 of(const Mesh& mesh) const;
};
/// The name: "none", "bbox-center" or "x,y,z".
std::string name(const SphOrigin& origin);

/// The measurements of every sphere set, in addition to its uncovered area and distance.
struct Measures {
  bool paper_grid = true;    ///< looseness on the paper's grid
  bool lattice = true;       ///< looseness on one lattice for all samples, `resolution` voxels along the rest diagonal
  bool protrusion = true;    ///< protrusion for `rules`, not for `mixes`
  bool certificate = false;  ///< certificate in every sample, for the levels whose rules guarantee cover
  /// Number of timed repeats of each update, on one thread while nothing else runs; trees are then built one at a time
  /// with all workers, and timed. 0: no times.
  int timed_updates = 0;
};

struct Plan {
  std::vector<NamedMesh> bodies{};
  std::vector<Source> sources{};  ///< trees of the first body first
  std::vector<Deformations> motions{};
  std::vector<FollowRule> rules{};
  std::vector<FollowRule> mixes{};       ///< rules on the first source and all motions
  std::size_t samples = 13;              ///< samples of each motion, from rest to the full amount
  bool and_back = false;                 ///< samples also lead back to rest: frame_parameters()
  std::vector<std::size_t> measured{};   ///< samples to measure; empty: all
  std::vector<std::size_t> of_levels{};  ///< levels to measure; empty: the last two, as in the paper
  Measures measures{};
  int resolution = 192;  ///< resolution of the paper's grid, and of the fixed lattice per diagonal at rest
  int branching = 8;
  int depth = 3;
  bool quick = false;  ///< small bodies, few samples: a label of the result, without effect on the run
  std::uint64_t seed = 1;
  std::size_t fresh_poses = 2;  ///< poses besides rest, for the medial tree; the last at the full amount
  double protrusion_tolerance = 0.05;
  ErrorUnit unit = ErrorUnit::volume;
  std::size_t needle_sides = 64;  ///< sides of a prism of long thin triangles, for void spheres; 0: none
  int cost_repeats = 9;
  std::vector<Source> press_sources{};                            ///< additional trees that are only pressed
  std::vector<FollowRule> press_rules{};                          ///< rules of kind `update`; empty: no presses
  std::vector<double> press_amounts{0.001, 0.01, 0.02, 0.05};     ///< shares of the diagonal at rest
  std::vector<std::size_t> press_budgets{100, 500, 2000, 10000};  ///< pair tests
  Deformations press_pose{Bend{45.0, Axis::automatic}};
  SphOrigin sph_origin{};
  bool keep_trees = false;           ///< true: keep the trees of all bodies, not only of the first
  std::vector<OwnMetric> metrics{};  ///< measured in addition to `measures`
  bool variants = false;             ///< true: also every reading of the paper's ambiguous sentences (variants.hpp)
  bool paper_amounts = false;        ///< true: also the amounts of the paper's axes (amounts.hpp)

  /// Parameters of the samples: 0 at rest, 1 at the full amount; one per sample.
  std::vector<double> parameters() const;
  /// The samples at which new trees are built, rest first. Builds take most of a study's time, so only the trees of
  /// Fig. 2 a and b get more samples than the full amount.
  std::vector<std::size_t> fresh_samples(const Source& source) const;
  /// The samples to measure, ascending.
  std::vector<std::size_t> measured_samples() const;
  std::vector<std::size_t> levels() const;

  const NamedMesh& body_of(std::size_t source) const { return bodies[sources[source].body]; }
  /// An entry of `sources`, then of `press_sources`.
  const Source& pressed(std::size_t source) const {
    return source < sources.size() ? sources[source] : press_sources[source - sources.size()];
  }
  /// The first source of a body with the generator's name.
  std::optional<std::size_t> find_source(std::size_t body, Method method) const;
  std::optional<std::size_t> find_rule(const RuleKey& key) const;
};

/// The generators of the paper, in its order: medial, grid, hubbard, spawn.
std::vector<Method> paper_methods();
/// The motions of the paper: stretch to twice the length, twist by 180°, bend by 90°.
std::vector<Deformations> paper_motions();
/// Every method on every body.
std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods);
/// The tree of a generator of one's own.
Source own_source(std::size_t body, std::shared_ptr<const OwnGenerator> generator);
/// Every rule on the inner levels with every rule on the leaves, plain and conservative.
std::vector<FollowRule> rule_mixes(int depth);

/// The deformations in the form of describe(), such as "stretch 2, twist 180"; also the option of morula deform.
std::string describe_all(const Deformations& deformations);
/// A prism of many sides without subdivision along its axis: its sides are long thin triangles.
Mesh needle_prism(std::size_t sides);

}  // namespace morula::study
