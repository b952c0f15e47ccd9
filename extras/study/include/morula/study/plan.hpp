// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plan of a study, as plain values: bodies, their trees, motions and rules, of which all combinations are run, and the
// measurements.
//
//   morula::study::Plan plan;
//   plan.bodies = {{"limb", mesh}};
//   plan.sources = morula::study::sources_of(plan.bodies, morula::study::paper_methods());  // a tree by each method
//   plan.motions = morula::study::paper_motions();
//   plan.rules = {morula::Rule::approach2, morula::Rule::exact};
//   std::printf("%zu samples of each motion\n", plan.parameters().size());
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

/// A body of a study: its name and its mesh at rest.
struct NamedMesh {
  std::string name;
  Mesh mesh;
};

/// The way in which the spheres of one tree follow a motion, if all levels follow the same.
struct RuleKey {
  enum class Kind : std::uint8_t {
    update,   ///< all levels follow one rule
    rebuilt,  ///< all levels follow `exact`, and the tree is rebuilt while the body moves
    fresh     ///< a new tree is built at some samples, to compare updates with
  };
  Kind kind = Kind::update;
  Rule rule = Rule::exact;  ///< rule of the kind `update`

  RuleKey(Rule update_rule) : rule(update_rule) {}
  RuleKey(Kind other) : kind(other) {}
  bool operator==(const RuleKey& other) const {
    return kind == other.kind && (kind != Kind::update || rule == other.rule);
  }
};
inline constexpr RuleKey::Kind rebuilt = RuleKey::Kind::rebuilt;
inline constexpr RuleKey::Kind fresh = RuleKey::Kind::fresh;

/// The name: that of the rule, such as "approach1"; "rebuilt"; "fresh".
std::string name(const RuleKey& key);
/// The title for readers, in the spelling of the paper [garcia2005], such as "Approach 1"; for rules that the paper
/// lacks, the name.
std::string title(const RuleKey& key);
/// The keys of all rules that follow positions, then those of `rebuilt` and `fresh`.
std::vector<RuleKey> all_rule_keys();
/// The key with this name; no value if there is none.
std::optional<RuleKey> rule_key_from_name(std::string_view name);

/// The way in which spheres follow a motion, with a rule for each level and options.
struct FollowRule {
  std::string name;  ///< name in tables and files
  RuleKey::Kind kind = RuleKey::Kind::update;
  UpdateOptions options{};  ///< options of the kind `update`

  FollowRule() = default;
  FollowRule(RuleKey key);
  FollowRule(Rule rule) : FollowRule(RuleKey(rule)) {}
  FollowRule(RuleKey::Kind other) : FollowRule(RuleKey(other)) {}
  /// The key, if all levels follow the same rule; no value for a mix of rules.
  std::optional<RuleKey> key() const;
  /// The title of the key; for a mix, its name.
  std::string title() const;
};

/// A tree of one body: from a generator or from a file.
struct Source {
  std::size_t body = 0;             ///< index in Plan::bodies
  std::string method;               ///< name of the generator, or the method that the user declares for a file
  std::optional<Method> generator;  ///< generator that builds the tree; no value: the tree is read from `file`
  std::filesystem::path file;

  /// The generator with the name `method`, also for a file; no value if there is none.
  std::optional<Method> named() const { return method_from_name(method); }
};

/// The divisor of looseness.
enum class ErrorUnit : std::uint8_t {
  volume,  ///< the object's volume in that sample
  box,     ///< the volume of the object's box at rest, the paper's "object dimensions"
};

/// The vector that is added to the centers of a .sph file (ReadTreeOptions::sph_origin).
struct SphOrigin {
  enum class Kind : std::uint8_t {
    none,        ///< (0, 0, 0)
    box_center,  ///< the center of the mesh's bounding box
    point        ///< `point`
  };
  Kind kind = Kind::none;
  Vec3 point{0, 0, 0};  ///< vector of the kind `point`, mesh units

  /// The vector for a tree of this mesh.
  Vec3 of(const Mesh& mesh) const;
};
/// The name: "none", "bbox-center" or "x,y,z".
std::string name(const SphOrigin& origin);

/// The measurements of each tree in each sample, in addition to uncovered area and distance.
struct Measures {
  bool paper_grid = true;  ///< looseness on the paper's grid, which fills the box of the level's spheres
  bool lattice = true;  ///< looseness on one lattice for all samples, with Plan::resolution voxels along the diagonal
  bool protrusion = true;    ///< protrusion, for Plan::rules but not for Plan::mixes
  bool certificate = false;  ///< certificate, for the levels whose rules guarantee cover
  /// Number of timed repeats of each update; 0: no times. Updates run on one thread while nothing else runs; trees are
  /// built one at a time with all workers, and their times are taken also.
  int timed_updates = 0;
};

/// The input of run(): all sources are run with all motions and all rules.
struct Plan {
  std::vector<NamedMesh> bodies{};
  std::vector<Source> sources{};  ///< trees; those of the first body come first
  std::vector<Deformations> motions{};
  std::vector<FollowRule> rules{};
  std::vector<FollowRule> mixes{};       ///< more rules, run with the first source and all motions
  std::size_t samples = 13;              ///< number of samples of each motion, from rest to the full amount
  bool and_back = false;                 ///< true: the samples also lead back to rest (frame_parameters)
  std::vector<std::size_t> measured{};   ///< indices of the samples to measure; empty: all
  std::vector<std::size_t> of_levels{};  ///< levels to measure; empty: the last two, as in the paper
  Measures measures{};
  /// Number of voxels along the longest side of the paper's grid, and along the diagonal at rest of the fixed lattice.
  int resolution = 192;
  int branching = 8;   ///< BuildOptions::branching of all trees
  int depth = 3;       ///< BuildOptions::depth of all trees
  bool quick = false;  ///< a label of the result for small bodies and few samples, without effect on the run
  std::uint64_t seed = 1;
  /// Number of samples besides rest at which `fresh` builds the medial tree; the last one is at the full amount.
  std::size_t fresh_poses = 2;
  double protrusion_tolerance = 0.05;     ///< error of protrusion; share of a sphere's radius
  ErrorUnit unit = ErrorUnit::volume;     ///< divisor of looseness in figures and tables
  std::size_t needle_sides = 64;          ///< sides of needle_prism(), which shows void spheres; 0: none
  int cost_repeats = 9;                   ///< number of timed repeats for the table of costs
  std::vector<Source> press_sources{};    ///< additional trees that are only pressed
  std::vector<FollowRule> press_rules{};  ///< rules of the kind `update`; empty: no presses
  std::vector<double> press_amounts{0.001, 0.01, 0.02, 0.05};  ///< PressTruth::amount; shares of the diagonal at rest
  std::vector<std::size_t> press_budgets{100, 500, 2000, 10000};  ///< budgets of the queries in presses, pair tests
  Deformations press_pose{Bend{45.0, Axis::automatic}};           ///< deformation of pressed bodies
  SphOrigin sph_origin{};                                         ///< for all .sph files
  bool keep_trees = false;  ///< true: Result::model keeps the trees of all bodies; false: only of the first

  /// The parameter of each sample: 0 at rest, 1 at the full amount.
  std::vector<double> parameters() const;
  /// The indices of the samples at which `fresh` builds new trees of a source: rest, and the first one at the full
  /// amount. Medial trees, which Fig. 2 a and b of the paper show, get fresh_poses samples besides rest; other trees
  /// get one, because builds take most of a study's time.
  std::vector<std::size_t> fresh_samples(const Source& source) const;
  /// The indices of the samples to measure.
  std::vector<std::size_t> measured_samples() const;
  /// The levels to measure.
  std::vector<std::size_t> levels() const;

  /// The body of a source. source: index in `sources`.
  const NamedMesh& body_of(std::size_t source) const { return bodies[sources[source].body]; }
  /// The source of a press. source: index in `sources` followed by `press_sources`.
  const Source& pressed(std::size_t source) const {
    return source < sources.size() ? sources[source] : press_sources[source - sources.size()];
  }
  /// The index of the first source of a body whose method has the generator's name; no value if there is none.
  std::optional<std::size_t> find_source(std::size_t body, Method method) const;
  /// The index of the first rule with this key in `rules`; no value if there is none.
  std::optional<std::size_t> find_rule(const RuleKey& key) const;
};

/// The generators of the paper, in its order: medial, grid, hubbard, spawn.
std::vector<Method> paper_methods();
/// The motions of the paper: stretch to twice the length, twist by 180°, bend by 90°.
std::vector<Deformations> paper_motions();
/// Sources for all trees: every method on every body, body by body.
std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods);
/// Mixes for Plan::mixes: one of four rules on the inner levels with one of four on the last level, each without and
/// with UpdateOptions::conservative. depth: Plan::depth.
std::vector<FollowRule> rule_mixes(int depth);

/// The deformations as text, in the form of describe(): "stretch 2, twist 180".
std::string describe_all(const Deformations& deformations);
/// A closed prism of length 4 and diameter 1 along x, with this number of sides, at least 3. Its sides are not divided
/// along x, so they are long thin triangles.
Mesh needle_prism(std::size_t sides);

}  // namespace morula::study
