// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "call_subjects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/penetration.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace morula::test {

World::World() {
  EXPECT_TRUE(surface_a.update(mesh_a.positions, later));
}
void World::restore() {
  EXPECT_TRUE(body_a.update(mesh_a.positions));
  EXPECT_TRUE(body_b.update(mesh_b.positions));
  for (Collider* collider : {&a, &b}) collider->set_transform({});
  EXPECT_TRUE(surface_a.update(mesh_a.positions, later));
  EXPECT_TRUE(surface_b.update(mesh_b.positions));
}

std::unique_ptr<World>& only_world() {
  static auto one = std::make_unique<World>();
  return one;
}
World& world() {
  return *only_world();
}
namespace {

using Code = Status::Code;

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

struct PatchSubject : Subject {
  ContactPatchQuery query{world().a, world().b};
  bool has_callbacks() const override { return false; }
  void set(const Hook&, bool) override {}
  Status run(Workers&) override { return query.run(); }
  Numbers results() const override {
    Numbers all{query.volume(), double(query.certified()), double(query.patches().size())};
    for (const ContactPatch& patch : query.patches())
      all.insert(all.end(), {patch.volume, patch.depth, double(patch.a.facets.size()), double(patch.points.size())});
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
    kind<PatchSubject>("contact_patches"),
    kind<InsideSubject>("inside"),
    kind<TouchSubject>("touch"),
};
}  // namespace

std::span<const Kind> all_kinds() {
  return kinds;
}

void expect_empty_and_as_new(const Kind& kind, Subject& subject, const Numbers& truth, Status::Code why, long k) {
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
}  // namespace morula::test
