// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How often calls ask whether to go on: a count of questions for a count of elements, whatever the machine. Where one
// of a call's loops no longer asks, its count is lower.
#include <gtest/gtest.h>

#include <functional>
#include <morula/generators/build.hpp>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/parallel/interrupt.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/surface/surface_tree.hpp>
#include <morula/tree/cover.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <thread>

#include "files.hpp"

namespace morula::test {
namespace {

int questions_of(const std::function<void()>& call) {
  int asked = 0;
  const Interrupt interrupt([&] { ++asked; });
  call();
  return asked;
}

// 200,002 vertices.
const Mesh& large() {
  static const Mesh mesh = sample_body("limb", 400);
  return mesh;
}

/// Expects `least` questions, some 95 % of what there are: what remains is for the ways that sorts differ. Those of
/// making the mesh are not among them, whichever test is the first.
void expect_questions(const std::string& name, int least, const std::function<void()>& call) {
  large();
  EXPECT_GE(questions_of(call), least) << name;
}

TEST(Looks, files_of_meshes_are_read_and_written_with_many) {
  const ScratchFolder folder;
  struct Case {
    const char* name;
    int written, read;
  };
  for (const auto& [name, written, read] : {Case{"a.obj", 150, 150}, Case{"a.off", 150, 288}, Case{"a.ply", 43, 148},
                                            Case{"a.stl", 103, 100}, Case{"a.vtp", 103, 1060}}) {
    const std::filesystem::path path = folder.path() / name;
    expect_questions(std::string("write ") + name, written, [&, &file = path] { write_mesh(file, large()); });
    expect_questions(std::string("read ") + name, read, [&, &file = path] { read_mesh(file); });
  }
}

// 137,449 nodes.
TEST(Looks, files_of_trees_are_read_and_written_with_many) {
  const ScratchFolder folder;
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < 100'000; ++i) balls.push_back({large().positions[i], 1});
  const SphereTree tree = tree_from_spheres(balls);
  struct Case {
    const char* name;
    int written, read;
  };
  for (const auto& [name, written, read] : {Case{"a.json", 36, 301}, Case{"a.sph", 72, 72}}) {
    const std::filesystem::path path = folder.path() / name;
    expect_questions(std::string("write ") + name, written, [&, &file = path] { write_tree(file, tree); });
    expect_questions(std::string("read ") + name, read, [&, &file = path] { read_tree(file); });
  }
}

TEST(Looks, meshes_are_inspected_repaired_and_indexed_with_many) {
#ifdef _LIBCPP_VERSION
  constexpr int inspecting = 265;  // its sort compares less
#else
  constexpr int inspecting = 276;
#endif
  expect_questions("inspect", inspecting, [] { EXPECT_TRUE(inspect(large()).closed); });
  expect_questions("repair", 339, [] { repair(large()); });
  expect_questions("connectivity", 25, [] { connectivity(large()); });
  expect_questions("components_by_vertices", 11, [] { components_by_vertices(large()); });
  expect_questions("SurfaceTree", 5580, [] { SurfaceTree{large()}; });
}

// Loops over nodes run on another thread here, which asks nobody: what is counted are the loops over patches.
TEST(Looks, covers_are_put_together_and_cuts_joined_with_many) {
  const auto elsewhere = [](std::size_t count, ChunkFunction chunk) {
    std::thread([&] {
      for (std::size_t i = 0; i < count; ++i) chunk(i);
    }).join();
  };
  Workers workers(elsewhere, 1);
  CoveredTree model;
  expect_questions("build", 118, [&] { model = build(large(), {.method = Method::octree, .depth = 2}, workers); });
  expect_questions("with_fewer_cuts", 29, [&] { with_fewer_cuts(large(), model, workers); });
}

}  // namespace
}  // namespace morula::test
