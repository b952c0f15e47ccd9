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

/// A body of a study: its name and its mesh at rest.
struct NamedMesh {
  std::string name;
  Mesh mesh;
};

/// A motion of one body, as frames. Its samples are frames at equal steps, the mesh at rest first.
struct RecordedMotion {
  std::string name;
  std::size_t body = 0;
  std::vector<std::vector<Vec3>> frames;
};

/// A body with the trees of one seed: a verdict is about one trial, and joined over all.
struct Trial {
  std::size_t body = 0;
  std::uint64_t seed = 1;
  auto operator<=>(const Trial&) const = default;
};

/// A rule on all levels; or `exact` with rebuilds; or a new tree at sampled poses, as a bound for updates; or one's
/// own rule.
struct RuleKey {
  enum class Kind : std::uint8_t {
    update,   ///< all levels follow one rule
    rebuilt,  ///< all levels follow `exact`, and the tree is rebuilt while the body moves
    fresh,    ///< a new tree is built at some samples, to compare updates with
    own       ///< an OwnRule
  };
  Kind kind = Kind::update;
  Rule rule = Rule::exact;  ///< rule of the kind `update`
  std::string own{};        ///< name of the kind `own`

  RuleKey(Rule update_rule) : rule(update_rule) {}
  RuleKey(Kind other) : kind(other) {}
  RuleKey(const OwnRule& rule_of_ones_own) : kind(Kind::own), own(rule_of_ones_own.name) {}
  bool operator==(const RuleKey& other) const {
    return kind == other.kind && (kind != Kind::update || rule == other.rule) && own == other.own;
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
  UpdateOptions options{};               ///< options of the kind `update`
  std::shared_ptr<const OwnRule> own{};  ///< rule of the kind `own`

  FollowRule() = default;
  FollowRule(std::shared_ptr<const OwnRule> rule) : name(rule->name), kind(RuleKey::Kind::own), own(std::move(rule)) {}
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
  std::size_t body = 0;
  std::string method;  ///< the generator's name, or the declared method of a file
  std::optional<Method> generator{};
  std::filesystem::path file{};
  std::optional<std::uint64_t> seed{};        ///< no value: all seeds give this tree, and all trials share it
  std::shared_ptr<const OwnGenerator> own{};  ///< generator of one's own, in place of `generator`

  /// False for a tree from a file.
  bool can_build() const { return generator.has_value() || own != nullptr; }
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
  bool paper_grid = true;    ///< looseness on the paper's grid
  bool half_grid = false;    ///< also with half its resolution, to know whether a verdict depends on it
  bool lattice = true;       ///< looseness on one lattice for all samples, `resolution` voxels along the rest diagonal
  bool protrusion = true;    ///< protrusion for `rules`, not for `mixes`
  bool certificate = false;  ///< certificate in every sample, for the levels whose rules guarantee cover
  /// Number of timed repeats of each update, on one thread while nothing else runs; trees are then built one at a time
  /// with all workers, and timed. 0: no times.
  int timed_updates = 0;
};

/// The parts that trials of seeds after the first repeat as well. Claims that need a part are decided in the trials
/// that have it.
struct LaterSeeds {
  bool lattice = false;
  bool protrusion = false;
  bool half_grid = false;
  bool fresh = false;    ///< cells of the rule `fresh`
  bool rebuilt = false;  ///< cells of the rule `rebuilt`
  bool presses = false;  ///< also the trees that are only pressed
};

struct Plan {
  std::vector<NamedMesh> bodies{};
  std::vector<Source> sources{};  ///< trees; those of the first body come first
  std::vector<Deformations> motions{};
  std::vector<RecordedMotion> recorded{};  ///< further motions, numbered after `motions`
  std::vector<FollowRule> rules{};
  std::vector<FollowRule> mixes{};      ///< rules on the first source and all motions
  std::size_t samples = 13;             ///< samples of each motion, from rest to the full amount
  bool and_back = false;                ///< samples also lead back to rest: frame_parameters()
  std::vector<std::size_t> measured{};  ///< samples to measure; empty: all
  /// Samples that decide claims, each in `measured`; trials of later seeds measure only these. Empty: all measured
  /// ones.
  std::vector<std::size_t> decisive{};
  std::vector<std::size_t> of_levels{};  ///< levels to measure; empty: the last two, as in the paper
  Measures measures{};
  int resolution = 192;  ///< resolution of the paper's grid, and of the fixed lattice per diagonal at rest
  int branching = 8;
  int depth = 3;
  bool quick = false;  ///< small bodies, few samples: a label of the result, without effect on the run
  /// Seeds of the generators: each body has a trial for each.
  std::vector<std::uint64_t> seeds{1};
  LaterSeeds later{};
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

  /// The parameter of each sample: 0 at rest, 1 at the full amount.
  std::vector<double> parameters() const;
  /// The indices of the samples at which `fresh` builds new trees of a source: rest, and the first one at the full
  /// amount. Medial trees, which Fig. 2 a and b of the paper show, get fresh_poses samples besides rest; other trees
  /// get one, because builds take most of a study's time.
  std::vector<std::size_t> fresh_samples(const Source& source) const;
  /// The indices of the samples to measure.
  std::vector<std::size_t> measured_samples() const;
  std::vector<std::size_t> measured_samples(const Source& source) const;
  /// The samples that decide claims, ascending: measured in every trial.
  std::vector<std::size_t> decisive_samples() const;
  std::vector<std::size_t> levels() const;

  /// True for trees of the first seed, and for those without one.
  bool is_first_seed(const Source& source) const { return !source.seed || *source.seed == seeds.front(); }
  /// True if the tree follows motions by the rule.
  bool has_cells(const Source& source, const FollowRule& rule) const;
  /// The measures of a tree: fewer for later seeds.
  Measures measures_of(const Source& source) const;
  /// Each body with each seed, bodies in order; a body whose trees have no seed makes one trial.
  std::vector<Trial> trials() const;
  bool is_of(const Source& source, const Trial& trial) const {
    return source.body == trial.body && (!source.seed || *source.seed == trial.seed);
  }
  /// Places of the trial's trees in `sources`.
  std::vector<std::size_t> sources_of(const Trial& trial) const;

  std::size_t motion_count() const { return motions.size() + recorded.size(); }
  /// describe_all() of a motion, or the name of a recorded one.
  std::string motion_name(std::size_t motion) const;

  const NamedMesh& body_of(std::size_t source) const { return bodies[sources[source].body]; }
  /// The source of a press. source: index in `sources` followed by `press_sources`.
  const Source& pressed(std::size_t source) const {
    return source < sources.size() ? sources[source] : press_sources[source - sources.size()];
  }
  /// The index of the first source of a body whose method has the generator's name; no value if there is none.
  std::optional<std::size_t> find_source(std::size_t body, Method method) const;
  std::optional<std::size_t> find_source(const Trial& trial, Method method) const;
  std::optional<std::size_t> find_rule(const RuleKey& key) const;
};

/// The generators of the paper, in its order: medial, grid, hubbard, spawn.
std::vector<Method> paper_methods();
/// The motions of the paper: stretch to twice the length, twist by 180°, bend by 90°.
std::vector<Deformations> paper_motions();
/// True if trees of the method depend on the seed.
bool is_random(Method method);
/// Every method on every body, without seeds.
std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods);
/// Every method on every body with every seed; methods that are not random once.
std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods,
                               const std::vector<std::uint64_t>& seeds);
/// The tree of a generator of one's own.
Source own_source(std::size_t body, std::shared_ptr<const OwnGenerator> generator);
/// Every rule on the inner levels with every rule on the leaves, plain and conservative.
std::vector<FollowRule> rule_mixes(int depth);

/// The deformations as text, in the form of describe(): "stretch 2, twist 180".
std::string describe_all(const Deformations& deformations);
/// A closed prism of length 4 and diameter 1 along x, with this number of sides, at least 3. Its sides are not divided
/// along x, so they are long thin triangles.
Mesh needle_prism(std::size_t sides);

}  // namespace morula::study
