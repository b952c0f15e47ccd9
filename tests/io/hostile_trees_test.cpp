// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <morula/io/tree_file.hpp>
#include <morula/version.hpp>
#include <support/meshes.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

void expect_trees_refused(const std::vector<HostileFile>& files) {
  test::expect_all_refused(files, [](const fs::path& path) { read_tree(path); });
}

TEST(HostileTrees, sph) {
  const std::string root = "0 0 0 1 1\n";
  expect_trees_refused({
      {"empty.sph", "", 1, "the file is empty"},
      {"one_number.sph", "3\n", 1, "the line ends where the branching should be"},
      {"words.sph", "four eight\n", 1, "'four' is not a whole number"},
      {"negative_levels.sph", "-4 8\n", 1, "the number of levels is -4"},
      {"negative_branching.sph", "4 -8\n", 1, "the branching is -8"},
      {"no_levels.sph", "0 8\n", 1, "the tree has 0 levels, not 1 to 9"},
      {"many_levels.sph", "10 2\n", 1, "the tree has 10 levels, not 1 to 9"},
      {"narrow.sph", "3 1\n", 1, "the branching is 1, not 2 to 64"},
      {"wide.sph", "2 65\n", 1, "the branching is 65, not 2 to 64"},
      {"too_big.sph", "9 8\n", 1, "use the native format, .morula"},
      {"overflowing.sph", "9 64\n" + root, 1, "use the native format, .morula"},
      {"third_number.sph", "1 8 1\n" + root, 1, "'1' follows the branching"},
      {"only_header.sph", "4 8\n", 1, "ends after 0 of 585 nodes"},
      {"too_few.sph", "2 2\n" + root + root, 3, "ends after 2 of 3 nodes"},
      {"text_too_early.sph", "2 2\n" + root + root + "Options\n", 4, "'Options' is not a number"},
      {"four_numbers.sph", "1 8\n0 0 0 1\n", 2, "the line ends where the weight should be"},
      {"six_numbers.sph", "1 8\n0 0 0 1 1 1\n", 2, "'1' follows x y z r w"},
      {"nan_radius.sph", "2 2\n" + root + "0 0 0 nan 1\n" + root, 3, "the radius is not finite"},
      {"infinite_center.sph", "1 8\n0 inf 0 1 1\n", 2, "y is not finite"},
      {"unused_root.sph", "2 2\n0 0 0 -0.002 1\n" + root + root, 2, "the root's radius is not above 0"},
      {"zero_root.sph", "1 2\n0 0 0 0 1\n", 2, "the root's radius is not above 0"},
  });
}

TEST(HostileTrees, sph_origin) {
  const ScratchFolder folder;
  const fs::path path = folder.file("a.sph", "1 8\n1e308 0 0 1 1\n");
  EXPECT_THROW(read_tree(path, {.sph_origin = {0, std::numeric_limits<double>::quiet_NaN(), 0}}),
               std::invalid_argument);
  expect_file_error(path, 0, "not finite", [&] { read_tree(path, {.sph_origin = {1.7e308, 0, 0}}); });
}

std::string json_tree(const std::string& nodes, const std::string& levels = "1", const std::string& branching = "2") {
  return "{\"format\": \"morula spheres\", \"version\": 1, \"branching\": " + branching + ", \"levels\": " + levels +
         ",\n\"nodes\": " + nodes + "}\n";
}

std::string node(const std::string& children, const std::string& radius = "1",
                 const std::string& center = "[0, 0, 0]") {
  return "{\"center\": " + center + ", \"radius\": " + radius + ", \"children\": " + children + "}";
}

TEST(HostileTrees, json) {
  std::string deep;
  for (int i = 1; i < 10; ++i) deep += node("[" + std::to_string(i) + "]") + ", ";
  expect_trees_refused({
      {"empty.json", "", 1, "is not JSON here"},
      {"truncated.json", json_tree("[" + node("[]")).substr(0, 120), 2, "is not JSON here"},
      {"broken.json", "{\n\"format\": \"morula spheres\",\n\"version\" 1}\n", 3, "is not JSON here"},
      {"nan.json", json_tree("[" + node("[]", "NaN") + "]"), 2, "is not JSON here"},
      {"too_large.json", json_tree("[" + node("[]", "1e999") + "]"), 0, "too large for double precision"},
      {"not_utf8.json", "{\"format\": \"\xff\xfe\"}", 1, "is not JSON here"},
      {"nested.json", std::string(200'000, '['), 1, "is not JSON here"},
      {"list.json", "[]", 0, "is JSON, but not a sphere tree"},
      {"number.json", "7", 0, "is JSON, but not a sphere tree"},
      {"other.json", "{\"format\": \"report\"}", 0, "is JSON, but not a sphere tree"},
      {"format_type.json", "{\"format\": 1}", 0, "is JSON, but not a sphere tree"},
      {"no_version.json", "{\"format\": \"morula spheres\"}", 0, "the file has no \"version\""},
      {"next_version.json", "{\"format\": \"morula spheres\", \"version\": 2}", 0,
       "format version 2 is newer than Morula " + std::string(version) +
           ", which reads versions up to 1; update Morula, or write"},
      {"version_type.json", "{\"format\": \"morula spheres\", \"version\": \"1\"}", 0, "\"version\" of the file"},
      {"no_nodes.json", json_tree("[]"), 0, "\"nodes\" is not a list of at least one node"},
      {"nodes_type.json", json_tree("{}"), 0, "\"nodes\" is not a list"},
      {"node_type.json", json_tree("[1]"), 0, "node 0 is not an object"},
      {"narrow.json", json_tree("[" + node("[]") + "]", "1", "1"), 0, "the branching is 1, not 2 to 64"},
      {"branching_type.json", json_tree("[" + node("[]") + "]", "1", "-8"), 0, "\"branching\" of the file"},
      {"levels.json", json_tree("[" + node("[]") + "]", "2"), 0, "\"levels\" is 2, but the nodes form 1"},
      {"center_type.json", json_tree("[" + node("[]", "1", "0") + "]"), 0, "the center of node 0 is not a list"},
      {"center_size.json", json_tree("[" + node("[]", "1", "[0, 0]") + "]"), 0, "the center of node 0"},
      {"center_text.json", json_tree("[" + node("[]", "1", "[0, 0, \"0\"]") + "]"), 0, "the center of node 0"},
      {"center_null.json", json_tree("[" + node("[]", "1", "[0, 0, null]") + "]"), 0, "the center of node 0"},
      {"radius_type.json", json_tree("[" + node("[]", "true") + "]"), 0, "the radius of node 0 is not a number"},
      {"radius_negative.json", json_tree("[" + node("[]", "-1") + "]"), 0, "node 0 has a negative radius"},
      {"no_radius.json", json_tree("[{\"center\": [0, 0, 0], \"children\": []}]"), 0, "node 0 has no \"radius\""},
      {"no_children.json", json_tree("[{\"center\": [0, 0, 0], \"radius\": 1}]"), 0, "node 0 has no \"children\""},
      {"children_type.json", json_tree("[" + node("1") + "]"), 0, "the children of node 0 are not a list"},
      {"child_beyond.json", json_tree("[" + node("[1]") + "]"), 0, "a child of node 0 is not the number of a node"},
      {"child_negative.json", json_tree("[" + node("[-1]") + "]"), 0, "a child of node 0"},
      {"child_fraction.json", json_tree("[" + node("[0.5]") + "]"), 0, "a child of node 0"},
      {"own_child.json", json_tree("[" + node("[0]") + "]"), 0, "node 0 has two parents, or is its own ancestor"},
      {"two_parents.json",
       json_tree("[" + node("[1, 2]") + ", " + node("[3]") + ", " + node("[3]") + ", " + node("[]") + "]", "3"), 0,
       "node 3 has two parents"},
      {"orphan.json", json_tree("[" + node("[]") + ", " + node("[]") + "]"), 0, "node 1 has no parent"},
      {"many_children.json",
       json_tree("[" + node("[1, 2, 3]") + ", " + node("[]") + ", " + node("[]") + ", " + node("[]") + "]", "2"), 0,
       "node 0 has 3 children, more than the branching"},
      {"deep.json", json_tree("[" + deep + node("[]") + "]", "10"), 0, "more than 9 levels"},
  });
}

// A native file whose parts can be forged one by one; sealed again with the checksum that its contents call for.
class NativeForge {
 public:
  explicit NativeForge(std::string bytes) : bytes_(std::move(bytes)) {
    std::uint32_t header = 0;
    std::memcpy(&header, bytes_.data() + 12, sizeof header);
    data_ = 24 + header;
  }
  /// Replaces text in the JSON header.
  std::string with_header(const std::string& old_text, const std::string& new_text) const {
    std::string header = bytes_.substr(24, data_ - 24);
    const std::size_t at = header.find(old_text);
    EXPECT_NE(at, header.npos) << old_text;
    header.replace(at, old_text.size(), new_text);
    std::string forged = bytes_.substr(0, 24) + header + bytes_.substr(data_);
    return resealed(forged.replace(12, 4, raw(static_cast<std::uint32_t>(header.size()))));
  }
  /// Replaces one entry of an array.
  template <class Value>
  std::string with(const std::string& array, std::size_t index, Value value) const {
    const std::size_t name = bytes_.find("\"name\": \"" + array + "\"");
    EXPECT_LT(name, data_) << array;
    const std::size_t offset = std::stoul(bytes_.substr(bytes_.find("\"offset\": ", name) + 10));
    std::string forged = bytes_;
    return resealed(forged.replace(data_ + offset + index * sizeof value, sizeof value, raw(value)));
  }

 private:
  std::string bytes_;
  std::size_t data_;
};

TEST(HostileTrees, native) {
  const ScratchFolder folder;
  const CoveredTree model = small_built(small_mesh());
  write_tree(folder.path() / "good.morula", model);
  const std::string good = bytes_of(folder.path() / "good.morula");
  const NativeForge forge(good);
  const std::uint32_t no_such = 0xffffffffu;
  const auto cut_vertices = static_cast<std::uint32_t>(model.cover.cut_points.size() + model.cover.vertex_count);
  const std::size_t nodes = model.tree.node_count();
  const double nan = std::numeric_limits<double>::quiet_NaN();

  std::vector<HostileFile> files{
      {"empty.morula", "", 0, "byte 0: not a .morula file"},
      {"magic.morula", "X" + good.substr(1), 0, "not a .morula file"},
      {"text_mode.morula", std::string(good).erase(6, 1), 0, "changed by a program that took it for text"},
      {"only_magic.morula", good.substr(0, 8), 0, "byte 8: the file ends inside the header"},
      {"version_2.morula", std::string(good).replace(8, 4, raw(2u)), 0,
       "format version 2 is newer than Morula " + std::string(version) +
           ", which reads versions up to 1; update Morula, or build"},
      {"version_0.morula", resealed(std::string(good).replace(8, 4, raw(0u))), 0,
       "format version 0 does not exist; build"},
      {"only_start.morula", good.substr(0, 24), 0, "the file has 24 bytes instead of "},
      {"truncated.morula", good.substr(0, good.size() - 1), 0, "bytes instead of " + std::to_string(good.size())},
      {"longer.morula", good + "x", 0, "bytes instead of " + std::to_string(good.size())},
      {"huge_header.morula", resealed(std::string(good).replace(12, 4, raw(no_such))), 0, "claims 4294967295 bytes"},
      {"no_header.morula", resealed(std::string(good).replace(12, 4, raw(0u))), 1, "is not JSON here"},
      {"half_header.morula", resealed(std::string(good).replace(12, 4, raw(64u))), 5, "is not JSON here"},
      {"broken_header.morula", forge.with_header("\"mesh\":", "\"mesh\""), 2, "is not JSON here"},
      {"bracket.morula", forge.with_header("{", "[{"), 110, "is not JSON here"},
      {"no_mesh.morula", forge.with_header("\"mesh\"", "\"mess\""), 0, "the header has no \"mesh\""},
      {"no_arrays.morula", forge.with_header("\"arrays\"", "\"array\""), 0, "the header has no \"arrays\""},
      {"no_report.morula", forge.with_header("\"report\"", "\"rumor\""), 0, "the header has no \"report\""},
      {"no_tree.morula", forge.with_header("\"tree\"", "\"wood\""), 0, "the header has no \"tree\""},
      {"hash.morula", forge.with_header("\"hash\": \"", "\"hash\": \"0"), 0, "not a string of 16 hexadecimal digits"},
      {"hash_type.morula", forge.with_header("\"hash\": ", "\"hash\": 7, \"was\": "), 0, "16 hexadecimal digits"},
      {"vertices.morula", forge.with_header("\"vertices\": ", "\"vertices\": 9999999999"), 0, "does not fit 32 bits"},
      {"branching.morula", forge.with_header("\"branching\": 8", "\"branching\": 65"), 0, "branching 65 is not in 2"},
      {"few_children.morula", forge.with_header("\"branching\": 8", "\"branching\": 7"), 0, "more than the branching"},
      {"seed.morula", forge.with_header("\"seed\": 0", "\"seed\": -1"), 0,
       "\"seed\" of the report is not a whole number"},
      {"method.morula", forge.with_header("\"imported\"", "[]"), 0, "the method is not a string"},
      {"growth.morula", forge.with_header("\"growth\": ", "\"growth\": 7, \"was\": "), 0, "is not a list"},
      {"factor.morula", forge.with_header("\"largest_factor\": ", "\"largest_factor\": \"big\", \"was\": "), 0,
       "\"largest_factor\" of the report is not a number"},
      {"notes.morula", forge.with_header("\"notes\": [", "\"notes\": [1"), 0, "a note is not a string"},
      {"table.morula", forge.with_header("\"arrays\": [", "\"arrays\": 7, \"was\": ["), 0, "arrays is not a list"},
      {"no_array.morula", forge.with_header("\"corners\"", "\"corner\""), 0, "array corners is missing"},
      {"array_entry.morula", forge.with_header("\"arrays\": [", "\"arrays\": [1, "), 0, "an array has no \"name\""},
      {"array_type.morula", forge.with_header("float64", "float32"), 0, "array spheres is not of type float64"},
      {"array_width.morula", forge.with_header("\"width\": 4", "\"width\": 3"), 0, "array spheres is not of type"},
      {"array_offset.morula", forge.with_header("\"offset\": 0", "\"offset\": 18446744073709551615"), 0,
       "array spheres reaches past the end"},
      {"array_rows.morula", forge.with_header("\"rows\": 11", "\"rows\": 576460752303423499"), 0,
       "array spheres reaches past the end"},
      {"array_short.morula", forge.with_header("\"rows\": 11", "\"rows\": 10"), 0, "spheres and child_count differ"},
      {"nan.morula", forge.with("spheres", 5, nan), 0, "the tree is broken: node 1 has a number that is not finite"},
      {"negative_radius.morula", forge.with("spheres", 3, -1.0), 0, "node 0 has a negative radius"},
      {"child_count.morula", forge.with("child_count", 0, 7u), 0, "do not add up"},
      {"child_count_wraps.morula", forge.with("child_count", 0, no_such), 0, "do not add up"},
      {"child_of_last.morula", forge.with("child_count", nodes - 1, 1u), 0, "the last level has children"},
      {"level_begin.morula", forge.with("level_begin", 2, 0u), 0, "is empty or out of order"},
      {"level_beyond.morula", forge.with("level_begin", 2, no_such), 0, "is empty or out of order"},
      {"two_roots.morula", forge.with("level_begin", 1, 2u), 0, "level_begin does not lead from a single root"},
      {"last_level.morula", forge.with("level_begin", 3, no_such), 0, "level_begin does not lead"},
      {"cut_vertex.morula", forge.with("cut_point_vertices", 4, no_such), 0, "cut point 1 refers to vertex 4294967295"},
      {"cut_weight_nan.morula", forge.with("cut_point_weights", 3, nan), 0, "cut point 1 has a weight that is not in"},
      {"cut_weight_big.morula", forge.with("cut_point_weights", 3, 2.0), 0, "cut point 1 has a weight that is not in"},
      {"cut_weight_sum.morula", forge.with("cut_point_weights", 0, 1e-3), 0, "cut point 0 has weights that do not add"},
      {"patch_facet.morula", forge.with("patch_facet", 2, 108u), 0, "patch 2 lies on facet 108 of 108"},
      {"corner_begin.morula", forge.with("corner_begin", 0, 1u), 0, "corner_begin does not span"},
      {"corner_order.morula", forge.with("corner_begin", 1, no_such), 0, "patch 1 has fewer than 3 corners"},
      {"corner_few.morula", forge.with("corner_begin", 1, 2u), 0, "patch 0 has fewer than 3 corners"},
      {"corner.morula", forge.with("corners", 7, cut_vertices), 0,
       "a patch has corner " + std::to_string(cut_vertices)},
      {"root_region.morula", forge.with("region_end", 0, 1u), 0, "the root does not own the whole surface"},
      {"region_beyond.morula", forge.with("region_end", nodes - 1, no_such), 0, "region of node "},
      {"region_backwards.morula", forge.with("region_begin", 1, no_such), 0, "the regions of node 0's children"},
  };
  // Any damage at all is found, wherever it is.
  for (std::size_t at = 24; at < good.size(); at += 97) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
    files.push_back({"flipped_" + std::to_string(at) + ".morula", flipped, 0, "the checksum does not match"});
  }
  expect_trees_refused(files);
  EXPECT_TRUE(same_bits(read_tree(folder.file("copy.morula", good)).tree, model.tree));
}

TEST(HostileTrees, native_poses) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  CoveredTree model = small_built(mesh);
  model.poses.push_back({"as at rest", mesh.positions, std::make_shared<const CoveredTree>(small_built(mesh))});
  write_tree(folder.path() / "good.morula", model);
  const std::string good = bytes_of(folder.path() / "good.morula");
  const NativeForge forge(good);
  const std::uint32_t no_such = 0xffffffffu;
  expect_trees_refused(
      {{"list.morula", forge.with_header("\"poses\": [", "\"poses\": 7, \"was\": ["), 0, "\"poses\" is not a list"},
       {"name.morula", forge.with_header("\"as at rest\"", "7"), 0, "the name of a pose is not a string"},
       {"no_name.morula", forge.with_header("\"name\": \"as at rest\"", "\"nome\": \"as at rest\""), 0,
        "a pose has no \"name\""},
       {"no_positions.morula", forge.with_header("\"pose 0 positions\"", "\"pose 0 position\""), 0,
        "array pose 0 positions is missing"},
       {"spheres.morula", forge.with("pose 0 spheres", 3, -1.0), 0, "node 0 has a negative radius"},
       {"child_count.morula", forge.with("pose 0 child_count", 0, no_such), 0, "do not add up"},
       {"patch_facet.morula", forge.with("pose 0 patch_facet", 2, no_such), 0, "pose 0: patch 2 lies on facet"},
       {"corners.morula", forge.with("pose 0 corners", 7, no_such), 0, "pose 0: a patch has corner"}});
}

TEST(HostileTrees, native_file_of_another_mesh) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const fs::path path = folder.path() / "a.morula";
  write_tree(path, small_built(mesh));
  Mesh moved = mesh;
  moved.positions[3].x = std::nextafter(moved.positions[3].x, 9.0);
  for (const Mesh& other : {moved, box_mesh({-1, -1, -1}, {1, 1, 1}, 2)})
    expect_file_error(path, 0, "was built for another mesh", [&] { read_covered_tree(path, other); });
  EXPECT_THROW(read_covered_tree(path, Mesh{}), std::invalid_argument);
  EXPECT_NO_THROW(read_covered_tree(path, mesh));
}

TEST(HostileTrees, native_file_whose_spheres_do_not_cover) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const CoveredTree model = small_built(mesh);
  write_tree(folder.path() / "a.morula", model);
  const double smaller = model.tree.spheres[5].radius / 2;
  const fs::path path =
      folder.file("b.morula", NativeForge(bytes_of(folder.path() / "a.morula")).with("spheres", 4 * 5 + 3, smaller));
  EXPECT_NO_THROW(read_tree(path));
  expect_file_error(path, 0, "node 5 does not wrap its region", [&] { read_covered_tree(path, mesh); });
}

TEST(HostileTrees, spheres_beyond_all_range_are_refused_by_name) {
  const ScratchFolder folder;
  const fs::path path = folder.file("a.sph", "1 8\n0 0 0 1e300 1\n");
  EXPECT_NO_THROW(read_tree(path));
  expect_file_error(path, 0, "beyond 1e30", [&] { read_covered_tree(path, small_mesh()); });
}

// A patch that shows one corner twice leaves a part of its facet to nobody, and every corner is still covered.
TEST(HostileTrees, native_file_whose_patches_leave_surface_to_nobody) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  CoveredTree model = small_built(mesh);
  const std::uint32_t first = model.cover.corner_begin[3];
  model.cover.corners[first] = model.cover.corners[first + 1];
  ASSERT_TRUE(certify(model.cover, mesh.positions, model.tree.spheres).covered);
  const fs::path path = folder.path() / "a.morula";
  write_tree(path, model);
  expect_file_error(path, 0, "instead of the whole", [&] { read_covered_tree(path, mesh); });
}

TEST(HostileTrees, names_that_are_not_tree_files) {
  const ScratchFolder folder;
  const auto refused = [&](const fs::path& path, const std::string& fragment) {
    expect_file_error(path, 0, fragment, [&] { read_tree(path); });
    expect_file_error(path, 0, fragment, [&] { read_covered_tree(path, small_mesh()); });
  };
  refused(folder.path() / "missing.sph", "there is no such file");
  refused(folder.path() / "missing.morula", "there is no such file");
  fs::create_directory(folder.path() / "folder.json");
  refused(folder.path() / "folder.json", "is a folder, not a file");
  refused(folder.file("tree.obj", "1 8\n"),
          "extension '.obj' says no known tree format; use one of .morula .sph .json");
  refused(folder.file("tree", "1 8\n"), "no extension says no known tree format");
}

}  // namespace
}  // namespace morula::test
