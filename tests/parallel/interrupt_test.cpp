// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/parallel/interrupt.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/surface/surface_tree.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <support/ended_where_asked.hpp>
#include <thread>
#include <vector>

namespace morula {
namespace {

using test::Cancelled;

TEST(Interrupt, asks_before_every_chunk_on_the_callers_thread) {
  int asked = 0;
  const auto here = std::this_thread::get_id();
  const Interrupt interrupt([&] {
    ++asked;
    EXPECT_EQ(std::this_thread::get_id(), here);
  });
  serial_workers().run(10, [](std::size_t) {});
  EXPECT_EQ(asked, 10);
  for (const unsigned threads : {2u, 3u, 8u}) {
    Workers workers(threads);
    workers.run(1000, [](std::size_t) {});
  }
  EXPECT_GE(asked, 10);
}

TEST(Interrupt, ends_a_loop_before_the_next_chunk) {
  for (int last = 1; last <= 10; ++last) {
    int asked = 0, done = 0;
    const Interrupt interrupt([&] {
      if (++asked == last) throw Cancelled();
    });
    EXPECT_THROW(serial_workers().run(10, [&](std::size_t) { ++done; }), Cancelled);
    EXPECT_EQ(done, last - 1);
  }
}

TEST(Interrupt, ends_loops_of_a_pool_and_those_within_them_on_all_threads) {
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    Workers workers(threads);
    std::atomic<std::size_t> done = 0;
    {
      int asked = 0;
      const Interrupt interrupt([&] {
        if (++asked == 20) throw Cancelled();
      });
      const auto all = [&] {
        workers.run(1'000'000, [&](std::size_t) {
          workers.run(1000, [&](std::size_t) {
            ++done;
            std::this_thread::yield();
          });
        });
      };
      EXPECT_THROW(all(), Cancelled) << threads;
      // Later calls end at once.
      const std::size_t before = done;
      EXPECT_THROW(all(), Cancelled) << threads;
      EXPECT_EQ(done, before);
      EXPECT_EQ(asked, 20);
    }
    EXPECT_LT(done, 500'000'000u);
    // The pool and its threads are as before.
    std::atomic<int> again = 0;
    workers.run(100, [&](std::size_t) { workers.run(10, [&](std::size_t) { ++again; }); });
    EXPECT_EQ(again, 1000);
  }
}

TEST(Interrupt, ends_loops_of_the_hosts_executor) {
  Workers workers(
      [](std::size_t count, ChunkFunction chunk) {
        std::thread other([&] {
          for (std::size_t i = 0; i < count; i += 2) chunk(i);
        });
        for (std::size_t i = 1; i < count; i += 2) chunk(i);
        other.join();
      },
      2);
  std::atomic<int> done = 0;
  int asked = 0;
  const auto here = std::this_thread::get_id();
  const Interrupt interrupt([&] {
    EXPECT_EQ(std::this_thread::get_id(), here);
    if (++asked == 3) throw Cancelled();
  });
  EXPECT_THROW(workers.run(1000, [&](std::size_t) { ++done; }), Cancelled);
  EXPECT_EQ(asked, 3);
  EXPECT_LE(done, 502);
}

TEST(Interrupt, the_last_one_made_is_asked_and_the_one_before_it_afterwards) {
  int outer = 0, inner = 0;
  const Interrupt first([&] { ++outer; });
  {
    const Interrupt second([&] {
      ++inner;
      serial_workers().run(5, [](std::size_t) {});  // what is asked is not asked again
    });
    serial_workers().run(3, [](std::size_t) {});
  }
  EXPECT_EQ(inner, 3);
  EXPECT_EQ(outer, 0);
  serial_workers().run(3, [](std::size_t) {});
  EXPECT_EQ(outer, 3);
  EXPECT_THROW(Interrupt({}), std::invalid_argument);
}

TEST(Interrupt, of_another_thread_ends_nothing) {
  const Interrupt interrupt([] { throw Cancelled(); });
  int done = 0;
  std::thread([&] { serial_workers().run(7, [&](std::size_t) { ++done; }); }).join();
  EXPECT_EQ(done, 7);
}

TEST(Interrupt, ends_builds_and_indices_wherever_it_throws) {
  const Mesh mesh = sample_body("blob", 8);
  const BuildOptions options{.depth = 1, .quality = Quality::draft};
  const CoveredTree whole = build(mesh, options);
  test::expect_ends_wherever_it_asks("build", 1,
                                     [&] { EXPECT_EQ(build(mesh, options).tree.spheres, whole.tree.spheres); });
  const Interrupt interrupt([] { throw Cancelled(); });
  EXPECT_THROW(SignedDistance{mesh}, Cancelled);
}

TEST(Interrupt, leaves_calls_that_cannot_throw_alone) {
  const Mesh mesh = sample_body("blob", 8);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p = p * 1.25 + Vec3{1, 2, 3};
  Workers two(2);
  for (Workers* workers : {&serial_workers(), &two})
    for (const Rule rule : {Rule::exact, Rule::wrapped, Rule::approach1, Rule::approach2, Rule::traditional}) {
      Body body(mesh, model, {.rules = {rule}}, *workers), same = body;
      KDopTree boxes(mesh, model, 18, *workers);
      SurfaceTree surface(mesh);
      ASSERT_TRUE(same.update(moved));
      const Interrupt interrupt([] { throw Cancelled(); });
      EXPECT_TRUE(body.update(moved, *workers));
      EXPECT_EQ(body.hash(), same.hash());
      EXPECT_TRUE(body.update(mesh.positions, std::vector<VertexRange>{{0, 5}}, *workers));
      EXPECT_TRUE(body.update_lazily(moved, 1, *workers));
      EXPECT_TRUE(boxes.update(moved, *workers));
      EXPECT_TRUE(surface.update(moved, *workers));
    }
}

}  // namespace
}  // namespace morula
