// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every version reads the files of every format version that a release has written: tests/golden/files has one of each,
// NAME_V. tests/house/golden_files_test.py reads them by the documented layout alone.
#include <gtest/gtest.h>

#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/tree/cover.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

std::filesystem::path golden(const std::string& name, int version, const std::string& extension) {
  return std::filesystem::path(MORULA_GOLDEN_FILES) / (name + "_" + std::to_string(version) + extension);
}

Mesh golden_mesh() {
  return read_mesh(std::filesystem::path(MORULA_GOLDEN_FILES) / "octahedron.obj");
}

constexpr int newest_tree = 1;
constexpr int newest_spheres = 1;

TEST(FormatVersions, trees_of_each_version_are_read_and_cover) {
  const Mesh mesh = golden_mesh();
  for (int version = 1; version <= newest_tree; ++version) {
    const CoveredTree model = read_covered_tree(golden("tree", version, ".morula"), mesh);
    EXPECT_TRUE(validate(mesh, model).empty()) << version;
    EXPECT_EQ(model.tree.node_count(), 21u);
    EXPECT_EQ(model.tree.level_count(), 3u);
    EXPECT_EQ(model.cover.cut_points.size(), 16u);
    EXPECT_EQ(model.report.method, "octree");
    ASSERT_EQ(model.poses.size(), 1u);
    EXPECT_EQ(model.poses[0].name, "stretch 1.4641 y");
    EXPECT_EQ(model.poses[0].model->tree.node_count(), 21u);
  }
}

TEST(FormatVersions, spheres_of_each_version_are_read) {
  const SphereTree expected = read_tree(golden("tree", 1, ".morula")).tree;
  for (int version = 1; version <= newest_spheres; ++version)
    EXPECT_TRUE(same_bits(read_tree(golden("spheres", version, ".json")).tree, expected)) << version;
}

// A change of the writer that older readers do not understand needs a new version, and a new file here.
TEST(FormatVersions, the_newest_is_written_as_it_was) {
  const ScratchFolder folder;
  const auto tree = golden("tree", newest_tree, ".morula"), spheres = golden("spheres", newest_spheres, ".json");
  write_tree(folder.path() / "a.morula", read_covered_tree(tree, golden_mesh()));
  EXPECT_EQ(bytes_of(folder.path() / "a.morula"), bytes_of(tree));
  write_tree(folder.path() / "a.json", read_tree(spheres).tree);
  EXPECT_EQ(bytes_of(folder.path() / "a.json"), bytes_of(spheres));
}

}  // namespace
}  // namespace morula::test
