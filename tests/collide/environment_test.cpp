// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Hosts that have set the processor's floating-point environment, and callbacks that throw: the same bits as ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cfenv>
#include <morula/accuracy/measure.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/containment.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <stdexcept>
#include <support/meshes.hpp>
#include <thread>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace morula {
namespace {

/// Every bit of what was computed, in order, with a word on each.
class Record {
 public:
  void add(const std::string& what, double value) { add(what, std::bit_cast<std::uint64_t>(value)); }
  void add(const std::string& what, const Vec3& v) {
    add(what, v.x);
    add(what, v.y);
    add(what, v.z);
  }
  void add(const std::string& what, std::uint64_t bits) { entries_.emplace_back(what, bits); }

  std::string first_difference(const Record& other) const {
    if (entries_.size() != other.entries_.size()) return "more or fewer results";
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (entries_[i] != other.entries_[i]) return entries_[i].first + ", entry " + std::to_string(i);
    return {};
  }

 private:
  std::vector<std::pair<std::string, std::uint64_t>> entries_;
};

void record_contacts(Record& record, const Contacts& found) {
  record.add("contacts", found.contacts.size());
  for (const Contact& c : found.contacts) {
    record.add("contact point", c.point);
    record.add("contact normal", c.normal);
    record.add("contact depth", c.depth);
    record.add("contact bound", c.error_bound);
  }
  for (const Crossing& c : found.crossings) {
    record.add("crossing", c.segment.from);
    record.add("crossing", c.segment.to);
  }
}

/// A good part of the library, by its public doors. Inputs are made beforehand: inline arithmetic is the host's own.
struct Inputs {
  Mesh limb = sample_body("limb", 8), blob = sample_body("blob", 8), tiny = limb;
  std::vector<Vec3> bent = deform(limb, {Bend{90}}, 1.0);
  std::vector<Vec3f> narrow;
  std::vector<Vec3> points;
  RigidTransform transform = RigidTransform::from_axis({1, 2, 3}, 0.7, {0.3, 0.2, 0.1});
  Inputs() {
    for (const Vec3& p : bent) narrow.emplace_back(p);
    for (int k = 0; k < 20; ++k) points.push_back({0.1 * k - 1, 0.03 * k, 0.2});
    for (Vec3& p : tiny.positions) p = 1e-40 * p;
  }
};

Record everything(const Inputs& in, Workers& workers) {
  Record record;
  for (const Method method : {Method::octree, Method::grid, Method::medial, Method::optimized}) {
    BuildOptions options{.method = method, .branching = method == Method::octree ? 8 : 4, .depth = 2};
    if (method == Method::optimized) options.quality = Quality::draft;
    const CoveredTree model = build(in.limb, options, workers);
    record.add("tree by " + std::string(name(method)), tree_hash(model.tree));
    record.add("certificate", certify(model.cover, in.limb.positions, model.tree.spheres, workers).worst_excess);
    record.add("faults", validate(in.limb, model).size());
    for (const LevelMeasure& level : measure(in.limb, model.tree, {.grid = {.resolution = 24}}, workers)) {
      record.add("looseness", level.looseness.looseness.value_or(-1));
      record.add("uncovered_distance", level.coverage.uncovered_distance);
      record.add("bare", level.coverage.uncovered_area);
      record.add("protrusion", level.protrusion ? level.protrusion->worst : -1.0);
    }
  }
  try {
    const CoveredTree small = build(in.tiny, {.method = Method::octree, .depth = 2}, workers);
    Body body(in.tiny, small, {}, workers);
    record.add("tree of a tiny body", tree_hash(small.tree));
    record.add("a tiny body", body.hash());
  } catch (const std::invalid_argument& refused) {
    record.add(refused.what(), std::uint64_t{0});
  }
  record.add("deformed", mesh_hash({deform(in.limb, {Twist{90}, Stretch{1.5}}, 0.7), in.limb.facets}));

  const CoveredTree limb = build(in.limb, {.method = Method::octree, .depth = 2}, workers);
  const CoveredTree blob = build(in.blob, {.method = Method::octree, .depth = 2}, workers);
  for (const Rule rule : position_rules()) {
    Body body(in.limb, limb, {.rules = {rule}, .details = {}}, workers);
    record.add("bound body, " + std::string(name(rule)), body.hash());
    record.add("update", static_cast<std::uint64_t>(static_cast<bool>(body.update(in.bent, workers))));
    record.add("updated body, " + std::string(name(rule)), body.hash());
    record.add("from floats", static_cast<std::uint64_t>(static_cast<bool>(body.update(in.narrow, workers))));
    record.add("updated body, " + std::string(name(rule)), body.hash());
    for (const Sphere& s : body.current_tree().spheres) record.add("sphere in the mesh's coordinates", s.center);
  }
  RebuiltBody rebuilt(in.limb, limb, {.rebuild_every = 1, .min_improvement = -1e9, .thread = RebuildThread::caller},
                      workers);
  for (int frame = 0; frame < 4; ++frame) {
    EXPECT_TRUE(rebuilt.update(in.bent, workers));
    record.add("rebuilt", rebuilt.body().hash());
  }

  Body body_a(in.limb, limb, {}, workers), body_b(in.blob, blob, {}, workers);
  EXPECT_TRUE(body_a.update(in.bent, workers));
  Collider a(in.limb, body_a), b(in.blob, body_b);
  a.set_positions(in.bent);
  b.set_transform(in.transform);
  record.add("overlap", std::uint64_t{overlap(a, b)});
  record_contacts(record, collide(a, b, {.surfaces = true, .find_crossings = true}));
  record_contacts(record, collide(a, b, {.budget = 50, .surfaces = true}));
  CrossingQuery crossed;
  EXPECT_TRUE(crossed.run(a, b));
  record.add("crossings", crossed.pairs().size());
  for (const RigidTransform& place : {in.transform, RigidTransform{.translation = {5, 1, 2}}}) {
    b.set_transform(place);
    const DistanceBounds bounds = distance(a, b);
    record.add("distance below", bounds.lower);
    record.add("distance above", bounds.upper);
    record.add("distance at", bounds.a.point);
  }
  const Touch touched = touch(a, Capsule{{0, 0, 0}, {1, 1, 1}, 0.3}, {.nearest = true});
  record.add("touch", touched.deepest->depth);
  record.add("touch below", touched.lower);
  const RayHit hit = first_hit(a, {.origin = {0.1, 0.05, -9}, .direction = {0.01, 0.02, 1}});
  record.add("hit", hit.first->t);
  InsideQuery inside(a);
  record.add("winding", static_cast<std::uint64_t>(inside.locate({0.01, 0.02, 0.03}).winding));
  record.add("probe", inside.probe({{0.01, 0.02, 0.03}, 0.1}).depth);
  const SignedDistance signed_distance(in.limb, workers);
  for (const Vec3& p : in.points) record.add("signed distance", signed_distance.at(p).distance);
  return record;
}

struct Environment {
  std::string name;
  std::function<void()> set;
};

std::vector<Environment> environments() {
  std::vector<Environment> all{{"upward", [] { std::fesetround(FE_UPWARD); }},
                               {"downward", [] { std::fesetround(FE_DOWNWARD); }},
                               {"toward zero", [] { std::fesetround(FE_TOWARDZERO); }}};
#if defined(__SSE2__)
  all.push_back({"flush to zero, denormals are zero", [] { _mm_setcsr(_mm_getcsr() | 0x8040); }});
  all.push_back({"both, and upward", [] { _mm_setcsr(_mm_getcsr() | 0xc040); }});
  all.push_back({"traps on invalid, overflow, division by zero", [] { _mm_setcsr(0x1f80 & ~0x0680u); }});
#endif
  return all;
}

/// What tells one environment from another, by arithmetic alone.
std::uint64_t fingerprint() {
  volatile double one = 1, three = 3, ten = 10, least = 0x1p-1074, half = 0.5, normal = 0x1p-1022;
  // To nearest, a third is rounded toward zero and a tenth away from it.
  const double results[] = {one / three, -one / three, one / ten, least * one, normal * half, least + least};
  std::uint64_t hash = 0;
  for (const double r : results) hash = hash * 1000003 + std::bit_cast<std::uint64_t>(r);
#if defined(__SSE2__)
  hash += _mm_getcsr() & 0xffc0u;
#endif
  return hash;
}

class FloatEnvironment : public testing::TestWithParam<std::size_t> {};

TEST_P(FloatEnvironment, changes_no_bit_and_is_left_as_it_was_found) {
  const Inputs inputs;
  Workers before(3);
  const Record expected = everything(inputs, serial_workers());
  std::fenv_t usual;
  ASSERT_EQ(std::fegetenv(&usual), 0);
  const std::uint64_t standard = fingerprint();
  const Environment environment = environments()[GetParam()];
  environment.set();
  const std::uint64_t own = fingerprint();
  std::string difference[4];
  bool kept = true;
  const auto judge = [&](std::size_t k, Workers& workers) {
    difference[k] = everything(inputs, workers).first_difference(expected);
    kept = kept && fingerprint() == own;
  };
  judge(0, serial_workers());
  judge(1, before);  // threads that were made before the host changed its mind
  {
    Workers inside(3);  // threads that inherit it
    judge(2, inside);
  }
  Workers host(
      [&](std::size_t count, ChunkFunction chunk) {
        std::thread other([&] {
          environment.set();
          for (std::size_t i = 0; i < count; i += 2) chunk(i);
        });
        for (std::size_t i = 1; i < count; i += 2) chunk(i);
        other.join();
      },
      2);
  judge(3, host);
  std::fesetenv(&usual);
  EXPECT_NE(own, standard) << environment.name << " was not set: the test shows nothing";
  for (const std::string& found : difference) EXPECT_EQ(found, "") << environment.name;
  EXPECT_TRUE(kept) << environment.name;
}

std::string environment_name(const testing::TestParamInfo<std::size_t>& tested) {
  std::string words = environments()[tested.param].name;
  words.erase(std::remove(words.begin(), words.end(), ','), words.end());
  std::replace(words.begin(), words.end(), ' ', '_');
  return words;
}
INSTANTIATE_TEST_SUITE_P(EachOf, FloatEnvironment, testing::Range(std::size_t{0}, environments().size()),
                         environment_name);

struct Thrown {};

TEST(ThrowingCallbacks, end_a_build_and_leave_everything_usable) {
  const Mesh mesh = sample_body("limb", 8);
  const BuildOptions options{.method = Method::optimized, .branching = 4, .depth = 2, .quality = Quality::draft};
  const std::uint64_t expected = tree_hash(build(mesh, options).tree);
  Workers pool(3);
  int most = 1000;
  const auto build_until = [&](int last, Workers& workers) {
    BuildOptions throwing = options;
    int calls = 0;
    throwing.progress = [&](const BuildProgress&) {
      if (++calls > last) throw Thrown();
    };
    build(mesh, throwing, workers);
    return calls;
  };
  most = build_until(most, serial_workers());
  ASSERT_GE(most, 2);
  for (Workers* workers : {&serial_workers(), &pool}) {
    for (int last = 0; last < std::min(most, 6); ++last) {
      // With a pool there may be fewer calls, but one at least.
      if (last == 0 || workers == &serial_workers()) {
        EXPECT_THROW(build_until(last, *workers), Thrown) << last;
      }
    }
    EXPECT_EQ(tree_hash(build(mesh, options, *workers).tree), expected);
  }
  int runs = 0;
  Workers host(
      [&](std::size_t count, ChunkFunction chunk) {
        if (++runs == 1) throw Thrown();
        for (std::size_t i = 0; i < count; ++i) chunk(i);
      },
      2);
  EXPECT_THROW(build(mesh, options, host), Thrown);
  EXPECT_EQ(tree_hash(build(mesh, options, host).tree), expected);
}

TEST(ThrowingCallbacks, end_a_query_which_then_answers_as_ever) {
  const Mesh mesh = sample_body("limb", 8);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 3});
  Body body_a(mesh, model), body_b(mesh, model);
  Collider a(mesh, body_a), b(mesh, body_b);
  b.set_transform(RigidTransform::from_axis({0, 0, 1}, 1.0, {0, 0, 0.3}));
  for (const CollideOptions& usual :
       {CollideOptions{.surfaces = true, .find_crossings = true}, CollideOptions{.budget = 400, .surfaces = true}}) {
    Record expected;
    ContactQuery fresh(usual);
    fresh.add(a, b);
    ASSERT_TRUE(fresh.start());
    record_contacts(expected, fresh.contacts());
    ContactQuery query(usual);
    query.add(a, b);
    int most = 0;
    const auto start_until = [&](int last) {
      int calls = 0;
      CollideOptions throwing = usual;
      throwing.refresh_children = [&](const Collider&, std::uint32_t) -> bool {
        if (++calls > last) throw Thrown();
        return true;
      };
      query.set_options(throwing);
      ASSERT_TRUE(query.start());
      most = calls;
    };
    start_until(1000000);
    ASSERT_GE(most, 5);
    for (int last = 0; last < most; last += 1 + most / 20) {
      EXPECT_THROW(start_until(last), Thrown) << last;
      query.set_options(usual);
      ASSERT_TRUE(query.start());
      Record found;
      record_contacts(found, query.contacts());
      EXPECT_EQ(found.first_difference(expected), "") << last;
    }
  }
  CollideOptions timed{.budget = std::chrono::seconds(1)};
  timed.clock = []() -> std::chrono::nanoseconds { throw Thrown(); };
  ContactQuery query(timed);
  query.add(a, b);
  EXPECT_THROW(static_cast<void>(query.start()), Thrown);
  query.set_options({});
  EXPECT_TRUE(query.start());
  EXPECT_TRUE(query.contacts().finished);
}

}  // namespace
}  // namespace morula
