// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <morula/io/tree_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <support/meshes.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

// A chain and bushes, early leaves, centers that are hard to write.
SphereTree awkward_tree() {
  const std::vector<double> numbers = awkward_numbers();
  const auto sphere = [&](std::size_t i) {
    return Sphere{{numbers[i % numbers.size()], numbers[(i + 1) % numbers.size()], numbers[(i + 2) % numbers.size()]},
                  std::abs(numbers[(i + 2) % numbers.size()]) + 1e-310};
  };
  SphereTree tree;
  tree.branching = 5;
  std::size_t next = 0;
  const auto append = [&](const std::vector<std::uint32_t>& counts, std::size_t nodes) {
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < nodes; ++i) spheres.push_back(sphere(next++));
    tree.append_level(counts, spheres);
  };
  append({}, 1);
  append({1}, 1);
  append({5}, 5);
  append({0, 2, 0, 1, 5}, 8);
  return tree;
}

TEST(TreeFile, bare_trees_read_back_bit_for_bit) {
  const ScratchFolder folder;
  const SphereTree tree = awkward_tree();
  SphereTree root;
  root.append_level({}, std::vector<Sphere>{{{1, 2, 3}, 4}});
  ASSERT_TRUE(validate(tree).empty());
  for (const std::string extension : {".sph", ".json", ".JSON"})
    for (const SphereTree& written : {tree, root}) {
      const fs::path path = folder.path() / ("tree" + extension);
      write_tree(path, written);
      const TreeFile read = read_tree(path);
      EXPECT_TRUE(same_bits(read.tree, written)) << extension;
      EXPECT_FALSE(read.cover.has_value());
    }
}

TEST(TreeFile, native_files_read_back_bit_for_bit) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  CoveredTree model = small_built(mesh);
  ASSERT_FALSE(model.cover.cut_points.empty());
  model.report.method = "grid";
  model.report.seed = 0xffffffffffffffffu;
  model.report.notes = {"a note", "", "Größe \"1\"\n\\"};
  model.report.growth[0] = {7, std::numeric_limits<double>::infinity(), -0.0};
  model.report.growth[1] = {std::numeric_limits<std::size_t>::max(), 1.0 / 3, 1e-320};
  const fs::path path = folder.path() / "tree.morula";
  write_tree(path, model);
  const TreeFile read = read_tree(path);
  EXPECT_TRUE(same_bits(read.tree, model.tree));
  ASSERT_TRUE(read.cover.has_value());
  EXPECT_TRUE(same_bits(*read.cover, model.cover));
  EXPECT_TRUE(same_bits(read.report, model.report));
  EXPECT_TRUE(validate(mesh, read_covered_tree(path, mesh)).empty());
}

TEST(TreeFile, a_nested_tree_says_so_in_every_format_that_can_and_no_other_file_changes) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const CoveredTree plain = small_built(mesh);
  CoveredTree nested = plain;
  make_nested(nested.tree);
  for (const std::string extension : {".morula", ".json", ".npz", ".sph"}) {
    const fs::path path = folder.path() / ("tree" + extension);
    write_tree(path, plain);
    EXPECT_EQ(bytes_of(path).find("nested"), std::string::npos) << extension;
    EXPECT_FALSE(read_tree(path).tree.nested) << extension;
    write_tree(path, nested);
    const SphereTree read = read_tree(path).tree;
    EXPECT_EQ(read.spheres, nested.tree.spheres) << extension;
    EXPECT_EQ(read.nested, extension != ".sph") << extension;
    EXPECT_TRUE(certify_nesting(read, read.spheres).nested) << extension << ": all numbers come back";
    EXPECT_EQ(read_covered_tree(path, mesh).tree.nested, read.nested) << extension;
  }
}

TEST(TreeFile, one_that_says_it_is_nested_and_is_not_is_refused) {
  const ScratchFolder folder;
  CoveredTree model = small_built(small_mesh());
  ASSERT_FALSE(certify_nesting(model.tree, model.tree.spheres).nested);
  model.tree.nested = true;
  for (const std::string extension : {".morula", ".json", ".npz"})
    EXPECT_THROW(write_tree(folder.path() / ("tree" + extension), model), std::invalid_argument);
  EXPECT_TRUE(folder.names().empty());

  model.tree.nested = false;
  const fs::path json = folder.path() / "tree.json", native = folder.path() / "tree.morula";
  write_tree(json, model.tree);
  std::string text = bytes_of(json);
  const std::string before = text;
  text.insert(text.find("\"nodes\""), "\"nested\": true, ");
  expect_file_error(folder.file("tree.json", text), 0, "says that it is nested", [&] { read_tree(json); });
  text = before;
  text.insert(text.find("\"nodes\""), "\"nested\": 1, ");
  expect_file_error(folder.file("tree.json", text), 0, "neither true nor false", [&] { read_tree(json); });
  make_nested(model.tree);
  write_tree(native, model);
  std::string lying = bytes_of(native);
  // A radius that was made for the children's, taken back.
  const std::string old_radius(reinterpret_cast<const char*>(&model.tree.spheres[0].radius), sizeof(double));
  const double smaller = 0.5;
  const std::size_t at = lying.find(old_radius);
  ASSERT_NE(at, std::string::npos);
  lying.replace(at, sizeof(double), std::string(reinterpret_cast<const char*>(&smaller), sizeof(double)));
  expect_file_error(folder.file("tree.morula", resealed(lying)), 0, "says that it is nested",
                    [&] { read_tree(native); });
}

CoveredTree built_with_poses(const Mesh& mesh) {
  CoveredTree model = small_built(mesh);
  for (const double factor : {1.5, -0.25}) {
    KnownPose pose{"x by " + std::to_string(factor), mesh.positions, nullptr};
    for (Vec3& p : pose.positions) p.x *= factor;
    pose.model = std::make_shared<const CoveredTree>(small_built({pose.positions, mesh.facets}));
    model.poses.push_back(std::move(pose));
  }
  return model;
}

TEST(TreeFile, trees_for_known_poses_read_back_bit_for_bit_and_leave_the_others_where_they_were) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const CoveredTree model = built_with_poses(mesh);
  const fs::path path = folder.path() / "tree.morula";
  write_tree(path, model);
  const CoveredTree read = read_covered_tree(path, mesh);
  EXPECT_TRUE(same_bits(read.tree, model.tree));
  ASSERT_EQ(read.poses.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read.poses[k].name, model.poses[k].name);
    EXPECT_EQ(read.poses[k].positions, model.poses[k].positions);
    EXPECT_TRUE(same_bits(read.poses[k].model->tree, model.poses[k].model->tree));
    EXPECT_TRUE(same_bits(read.poses[k].model->cover, model.poses[k].model->cover));
    EXPECT_TRUE(same_bits(read.poses[k].model->report, model.poses[k].model->report));
  }
  // What a library that knows no poses reads is the file without them: the same arrays under the same names.
  CoveredTree alone = model;
  alone.poses.clear();
  write_tree(folder.path() / "alone.morula", alone);
  EXPECT_TRUE(read_tree(folder.path() / "alone.morula").poses.empty());
  const std::string bytes = bytes_of(path), bytes_alone = bytes_of(folder.path() / "alone.morula");
  EXPECT_EQ(bytes.substr(8, 4), bytes_alone.substr(8, 4)) << "one version";
  const auto data_of = [](const std::string& file) {
    std::uint32_t header_size = 0;
    std::memcpy(&header_size, file.data() + 12, 4);
    return file.substr(24 + header_size);
  };
  const std::string arrays_alone = data_of(bytes_alone);
  EXPECT_EQ(data_of(bytes).substr(0, arrays_alone.size() - 8), arrays_alone.substr(0, arrays_alone.size() - 8));
}

TEST(TreeFile, poses_that_are_not_of_the_mesh_are_neither_written_nor_read) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  CoveredTree model = built_with_poses(mesh);
  const fs::path path = folder.path() / "tree.morula";
  model.poses[1].positions.pop_back();
  EXPECT_THROW(write_tree(path, model), std::invalid_argument);
  model = built_with_poses(mesh);
  model.poses[0].model = nullptr;
  EXPECT_THROW(write_tree(path, model), std::invalid_argument);
  EXPECT_FALSE(fs::exists(path));
  model = built_with_poses(mesh);
  for (Vec3& p : model.poses[1].positions) p.x *= 4;  // outside the spheres that were made for it
  write_tree(path, model);
  EXPECT_THROW(read_covered_tree(path, mesh), FileError);
}

TEST(TreeFile, spheres_of_a_built_tree_can_be_written_alone) {
  const ScratchFolder folder;
  const CoveredTree model = small_built(small_mesh());
  for (const std::string name : {"a.sph", "a.json"}) {
    write_tree(folder.path() / name, model);
    EXPECT_TRUE(same_bits(read_tree(folder.path() / name).tree, model.tree)) << name;
  }
}

TEST(TreeFile, same_tree_gives_same_bytes_in_every_locale) {
  const ScratchFolder folder;
  const CoveredTree model = small_built(small_mesh());
  for (const std::string name : {"a.morula", "a.sph", "a.json"}) {
    write_tree(folder.path() / name, model);
    const CommaLocale commas;
    write_tree(folder.path() / ("again_" + name), model);
    EXPECT_EQ(bytes_of(folder.path() / name), bytes_of(folder.path() / ("again_" + name)));
    EXPECT_TRUE(same_bits(read_tree(folder.path() / name).tree, model.tree));
  }
}

// The layout that docs/reference/formats.md promises: other programs rely on it.
TEST(TreeFile, native_bytes_are_laid_out_as_documented) {
  const ScratchFolder folder;
  const CoveredTree model = small_built(small_mesh());
  write_tree(folder.path() / "a.morula", model);
  const std::string bytes = bytes_of(folder.path() / "a.morula");
  EXPECT_EQ(bytes.substr(0, 8), "MORULA\r\n");
  EXPECT_EQ(bytes.substr(8, 4), raw(std::uint32_t{1}));
  EXPECT_EQ(bytes.substr(16, 8), raw(std::uint64_t{bytes.size()}));
  EXPECT_EQ(resealed(bytes), bytes);
  std::uint32_t header_size = 0;
  std::memcpy(&header_size, bytes.data() + 12, 4);
  const std::size_t data = 24 + header_size;
  EXPECT_EQ(data % 8, 0u);
  EXPECT_EQ(bytes.substr(data, 32), raw(model.tree.spheres[0]));
  EXPECT_EQ(bytes.substr(data + 32 * model.tree.node_count(), 4), raw(model.tree.child_count[0]));
}

TEST(TreeFile, sph_is_written_as_documented) {
  const ScratchFolder folder;
  SphereTree tree;
  tree.branching = 2;
  tree.append_level({}, std::vector<Sphere>{{{0, 0, -0.0}, 1}});
  tree.append_level(std::vector<std::uint32_t>{2}, std::vector<Sphere>{{{0.1, 0, 0}, 0.5}, {{-1e300, 0, 0}, 0.25}});
  tree.append_level(std::vector<std::uint32_t>{0, 1}, std::vector<Sphere>{{{1, 2, 3}, 1e-5}});
  write_tree(folder.path() / "a.sph", tree);
  EXPECT_EQ(bytes_of(folder.path() / "a.sph"),
            "3 2\n0 0 -0 1 1\n0.1 0 0 0.5 1\n-1e+300 0 0 0.25 1\n"
            "0 0 0 -1 0\n0 0 0 -1 0\n1 2 3 1e-05 1\n0 0 0 -1 0\n");
}

// What the published toolkit writes: centers relative to the box center, unused slots with a negative radius that is
// not −1 or with 0, valid-looking nodes below unused ones, options and an evaluation after the last node.
constexpr const char* toolkit_file =
    "3 2\n"
    "0.500000 0.000000 0.000000 10.000000 1.000000\n"
    "-4.000000 0.000000 0.000000 5.000000 1.000000\n"
    "0.000000 0.000000 0.000000 -0.002000 1.000000\n"
    "9.000000 9.000000 9.000000 0.000000 1.000000\n"
    "-5.000000 1.000000 -1.000000 2.500000 1.000000\n"
    "7.000000 7.000000 7.000000 7.000000 1.000000\n"
    "0.000000 0.000000 0.000000 -0.002000 1.000000\n"
    "\n\nOptions :\n  testerLevels = 2\n  nan inf 1e999 %s\n";

TEST(TreeFile, reads_the_toolkits_own_files) {
  const ScratchFolder folder;
  const TreeFile file = read_tree(folder.file("toolkit.sph", toolkit_file), {.sph_origin = {100, 20, 3}});
  SphereTree expected;
  expected.branching = 2;
  expected.append_level({}, std::vector<Sphere>{{{100.5, 20, 3}, 10}});
  expected.append_level(std::vector<std::uint32_t>{1}, std::vector<Sphere>{{{96, 20, 3}, 5}});
  expected.append_level(std::vector<std::uint32_t>{1}, std::vector<Sphere>{{{95, 21, 2}, 2.5}});
  EXPECT_TRUE(same_bits(file.tree, expected));

  std::string windows;
  for (const char c : std::string(toolkit_file)) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_TRUE(same_bits(read_tree(folder.file("windows.sph", windows), {.sph_origin = {100, 20, 3}}).tree, expected));
}

TEST(TreeFile, sph_levels_that_are_all_unused_are_left_out) {
  const ScratchFolder folder;
  const TreeFile file = read_tree(folder.file("a.sph",
                                              "3 2\n0 0 0 1 1\n0 0 0 -1 0\n0 0 0 0 0\n1 1 1 1 1\n1 1 1 1 1\n"
                                              "1 1 1 1 1\n1 1 1 1 1\n"));
  EXPECT_EQ(file.tree.node_count(), 1u);
  EXPECT_EQ(file.tree.level_count(), 1u);
}

TEST(TreeFile, a_bare_tree_gets_a_cover_for_the_mesh) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  SphereTree tree = small_built(mesh).tree;
  for (Sphere& s : tree.spheres) s.radius *= 0.75;  // no longer covers
  for (const std::string name : {"a.sph", "a.json"}) {
    write_tree(folder.path() / name, tree);
    const CoveredTree model = read_covered_tree(folder.path() / name, mesh);
    EXPECT_TRUE(validate(mesh, model).empty());
    EXPECT_EQ(model.report.method, "imported");
    ASSERT_EQ(model.report.growth.size(), model.tree.level_count());
    EXPECT_GT(model.report.growth[0].grown, 0u);
  }
}

TEST(TreeFile, json_may_number_its_nodes_in_any_order) {
  const ScratchFolder folder;
  const TreeFile file = read_tree(folder.file("a.json", R"({"nodes": [
    {"radius": 4, "children": [3, 1], "center": [0, 0, 0], "color": "red"},
    {"radius": 2, "children": [], "center": [1, 0, 0]},
    {"radius": 1, "children": [], "center": [-1e0, 0.5, 0]},
    {"radius": 3, "children": [2], "center": [-1, 0, 0]}],
    "levels": 3, "branching": 2, "version": 1, "format": "morula spheres"})"));
  SphereTree expected;
  expected.branching = 2;
  expected.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 4}});
  expected.append_level(std::vector<std::uint32_t>{2}, std::vector<Sphere>{{{-1, 0, 0}, 3}, {{1, 0, 0}, 2}});
  expected.append_level(std::vector<std::uint32_t>{1, 0}, std::vector<Sphere>{{{-1, 0.5, 0}, 1}});
  EXPECT_TRUE(same_bits(file.tree, expected));
}

TEST(TreeFile, what_a_format_cannot_hold_is_refused_and_nothing_is_written) {
  const ScratchFolder folder;
  const auto refused = [&](const std::string& name, const SphereTree& tree, const std::string& fragment) {
    const fs::path path = folder.path() / name;
    expect_file_error(path, 0, fragment, [&] { write_tree(path, tree); });
  };
  // Nine levels of one node each: ten nodes in memory, 19 million lines in a .sph.
  SphereTree chain;
  chain.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 1}});
  for (int level = 1; level <= max_depth; ++level)
    chain.append_level(std::vector<std::uint32_t>{1}, std::vector<Sphere>{{{0, 0, 0}, 1}});
  refused("chain.sph", chain, "use the native format, .morula");
  SphereTree point;
  point.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 0}});
  refused("point.sph", point, "node 0 has radius 0");
  refused("bare.morula", chain, "holds a tree with its cover");
  refused("tree.txt", chain, "use one of .morula .sph .json");
  refused("tree", chain, "no extension");

  CoveredTree model = small_built(small_mesh());
  EXPECT_THROW(write_tree(folder.path() / "empty.json", SphereTree{}), std::invalid_argument);
  chain.append_level(std::vector<std::uint32_t>{1}, std::vector<Sphere>{{{0, 0, 0}, 1}});
  EXPECT_THROW(write_tree(folder.path() / "deep.json", chain), std::invalid_argument);
  model.tree.spheres[3].radius = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_tree(folder.path() / "nan.json", model), std::invalid_argument);
  EXPECT_THROW(write_tree(folder.path() / "nan.morula", model), std::invalid_argument);
  model = small_built(small_mesh());
  model.cover.corners[5] = 1'000'000;
  EXPECT_THROW(write_tree(folder.path() / "cover.morula", model), std::invalid_argument);
  EXPECT_TRUE(folder.names().empty());

  write_tree(folder.path() / "point.json", point);
  EXPECT_TRUE(same_bits(read_tree(folder.path() / "point.json").tree, point));
}

}  // namespace
}  // namespace morula::test
