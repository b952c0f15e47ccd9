// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Calls that end in the middle: whatever an object calls may throw at any time, an Interrupt may, and memory may be
// missing. The object is empty afterwards and says so, and the next call gives what a new object gives. A callback that
// calls its own object is refused, and the call that it is part of is none the worse. One that moves what the call
// reads ends it as an exception does.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/pair_walk.hpp>
#include <morula/collide/penetration.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/parallel/interrupt.hpp>
#include <morula/surface/obstacles.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <mutex>
#include <ostream>
#include <support/allocations.hpp>
#include <utility>

namespace morula {
namespace {

struct Thrown {};
using Numbers = std::vector<double>;
using Code = Status::Code;

/// What all callbacks of an object call. None: nothing.
using Hook = std::function<void()>;

/// Two bodies that cross, at rest, and surfaces of the same.
struct World {
  Mesh mesh_a = sample_body("blob", 6), mesh_b = moved(mesh_a, {0.6, 0.1, 0});
  CoveredTree built_a = build(mesh_a, {.method = Method::octree, .depth = 2});
  CoveredTree built_b = build(mesh_b, {.method = Method::octree, .depth = 2});
  Body body_a{mesh_a, built_a}, body_b{mesh_b, built_b};
  Collider a{mesh_a, body_a}, b{mesh_b, body_b};
  SurfaceTree surface_a{mesh_a}, surface_b{mesh_b};
  std::vector<Vec3> later = moved(mesh_a, {0.2, 0, 0}).positions;
  Obstacle ball = Sphere{{0.7, 0, 0}, 0.4};

  static Mesh moved(Mesh mesh, const Vec3& by) {
    for (Vec3& p : mesh.positions) p += by;
    return mesh;
  }
  World() { EXPECT_TRUE(surface_a.update(mesh_a.positions, later)); }
  /// As it was made, whatever was updated and placed since.
  void restore() {
    EXPECT_TRUE(body_a.update(mesh_a.positions));
    EXPECT_TRUE(body_b.update(mesh_b.positions));
    for (Collider* collider : {&a, &b}) collider->set_transform({});
    EXPECT_TRUE(surface_a.update(mesh_a.positions, later));
    EXPECT_TRUE(surface_b.update(mesh_b.positions));
  }
};
std::unique_ptr<World>& only_world() {
  static auto one = std::make_unique<World>();
  return one;
}
World& world() {
  return *only_world();
}

/// An object under test.
struct Subject {
  virtual ~Subject() = default;
  /// For the calls that follow. With `short_budget` they do some of the work only.
  virtual void set(const Hook& hook, bool short_budget) = 0;
  virtual Status run(Workers& workers) = 0;
  /// Another way to begin or to go on; by number, until there is none.
  virtual std::size_t ways_to_go_on() const { return 0; }
  virtual Status go_on(std::size_t, Workers&) { return {}; }
  /// Does it read surfaces, or else colliders?
  virtual bool reads_surfaces() const { return false; }
  /// Does it read the second body or surface?
  virtual bool reads_b() const { return true; }
  virtual bool has_callbacks() const { return true; }
  virtual bool asks_interrupts() const { return true; }
  /// All that it tells of what was found.
  virtual Numbers results() const = 0;
  /// Calls every function of itself that changes it; each is to be refused. Returns how many were not.
  virtual int call_itself() = 0;
};

template <class Call>
int is_not_refused(const Call& call) {
  if constexpr (std::is_convertible_v<decltype(call()), Status>) {
    return call().code == Code::in_use ? 0 : 1;
  } else {
    try {
      call();
    } catch (const std::invalid_argument& e) {
      return e.what() == message(Status{.code = Code::in_use}) ? 0 : 1;
    }
    return 1;
  }
}

void add(Numbers& to, const FeaturePair& pair) {
  to.insert(to.end(), {double(pair.kind), double(pair.a), double(pair.b)});
}

template <class Query, class Options>
struct SurfaceSubject : Subject {
  Query query;
  Options options{};
  bool with_itself = false;

  void set(const Hook& hook, bool short_budget) override {
    Options next = options;
    next.budget = short_budget ? Budget(400) : Budget();
    next.filter.accepts = [hook](const FeaturePair&) {
      if (hook) hook();
      return true;
    };
    if (!short_budget) {
      // Of a budget that does not end.
      next.budget = std::chrono::hours(1);
      next.clock = [hook, time = 0]() mutable {
        if (hook) hook();
        return std::chrono::nanoseconds(++time);
      };
    }
    query.set_options(next);
  }
  Status run(Workers& workers) override {
    World& w = world();
    return with_itself ? query.run(w.surface_a, workers) : query.run(w.surface_a, w.surface_b, workers);
  }
  std::size_t ways_to_go_on() const override { return 1; }
  Status go_on(std::size_t, Workers& workers) override { return query.resume(workers); }
  bool reads_surfaces() const override { return true; }
  bool reads_b() const override { return !with_itself; }
  Numbers results() const override {
    Numbers all{double(query.open().size())};
    for (const auto& pair : query.pairs()) add(all, pair);
    if constexpr (std::is_same_v<Query, SweptQuery>)
      for (const FeaturePair& pair : query.candidates()) add(all, pair);
    if constexpr (std::is_same_v<Query, ProximityQuery>) {
      std::vector<double> distances(world().mesh_a.vertex_count(), -1);
      query.safe_distances(distances);
      for (const double d : distances) all.push_back(d);
    }
    return all;
  }
  int call_itself() override {
    World& w = world();
    return is_not_refused([&] { return query.run(w.surface_a); }) +
           is_not_refused([&] { return query.run(w.surface_a, w.surface_b); }) +
           is_not_refused([&] { return query.resume(); }) + is_not_refused([&] { query.set_options({}); });
  }
};

template <class Query>
struct ObstacleSubject : Subject {
  Query query;
  bool is_field = false;
  Hook field_hook;
  Obstacle field = DistanceField{.value =
                                     [this](const Vec3& p) {
                                       if (field_hook) field_hook();
                                       return length(p - Vec3{0.7, 0, 0}) - 0.4;
                                     },
                                 .tolerance = 0.05,
                                 .gradient =
                                     [this](const Vec3& p) {
                                       if (field_hook) field_hook();
                                       return p - Vec3{0.7, 0, 0};
                                     }};

  void set(const Hook& hook, bool short_budget) override {
    ObstacleOptions next{.margin = 0.05};
    next.budget = short_budget ? Budget(60) : Budget();
    field_hook = is_field ? hook : Hook();
    next.accepts = [hook](std::uint32_t) {
      if (hook) hook();
      return true;
    };
    if (!short_budget) {
      next.budget = std::chrono::hours(1);
      next.clock = [hook, time = 0]() mutable {
        if (hook) hook();
        return std::chrono::nanoseconds(++time);
      };
    }
    query.set_options(next);
  }
  const Obstacle& obstacle() const { return is_field ? field : world().ball; }
  Status run_once(Workers& workers) {
    if constexpr (std::is_same_v<Query, ObstacleQuery>)
      return query.run(world().surface_a, obstacle(), workers);
    else
      return query.run(world().surface_a, obstacle(), {0.1, 0, 0}, workers);
  }
  Status run(Workers& workers) override { return run_once(workers); }
  std::size_t ways_to_go_on() const override { return 1; }
  Status go_on(std::size_t, Workers& workers) override { return query.resume(workers); }
  bool reads_surfaces() const override { return true; }
  bool reads_b() const override { return false; }
  Numbers results() const override {
    Numbers all{double(query.open().size())};
    if constexpr (std::is_same_v<Query, ObstacleQuery>) {
      for (const ObstacleContact& c : query.contacts()) all.insert(all.end(), {double(c.feature), c.distance});
    } else {
      for (const ObstacleImpact& i : query.impacts()) all.insert(all.end(), {double(i.feature), i.time});
    }
    return all;
  }
  int call_itself() override {
    return is_not_refused([&] { return run_once(serial_workers()); }) + is_not_refused([&] { return query.resume(); }) +
           is_not_refused([&] { query.set_options({}); });
  }
};

struct ContactSubject : Subject {
  enum class Way { run, start, warm_up };
  ContactQuery query;
  Way way = Way::run;
  bool reaches = true;

  ContactSubject() { query.add(world().a, world().b); }
  void set(const Hook& hook, bool short_budget) override {
    CollideOptions next{.surfaces = true, .find_crossings = true, .containment = true};
    if (reaches)
      next.refresh_children = [hook](const Collider&, std::uint32_t) {
        if (hook) hook();
        return true;
      };
    next.budget = short_budget ? Budget(40) : Budget(std::chrono::hours(1));
    if (!short_budget)
      next.clock = [hook, time = 0]() mutable {
        if (hook) hook();
        return std::chrono::nanoseconds(++time);
      };
    query.set_options(next);
  }
  Status run(Workers& workers) override {
    if (way == Way::warm_up) {
      if (const Status status = query.warm_up(workers); !status) return status;
    }
    return way == Way::run ? query.run(workers) : query.start(workers);
  }
  std::size_t ways_to_go_on() const override { return way == Way::run ? 0 : 2; }
  Status go_on(std::size_t i, Workers& workers) override {
    return i == 0 ? query.resume(workers) : query.carry(workers);
  }
  Numbers results() const override {
    const Contacts& c = query.contacts();
    Numbers all{double(c.finished), double(c.finished_count), double(query.front().opened.size())};
    std::vector<std::array<double, 4>> contacts, crossings, surfaces;  // in whatever order they were found
    for (std::size_t i = 0; i < c.contacts.size(); ++i) {
      contacts.push_back({double(c.contacts[i].node_a), double(c.contacts[i].node_b), c.contacts[i].depth, 0});
      if (i < c.surfaces.size())
        surfaces.push_back({double(c.contacts[i].node_a), double(c.contacts[i].node_b), c.surfaces[i].depth, 1});
    }
    for (const Crossing& x : c.crossings) crossings.push_back({double(x.facet_a), double(x.facet_b), 0, 2});
    for (auto* list : {&contacts, &surfaces, &crossings}) {
      std::sort(list->begin(), list->end());
      for (const auto& one : *list) all.insert(all.end(), one.begin(), one.end());
    }
    for (const MutualContainment& m : c.containment)
      all.insert(all.end(), {3, double(m.a_in_b.inside_count), double(m.b_in_a.inside_count)});
    return all;
  }
  int call_itself() override {
    std::vector<FrontPair> cut;
    World& w = world();
    return is_not_refused([&] { return query.run(); }) + is_not_refused([&] { return query.start(); }) +
           is_not_refused([&] { return query.resume(); }) + is_not_refused([&] { return query.carry(); }) +
           is_not_refused([&] { return query.warm_up(); }) + is_not_refused([&] { query.set_options({}); }) +
           is_not_refused([&] { query.add(w.a, w.b); }) + is_not_refused([&] { query.clear(); }) +
           is_not_refused([&] { query.set_front({}); }) +
           is_not_refused([&] { static_cast<void>(query.take_contacts()); }) +
           is_not_refused([&] { query.surface(0); }) + is_not_refused([&] { query.cut(cut); });
  }
};

struct DistanceSubject : Subject {
  DistanceQuery query;
  DistanceOptions options;
  DistanceBounds found;
  RigidTransform apart{.translation = {3, 0.2, 0.1}};

  void set(const Hook& hook, bool) override {
    options.budget = std::chrono::hours(1);
    options.clock = [hook, time = 0]() mutable {
      if (hook) hook();
      return std::chrono::nanoseconds(++time);
    };
  }
  Status run(Workers&) override {
    found = {};
    Collider far = world().b;
    far.set_transform(apart);
    found = query.run(world().a, far, options);
    return found.status;
  }
  Numbers results() const override {
    if (!found.status) return Numbers(4);  // says that it is nothing
    return {found.lower, found.upper, double(found.a.facet), double(found.b.facet)};
  }
  int call_itself() override {
    return is_not_refused([&] { return query.run(world().a, world().b).status; });
  }
};

struct PenetrationSubject : Subject {
  PenetrationQuery query{world().a, world().b};
  PenetrationOptions options;
  Penetration found;

  void set(const Hook& hook, bool short_budget) override {
    options.tolerance = 0.5;
    options.budget = short_budget ? Budget(100) : Budget(std::chrono::hours(1));
    options.clock = [hook, time = 0]() mutable {
      if (hook) hook();
      return std::chrono::nanoseconds(++time);
    };
  }
  Status run(Workers&) override {
    found = {};
    found = query.run(options);
    return found.status;
  }
  std::size_t ways_to_go_on() const override { return 1; }
  Status go_on(std::size_t, Workers&) override {
    found = {};
    found = query.resume(options);
    return found.status;
  }
  Numbers results() const override { return {found.lower, found.upper, found.estimate}; }
  int call_itself() override {
    return is_not_refused([&] { return query.run(options).status; }) +
           is_not_refused([&] { return query.resume(options).status; });
  }
};

struct CrossingSubject : Subject {
  CrossingQuery query;
  bool has_callbacks() const override { return false; }
  void set(const Hook&, bool) override {}
  Status run(Workers&) override { return query.run(world().a, world().b); }
  Numbers results() const override {
    Numbers all{double(query.leaf_pairs()), double(query.facets_read()), double(query.pairs_tested())};
    for (const Crossing& c : query.pairs()) all.insert(all.end(), {double(c.facet_a), double(c.facet_b)});
    return all;
  }
  int call_itself() override { return 0; }
};

struct InsideSubject : Subject {
  InsideQuery query{world().a};
  Containment found;
  bool has_callbacks() const override { return false; }
  void set(const Hook&, bool) override {}
  Status run(Workers&) override {
    static const std::vector<std::uint32_t> vertices{0, 5, 9, 13, 20};
    query.components_inside(world().b, vertices, found);
    return found.status;
  }
  Numbers results() const override {
    if (!found.status) return {0, 0};  // says that it is nothing
    return {double(found.inside_count), double(found.inside.size())};
  }
  int call_itself() override { return 0; }
};

struct TouchSubject : Subject {
  TouchQuery query;
  bool reads_b() const override { return false; }
  bool has_callbacks() const override { return false; }
  bool asks_interrupts() const override { return false; }
  void set(const Hook&, bool) override {}
  Status run(Workers&) override { return query.run(world().a, Sphere{{0.7, 0, 0}, 0.4}, {.collect_all = true}).status; }
  Numbers results() const override {
    if (!query.result().status) return {0, 0, 0};  // the same
    return {double(query.result().facets.size()), double(query.result().leaves.size()), query.result().lower};
  }
  int call_itself() override { return 0; }
};

struct Kind {
  const char* name;
  std::function<std::unique_ptr<Subject>()> make;
  friend std::ostream& operator<<(std::ostream& out, const Kind& kind) { return out << kind.name; }
};

template <class Type>
Kind kind(const char* name, const std::function<void(Type&)>& change = {}) {
  return {name, [change]() -> std::unique_ptr<Subject> {
            auto made = std::make_unique<Type>();
            if (change) change(*made);
            return made;
          }};
}

using Proximity = SurfaceSubject<ProximityQuery, ProximityOptions>;
using Swept = SurfaceSubject<SweptQuery, SweptOptions>;
using Crossings = SurfaceSubject<SurfaceCrossingQuery, SurfaceCrossingOptions>;
const Kind kinds[]{
    kind<Proximity>("proximity", [](Proximity& p) { p.options.distance = 0.1; }),
    kind<Proximity>("proximity_once",
                    [](Proximity& p) { p.options.distance = 0.1, p.options.nearest_features_once = true; }),
    kind<Proximity>("proximity_itself", [](Proximity& p) { p.options.distance = 0.1, p.with_itself = true; }),
    kind<Swept>("swept"),
    kind<Swept>("swept_candidates", [](Swept& s) { s.options.candidates_only = true; }),
    kind<Crossings>("crossings"),
    kind<Crossings>("crossings_itself", [](Crossings& c) { c.with_itself = true; }),
    kind<ObstacleSubject<ObstacleQuery>>("obstacle"),
    kind<ObstacleSubject<ObstacleQuery>>("obstacle_field", [](auto& o) { o.is_field = true; }),
    kind<ObstacleSubject<SweptObstacleQuery>>("swept_obstacle"),
    kind<ObstacleSubject<SweptObstacleQuery>>("swept_obstacle_field", [](auto& o) { o.is_field = true; }),
    kind<ContactSubject>("contacts"),
    kind<ContactSubject>("contacts_start", [](ContactSubject& c) { c.way = ContactSubject::Way::start; }),
    kind<ContactSubject>("contacts_carry",
                         [](ContactSubject& c) { c.way = ContactSubject::Way::start, c.reaches = false; }),
    kind<ContactSubject>("contacts_warm_up", [](ContactSubject& c) { c.way = ContactSubject::Way::warm_up; }),
    kind<DistanceSubject>("distance"),
    kind<PenetrationSubject>("penetration"),
    kind<CrossingSubject>("crossings_of_colliders"),
    kind<InsideSubject>("inside"),
    kind<TouchSubject>("touch"),
};

/// What may end a call at its k-th time.
struct Ending {
  const char* name;
  /// Calls f(hook), and ends it at the k-th time; does nothing for k = 0. Returns how many times there were.
  std::function<long(long k, const std::function<void(const Hook&)>& f)> apply;
  friend std::ostream& operator<<(std::ostream& out, const Ending& ending) { return out << ending.name; }
};

const Ending endings[]{
    {"callback",
     [](long k, const std::function<void(const Hook&)>& f) {
       std::atomic<long> calls = 0;
       f([&] {
         if (++calls == k) throw Thrown();
       });
       return calls.load();
     }},
    {"interrupt",
     [](long k, const std::function<void(const Hook&)>& f) {
       long asked = 0;
       const Interrupt interrupt([&] {
         if (++asked == k) throw Thrown();
       });
       f({});
       return asked;
     }},
    {"memory",
     [](long k, const std::function<void(const Hook&)>& f) {
       const std::size_t before = test::allocations;
       struct Granted {
         ~Granted() { test::allocations_granted = -1; }
       } const granted;
       test::allocations_granted = k - 1;
       f({});
       return static_cast<long>(test::allocations - before);
     }},
};

/// After its k-th callback ended a call of the subject: it has nothing, says why, and answers as a new one does.
void expect_empty_and_as_new(const Kind& kind, Subject& subject, const Numbers& truth, Code why, long k) {
  const auto unasked = kind.make();
  EXPECT_EQ(subject.results(), unasked->results()) << k;
  subject.set({}, false);
  for (std::size_t i = 0; i < subject.ways_to_go_on(); ++i)
    EXPECT_EQ(subject.go_on(i, serial_workers()).code, why) << k;
  EXPECT_EQ(subject.results(), unasked->results()) << k;
  EXPECT_TRUE(subject.run(serial_workers())) << k;
  EXPECT_EQ(subject.results(), truth) << k;
  for (std::size_t i = 0; i < subject.ways_to_go_on(); ++i) EXPECT_TRUE(subject.go_on(i, serial_workers())) << k;
  EXPECT_EQ(subject.results(), truth) << k;
}

class EndedCalls : public ::testing::TestWithParam<std::tuple<Kind, Ending>> {
 protected:
  std::unique_ptr<Subject> fresh() const { return std::get<0>(GetParam()).make(); }
  const Ending& ending() const { return std::get<1>(GetParam()); }
  Numbers whole() const {
    const auto subject = fresh();
    subject->set({}, false);
    EXPECT_TRUE(subject->run(serial_workers()));
    return subject->results();
  }
  /// The next k to try: every one of the first, then fewer and fewer.
  static long next(long k) { return k < 12 ? k + 1 : k + 1 + k / 4; }

  /// before(subject) is not to be ended; call(subject) is, at each time that something is called.
  void end_at_every_time(const std::function<void(Subject&)>& before, bool short_budget,
                         const std::function<Status(Subject&)>& call) {
    const Numbers truth = whole();
    EXPECT_FALSE(truth.empty());
    for (long k = 1;; k = next(k)) {
      const auto subject = fresh();
      before(*subject);
      // Options are given before anything is counted.
      bool ended = false;
      Hook current;
      subject->set(
          [&current] {
            if (current) current();
          },
          short_budget);
      try {
        ending().apply(k, [&](const Hook& hook) {
          current = hook;
          EXPECT_TRUE(call(*subject));
        });
      } catch (const Thrown&) {
        ended = true;
      } catch (const std::bad_alloc&) {
        ended = true;
      }
      current = {};
      if (!ended) break;
      expect_empty_and_as_new(std::get<0>(GetParam()), *subject, truth, Code::ended_by_exception, k);
      if (HasFailure()) break;
    }
  }
};

TEST_P(EndedCalls, leave_an_object_empty_that_was_asked_for_the_first_time) {
  end_at_every_time([](Subject&) {}, false, [](Subject& s) { return s.run(serial_workers()); });
}

TEST_P(EndedCalls, leave_an_object_empty_that_had_found_all_before) {
  end_at_every_time(
      [](Subject& s) {
        s.set({}, false);
        EXPECT_TRUE(s.run(serial_workers()));
      },
      false, [](Subject& s) { return s.run(serial_workers()); });
}

TEST_P(EndedCalls, leave_an_object_empty_that_was_to_go_on) {
  for (std::size_t way = 0; way < fresh()->ways_to_go_on(); ++way)
    end_at_every_time(
        [](Subject& s) {
          s.set({}, true);
          EXPECT_TRUE(s.run(serial_workers()));
        },
        false, [&](Subject& s) { return s.go_on(way, serial_workers()); });
}

INSTANTIATE_TEST_SUITE_P(Quick, EndedCalls,
                         ::testing::Combine(::testing::ValuesIn(kinds), ::testing::ValuesIn(endings)),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) + "_by_" + std::get<1>(info.param).name;
                         });

class OwnCalls : public ::testing::TestWithParam<Kind> {};

TEST_P(OwnCalls, of_a_callback_are_refused_and_change_nothing) {
  const auto subject = GetParam().make(), same = GetParam().make();
  same->set({}, false);
  ASSERT_TRUE(same->run(serial_workers()));
  int calls = 0, not_refused = 0;
  subject->set(
      [&] {
        if (++calls <= 50) not_refused += subject->call_itself();
      },
      false);
  ASSERT_TRUE(subject->run(serial_workers()));
  EXPECT_EQ(not_refused, 0);
  EXPECT_EQ(subject->results(), same->results());
  // And when it goes on.
  for (std::size_t way = 0; way < subject->ways_to_go_on(); ++way) {
    subject->set({}, true);
    ASSERT_TRUE(subject->run(serial_workers()));
    calls = 0;
    subject->set(
        [&] {
          if (++calls <= 50) not_refused += subject->call_itself();
        },
        false);
    ASSERT_TRUE(subject->go_on(way, serial_workers()));
    EXPECT_EQ(not_refused, 0);
    EXPECT_EQ(subject->results(), same->results());
  }
}

TEST_P(OwnCalls, end_on_all_threads_and_leave_the_object_empty) {
  Workers three(3);
  const auto unasked = GetParam().make(), same = GetParam().make();
  same->set({}, false);
  ASSERT_TRUE(same->run(serial_workers()));
  for (const long k : {1, 7, 30, 100, 300}) {
    const auto subject = GetParam().make();
    std::atomic<long> calls = 0;
    subject->set(
        [&] {
          if (++calls == k) throw Thrown();
        },
        false);
    try {
      EXPECT_TRUE(subject->run(three));
      EXPECT_LT(calls, k);
    } catch (const Thrown&) {
      EXPECT_EQ(subject->results(), unasked->results());
      subject->set({}, false);
      EXPECT_TRUE(subject->run(three));
      EXPECT_EQ(subject->results(), same->results());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, OwnCalls, ::testing::ValuesIn(kinds), [](const auto& info) { return info.param.name; });

/// What a callback does to the bodies and surfaces that the call around it reads.
struct Move {
  enum class Target { collider, surface };
  const char* name;
  Target target;
  bool is_of_b;
  std::function<void(World&)> apply;
  bool needs_new_world = false;
};

constexpr auto collider = Move::Target::collider, surface = Move::Target::surface;
const Move moves[]{
    {"update", collider, false, [](World& w) { EXPECT_TRUE(w.body_a.update(w.later)); }},
    {"lazy update", collider, false, [](World& w) { EXPECT_TRUE(w.body_a.update_lazily(w.later, 0)); }},
    {"update there and back", collider, false,
     [](World& w) {
       EXPECT_TRUE(w.body_a.update(w.later));
       EXPECT_TRUE(w.body_a.update(w.mesh_a.positions));
     }},
    {"refused update", collider, false,
     [](World& w) {
       EXPECT_FALSE(w.body_a.update(std::vector<Vec3>(w.later.size(), Vec3{0, 1e300, 0})));
     }},
    {"update of b", collider, true, [](World& w) { EXPECT_TRUE(w.body_b.update(w.later)); }},
    {"place", collider, false,
     [](World& w) {
       w.a.set_transform({.translation = {0, 0.3, 0}});
     }},
    {"place there and back", collider, false,
     [](World& w) {
       w.a.set_transform({.translation = {0, 0.3, 0}});
       w.a.set_transform({});
     }},
    {"positions", collider, false, [](World& w) { w.a.set_positions(w.later); }},
    {"assignment", collider, false, [](World& w) { w.body_a = Body(w.mesh_a, w.built_a); }, true},
    {"update of a surface", surface, false, [](World& w) { EXPECT_TRUE(w.surface_a.update(w.later)); }},
    {"update of a surface there and back", surface, false,
     [](World& w) {
       EXPECT_TRUE(w.surface_a.update(w.later));
       EXPECT_TRUE(w.surface_a.update(w.mesh_a.positions, w.later));
     }},
    {"update of surface b", surface, true, [](World& w) { EXPECT_TRUE(w.surface_b.update(w.later)); }},
    {"follow", surface, false, [](World& w) { EXPECT_TRUE(w.surface_a.follow(w.a)); }},
    {"assignment of a surface", surface, false, [](World& w) { w.surface_a = SurfaceTree(w.mesh_a); }, true},
};

class MovingCallbacks : public ::testing::TestWithParam<std::tuple<Kind, bool>> {
 protected:
  const Kind& kind() const { return std::get<0>(GetParam()); }
  bool by_interrupt() const { return std::get<1>(GetParam()); }
  /// Where the k-th callback of the call moves something. way: how the subject goes on; none: it begins. False where
  /// there is no such callback.
  bool move_at(long k, const Move& move, std::optional<std::size_t> way, const Numbers& truth) {
    SCOPED_TRACE(std::string(move.name) + " at callback " + std::to_string(k));
    const auto subject = kind().make();
    if (way) {
      subject->set({}, true);
      EXPECT_TRUE(subject->run(serial_workers()));
    }
    long calls = 0;
    const Hook hook = [&] {
      if (++calls == k) move.apply(world());
    };
    subject->set(by_interrupt() ? Hook() : hook, false);
    Status status;
    {
      const Interrupt interrupt(by_interrupt() ? hook : [] {});
      status = way ? subject->go_on(*way, serial_workers()) : subject->run(serial_workers());
    }
    const bool has_moved = calls >= k;
    EXPECT_EQ(status.code, has_moved ? Code::changed_during_call : Code::ok);
    if (move.needs_new_world && has_moved) {
      EXPECT_EQ(subject->results(), kind().make()->results());
      only_world() = std::make_unique<World>();
    } else {
      world().restore();
      if (has_moved) expect_empty_and_as_new(kind(), *subject, truth, Code::changed_during_call, k);
    }
    return has_moved;
  }
};

TEST_P(MovingCallbacks, leave_an_object_empty_that_says_so) {
  world().restore();
  const auto whole = kind().make();
  whole->set({}, false);
  ASSERT_TRUE(whole->run(serial_workers()));
  const Numbers truth = whole->results();
  std::vector<std::optional<std::size_t>> ways{std::nullopt};
  for (std::size_t way = 0; way < whole->ways_to_go_on(); ++way) ways.push_back(way);
  std::size_t moved = 0;
  for (const Move& move : moves) {
    if ((move.target == surface) != whole->reads_surfaces() || (move.is_of_b && !whole->reads_b())) continue;
    // Calls that go on end as those that begin do: one move tells.
    const std::size_t tried = moved == 0 ? ways.size() : 1;
    for (const auto& way : std::span(ways).first(tried))
      for (long k = 1; k < 2000 && !HasFailure() && move_at(k, move, way, truth); k = 5 * k + 2) ++moved;
  }
  if (by_interrupt() ? whole->asks_interrupts() : whole->has_callbacks()) {
    EXPECT_GE(moved, 3u);
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, MovingCallbacks, ::testing::Combine(::testing::ValuesIn(kinds), ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param).name) +
                                  (std::get<1>(info.param) ? "_by_interrupt" : "_by_callback");
                         });

TEST(MovedDuringCalls, bodies_that_surfaces_follow) {
  World w;
  ASSERT_TRUE(w.surface_a.follow(w.a));
  ASSERT_TRUE(w.surface_b.follow(w.b));
  SurfaceCrossingQuery query, same;
  ASSERT_TRUE(same.run(w.surface_a, w.surface_b).finished);
  ASSERT_FALSE(same.pairs().empty());
  long calls = 0;
  query.set_options({.filter = {.accepts = [&](const FeaturePair&) {
                       if (++calls == 3) {
                         EXPECT_TRUE(w.body_b.update(w.later));
                       }
                       return true;
                     }}});
  const SurfaceQueryStatus status = query.run(w.surface_a, w.surface_b);
  EXPECT_EQ(static_cast<const Status&>(status), (Status{.code = Code::changed_during_call, .body = 1}));
  EXPECT_FALSE(status.finished);
  EXPECT_TRUE(query.pairs().empty());
  EXPECT_EQ(query.run(w.surface_a, w.surface_b).code, Code::surface_not_current);
  ASSERT_TRUE(w.body_b.update(w.mesh_b.positions));
  ASSERT_TRUE(w.surface_b.follow(w.b));
  ASSERT_TRUE(query.run(w.surface_a, w.surface_b).finished);
  EXPECT_TRUE(std::equal(query.pairs().begin(), query.pairs().end(), same.pairs().begin(), same.pairs().end()));
}

TEST(MovedDuringCalls, throw_where_there_is_no_status) {
  World w;
  const auto expect_refused = [&](const char* name, const std::function<void(const Hook&)>& f) {
    for (const long k : {1, 2, 9}) {
      long calls = 0;
      const Hook moves_a = [&] {
        if (++calls == k) w.a.set_transform({.translation = {0.01, 0, 0}});
      };
      try {
        f(moves_a);
        ADD_FAILURE() << name << ' ' << k;
      } catch (const std::invalid_argument& e) {
        EXPECT_EQ(std::string(e.what()), message(Status{.code = Code::changed_during_call}));
      }
      EXPECT_GE(calls, k) << name;
      w.restore();
      EXPECT_NO_THROW(f([] {})) << name;
    }
  };
  expect_refused("collide", [&](const Hook& hook) {
    CollideOptions options;
    options.refresh_children = [&](const Collider&, std::uint32_t) { return hook(), true; };
    EXPECT_TRUE(collide(w.a, w.b, options).finished);
  });
  expect_refused("distance", [&](const Hook& hook) {
    Collider far = w.b;
    far.set_transform({.translation = {3, 0.2, 0.1}});
    DistanceOptions options{.budget = std::chrono::hours(1)};
    // It is read at first for the time, and then after every 64 tests.
    options.clock = [&] { return hook(), hook(), hook(), hook(), hook(), std::chrono::nanoseconds(0); };
    EXPECT_TRUE(distance(w.a, far, options).complete);
  });
  expect_refused("walk_pairs", [&](const Hook& hook) {
    walk_pairs(w.a, w.b, {}, [&](NodePair, bool) { return hook(), Step::open; });
  });
  expect_refused("crossings", [&](const Hook& hook) {
    const Interrupt interrupt(hook);
    crossings(w.a, w.b);
  });
  EXPECT_NE(
      message(Status{.code = Code::changed_during_call, .body = 1}).find("the second body was moved by a callback"),
      std::string::npos);
}

TEST(MovedDuringCalls, a_visitor_that_ends_its_walk_may_move) {
  World w;
  EXPECT_EQ(walk_pairs(w.a, w.b, {},
                       [&](NodePair, bool) {
                         EXPECT_TRUE(w.body_a.update(w.later));
                         return Step::stop;
                       }),
            1u);
}

TEST(MovedDuringCalls, other_queries_may_read_the_same) {
  World w;
  CrossingQuery other;
  long calls = 0;
  ContactQuery query({.find_crossings = true, .refresh_children = [&](const Collider&, std::uint32_t) {
                        if (++calls == 5) {
                          EXPECT_TRUE(other.run(w.a, w.b));
                        }
                        return true;
                      }});
  query.add(w.a, w.b);
  EXPECT_TRUE(query.run().finished);
  EXPECT_GE(calls, 5);
  EXPECT_EQ(query.contacts().crossings.size(), other.pairs().size());
  EXPECT_EQ(other.pairs().size(), brute_force::crossings(w.a, w.b).size());
}

TEST(EndedQueries, without_a_budget_forget_what_workers_had_found) {
  World& w = world();
  Workers three(3);
  for (Workers* workers : {&serial_workers(), &three})
    for (const int k : {1, 2, 20, 200}) {
      std::atomic<int> calls = 0;
      ProximityOptions options{.distance = 0.1}, all = options;
      options.filter.accepts = [&](const FeaturePair&) {
        if (++calls >= k) throw Thrown();
        return true;
      };
      ProximityQuery query(options), other(all);
      EXPECT_THROW(static_cast<void>(query.run(w.surface_a, w.surface_b, *workers)), Thrown);
      EXPECT_TRUE(query.pairs().empty());
      query.set_options(all);
      EXPECT_EQ(query.resume().code, Code::ended_by_exception);
      // Of other surfaces, much smaller ones.
      const Mesh small{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .facets = {{0, 1, 2}}};
      const SurfaceTree few(small);
      EXPECT_TRUE(query.run(few, *workers).finished);
      EXPECT_TRUE(query.pairs().empty());
      ASSERT_TRUE(query.run(w.surface_a, w.surface_b, *workers).finished);
      ASSERT_TRUE(other.run(w.surface_a, w.surface_b).finished);
      EXPECT_EQ(std::vector<FeaturePair>(query.pairs().begin(), query.pairs().end()),
                std::vector<FeaturePair>(other.pairs().begin(), other.pairs().end()));
    }
}

TEST(EndedUpdates, of_a_surface_are_refused_by_queries_until_the_next_one) {
  const Mesh mesh = sample_body("blob", 8);
  SurfaceTree surface(mesh), same(mesh);
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p += Vec3{0.5, 0.25, 0};
  ASSERT_TRUE(same.update(moved));
  int loops = 0, last = 0;
  Workers breaks(
      [&](std::size_t count, ChunkFunction chunk) {
        if (++loops == last) throw Thrown();
        for (std::size_t i = 0; i < count; ++i) chunk(i);
      },
      2);
  ProximityQuery query({.distance = 0.1});
  bool throws = true;
  for (last = 1; throws; ++last) {
    loops = 0;
    throws = false;
    try {
      EXPECT_TRUE(surface.update(moved, breaks));
    } catch (const Thrown&) {
      throws = true;
      EXPECT_EQ(query.run(surface).code, Code::ended_by_exception);
      // One that is refused mends nothing.
      EXPECT_EQ(surface.update(std::vector<Vec3>(3)).code, Code::wrong_vertex_count);
      EXPECT_EQ(query.run(surface).code, Code::ended_by_exception);
      loops = 1000;
      EXPECT_TRUE(surface.update(mesh.positions));
      EXPECT_TRUE(query.run(surface));
    }
  }
  EXPECT_GE(last, 2);
  EXPECT_EQ(surface.hash(), same.hash());
}

TEST(EndedFunctions, pass_on_what_callbacks_throw_and_give_the_same_when_they_are_asked_again) {
  World& w = world();
  long most = 0;
  // f(hook): numbers of a free function with callbacks.
  const auto each_time = [&](const std::function<Numbers(const Hook&)>& f) {
    long calls = 0;
    const Numbers truth = f([&] { ++calls; });
    most = std::max(most, calls);
    ASSERT_GT(calls, 0);
    for (long k = 1; k <= calls; k += 1 + k / 8) {
      long done = 0;
      EXPECT_THROW(f([&] {
                     if (++done == k) throw Thrown();
                   }),
                   Thrown);
      if (k % 3 == 1) {
        EXPECT_EQ(f([] {}), truth);
      }
    }
  };
  each_time([&](const Hook& hook) {
    Numbers pairs;
    walk_pairs(w.a, w.b, {}, [&](NodePair pair, bool) {
      hook();
      pairs.insert(pairs.end(), {double(pair.a), double(pair.b)});
      return Step::open;
    });
    return pairs;
  });
  each_time([&](const Hook& hook) {
    CollideOptions options{.budget = std::chrono::hours(1), .find_crossings = true};
    options.clock = [&] { return hook(), std::chrono::nanoseconds(0); };
    options.refresh_children = [&](const Collider&, std::uint32_t) { return hook(), true; };
    return Numbers{double(collide(w.a, w.b, options).crossings.size())};
  });
  each_time([&](const Hook& hook) {
    DistanceOptions options{.budget = std::chrono::hours(1)};
    options.clock = [&] { return hook(), std::chrono::nanoseconds(0); };
    return Numbers{distance(w.a, w.b, options).upper};
  });
  each_time([&](const Hook& hook) {
    BuildOptions options{.method = Method::octree, .depth = 2};
    options.progress = [&](const BuildProgress&) { hook(); };
    Numbers radii;
    for (const Sphere& s : build(w.mesh_a, options).tree.spheres) radii.push_back(s.radius);
    return radii;
  });
  EXPECT_GT(most, 100);
}

}  // namespace
}  // namespace morula
