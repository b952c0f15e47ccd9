// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Calls that end in the middle: whatever an object calls may throw at any time, an Interrupt may, and memory may be
// missing. The object is empty afterwards and says so, and the next call gives what a new object gives. A callback that
// calls its own object is refused, and the call that it is part of is none the worse.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/pair_walk.hpp>
#include <morula/parallel/interrupt.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/swept.hpp>
#include <mutex>
#include <ostream>
#include <support/allocations.hpp>
#include <tuple>

#include "call_subjects.hpp"

namespace morula::test {
namespace {

using Code = Status::Code;

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
       const std::size_t before = allocations;
       struct Granted {
         ~Granted() { allocations_granted = -1; }
       } const granted;
       allocations_granted = k - 1;
       f({});
       return static_cast<long>(allocations - before);
     }},
};
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
                         ::testing::Combine(::testing::ValuesIn(all_kinds().begin(), all_kinds().end()),
                                            ::testing::ValuesIn(endings)),
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

INSTANTIATE_TEST_SUITE_P(Quick, OwnCalls, ::testing::ValuesIn(all_kinds().begin(), all_kinds().end()),
                         [](const auto& info) { return info.param.name; });
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
}  // namespace morula::test
