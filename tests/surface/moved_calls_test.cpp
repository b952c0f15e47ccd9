// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Callbacks that move what the call around them reads: the call ends as by an exception, the object is empty and says
// so, and the next call gives what a new object gives.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/pair_walk.hpp>
#include <morula/parallel/interrupt.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <optional>
#include <span>
#include <tuple>

#include "call_subjects.hpp"

namespace morula::test {
namespace {

using Code = Status::Code;

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

INSTANTIATE_TEST_SUITE_P(Quick, MovingCallbacks,
                         ::testing::Combine(::testing::ValuesIn(all_kinds().begin(), all_kinds().end()),
                                            ::testing::Bool()),
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
}  // namespace
}  // namespace morula::test
