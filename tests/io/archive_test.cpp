// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Archives of NumPy: trees, spheres of frames and motions, those that another program would write among them.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <support/allocations.hpp>
#include <support/npy.hpp>
#include <support/zip.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

/// A root with two children, as lists of another program: 64-bit integers, no branching.
std::vector<ZipMember> small_tree() {
  return {{"spheres.npy", npy("<f8", "(3, 4)", std::vector<double>({0, 0, 0, 2, -1, 0, 0, 1, 1, 0, 0, 1}))},
          {"level_begin.npy", npy("<i8", "(3,)", std::vector<std::int64_t>({0, 1, 3}))},
          {"parent.npy", npy("<i8", "(3,)", std::vector<std::int64_t>({-1, 0, 0}))},
          {"first_child.npy", npy("<i4", "(3,)", std::vector<std::int32_t>({1, -1, -1}))},
          {"child_count.npy", npy("<u4", "(3,)", std::vector<std::uint32_t>({2, 0, 0}))}};
}

TEST(TreeArchive, reads_back_bit_for_bit) {
  const ScratchFolder folder;
  const SphereTree tree = small_built(small_mesh()).tree;
  write_tree(folder.path() / "a.npz", tree);
  EXPECT_TRUE(same_bits(read_tree(folder.path() / "a.npz").tree, tree));
  write_tree(folder.path() / "b.npz", small_built(small_mesh()));
  EXPECT_EQ(bytes_of(folder.path() / "a.npz"), bytes_of(folder.path() / "b.npz"));
  EXPECT_FALSE(SphereFrames(folder.path() / "a.npz").is_motion());
  EXPECT_TRUE(holds_spheres(folder.path() / "a.npz"));
}

TEST(TreeArchive, of_another_program_is_read) {
  const ScratchFolder folder;
  const SphereTree tree = read_tree(folder.file("a.npz", zip(small_tree()))).tree;
  EXPECT_EQ(tree.node_count(), 3u);
  EXPECT_EQ(tree.branching, 2u);
  EXPECT_EQ(tree.spheres[2], (Sphere{{1, 0, 0}, 1}));
  auto members = small_tree();
  members.push_back({"branching.npy", npy("<i8", "(1,)", std::vector<std::int64_t>({8}))});
  members.push_back({"notes.txt", "whatever"});
  EXPECT_EQ(read_tree(folder.file("b.npz", zip(members))).tree.branching, 8u);
  members[0].bytes = npy("<f4", "(3, 4)", std::vector<float>({0, 0, 0, 2, -1, 0, 0, 1, 1, 0, 0, 1}));
  EXPECT_EQ(read_tree(folder.file("c.npz", zip(members))).tree.spheres[1].center.x, -1);
}

TEST(TreeArchive, spheres_of_frames_are_read_one_by_one) {
  const ScratchFolder folder;
  const SphereTree tree = small_built(small_mesh()).tree;
  SphereFramesWriter writer(folder.path() / "a.npz", tree, 3);
  for (int frame = 0; frame < 3; ++frame) {
    std::vector<Sphere> spheres = tree.spheres;
    if (frame > 0)  // 0 added to -0 would be 0
      for (Sphere& s : spheres) s.center.x += frame;
    writer.write(spheres);
  }
  writer.finish();
  const SphereFrames frames(folder.path() / "a.npz");
  EXPECT_TRUE(frames.is_motion());
  EXPECT_EQ(frames.frame_count(), 3u);
  SphereTree expected = tree;
  expected.branching = frames.frame(0).branching;  // the archive has the largest number of children alone
  EXPECT_TRUE(same_bits(frames.frame(0), expected));
  EXPECT_EQ(frames.frame(2).spheres[5].center.x, tree.spheres[5].center.x + 2);
  EXPECT_THROW(frames.frame(3), std::invalid_argument);
  expect_file_error(folder.path() / "a.npz", 0, "holds the spheres of 3 frames",
                    [&] { read_tree(folder.path() / "a.npz"); });
}

TEST(TreeArchive, what_is_no_tree_is_refused) {
  const ScratchFolder folder;
  const auto refused = [&](std::vector<ZipMember> members, const std::string& fragment) {
    const fs::path path = folder.file("a.npz", zip(members));
    expect_file_error(path, 0, fragment, [&] { read_tree(path); });
    EXPECT_THROW(SphereFrames{path}, FileError) << fragment;
  };
  const auto with = [&](std::size_t member, const std::string& bytes) {
    auto members = small_tree();
    members[member].bytes = bytes;
    return members;
  };
  for (std::size_t missing = 0; missing < 5; ++missing) {
    auto members = small_tree();
    const std::string name = members[missing].name.substr(0, members[missing].name.size() - 4);
    members.erase(members.begin() + static_cast<std::ptrdiff_t>(missing));
    refused(members, "has no array '" + name + "'");
  }
  refused(with(0, npy("<f8", "(3, 3)", std::string(72, '\0'))), "(nodes, 4) is needed");
  refused(with(0, npy("<f8", "(4, 3)", std::string(96, '\0'))), "array.T");
  refused(with(0, npy("<f8", "(0, 3, 4)", "")), "has no frames");
  refused(with(0, npy("<f8", "(2, 4)", std::string(64, '\0'))), "differ in the number of nodes");
  refused(with(1, npy("<i8", "(3,)", std::vector<std::int64_t>({0, 1, 4}))), "level_begin does not lead");
  refused(with(1, npy("<i8", "(3,)", std::vector<std::int64_t>({0, 1, -1}))), "is -1, which is no index");
  refused(with(1, npy("<i8", "(3,)", std::vector<std::int64_t>({0, 1, 1ll << 40}))), "which is no index");
  refused(with(1, npy("<u8", "(3,)", std::vector<std::uint64_t>({0, 1, ~0ull}))), "which is no index");
  refused(with(1, npy("<f8", "(3,)", std::vector<double>({0, 1, 3}))), "'<i4' or '<i8' is needed");
  refused(with(2, npy("<i8", "(3,)", std::vector<std::int64_t>({-1, 0, 1}))), "parent or first_child are not those");
  refused(with(3, npy("<i4", "(3,)", std::vector<std::int32_t>({2, -1, -1}))), "parent or first_child are not those");
  refused(with(4, npy("<u4", "(3,)", std::vector<std::uint32_t>({1, 0, 0}))), "do not add up");
  refused(with(4, npy("<u4", "(3,)", std::vector<std::uint32_t>({70, 0, 0}))), "the branching is 70, not 2 to 64");
  auto members = small_tree();
  members.push_back({"branching.npy", npy("<i4", "(2,)", std::vector<std::int32_t>({8, 8}))});
  refused(members, "the branching is not one number");
  members = small_tree();
  members[0].method = 8;
  refused(members, "is compressed; save the arrays with numpy.savez");
  members = small_tree();
  members[3].flags = 1;
  refused(members, "is encrypted");

  const fs::path nan = folder.file(
      "nan.npz",
      zip(with(0, npy("<f8", "(3, 4)", std::vector<double>({0, 0, 0, 2, -1, std::nan(""), 0, 1, 1, 0, 0, -1})))));
  expect_file_error(nan, 0, "node 1 has a number that is not finite", [&] { read_tree(nan); });
  std::string damaged = zip(small_tree());
  damaged[200] = static_cast<char>(damaged[200] ^ 1);  // among the spheres
  const fs::path broken = folder.file("broken.npz", damaged);
  expect_file_error(broken, 0, "its checksum differs", [&] { read_tree(broken); });
}

TEST(TreeArchive, archives_that_lie_cost_little_and_are_refused) {
  const ScratchFolder folder;
  const std::string good = zip(small_tree());
  int refused = 0;
  // Every byte of the directory and its end, and of the first local header, set to what hurts most.
  const std::size_t directory = good.find("PK\1\2");
  std::vector<std::size_t> places;
  for (std::size_t at = 0; at < 40; ++at) places.push_back(at);
  for (std::size_t at = directory; at < good.size(); ++at) places.push_back(at);
  for (const std::size_t at : places)
    for (const char value : {'\xff', '\x7f', '\0'}) {
      std::string bytes = good;
      bytes[at] = value;
      const fs::path path = folder.file("a.npz", bytes);
      const std::size_t before = allocated_bytes;
      try {
        EXPECT_TRUE(validate(read_tree(path).tree).empty());
      } catch (const FileError&) {
        ++refused;
      }
      EXPECT_LE(allocated_bytes - before, std::size_t{8} << 20) << at;
    }
  EXPECT_GT(refused, 200);
  for (std::size_t size = 0; size < good.size(); size += 7) {
    const fs::path path = folder.file("a.npz", good.substr(0, size));
    EXPECT_THROW(read_tree(path), FileError) << size;
    EXPECT_FALSE(holds_spheres(path));
  }
}

TEST(MotionArchive, is_its_only_array_or_the_one_called_positions) {
  const ScratchFolder folder;
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  std::vector<double> numbers(18);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i);
  const ZipMember array{"arr_0.npy", npy("<f8", "(2, 3, 3)", raw(numbers))};
  const Motion only(folder.file("only.npz", zip({array})), mesh);
  EXPECT_EQ(only.frame_count(), 2u);
  EXPECT_EQ(only.frame(1)[2], (Vec3{15, 16, 17}));
  EXPECT_EQ(only.frame_name(1), "only.npz frame 1");
  ZipMember positions = array, other = array;
  positions.name = "positions.npy";
  other.bytes = npy("<f8", "(1, 3, 3)", std::string(72, '\0'));
  EXPECT_EQ(Motion(folder.file("two.npz", zip({other, positions})), mesh).frame_count(), 2u);

  const auto refused = [&](const std::vector<ZipMember>& members, const std::string& fragment) {
    const fs::path path = folder.file("a.npz", zip(members));
    expect_file_error(path, 0, fragment, [&] { Motion(path, mesh); });
  };
  ZipMember second = array;
  second.name = "arr_1.npy";
  refused({array, second}, "holds the arrays 'arr_0', 'arr_1', and none is called 'positions'");
  refused({}, "holds no arrays");
  refused({{"readme.txt", "hello"}}, "holds no arrays");
  refused(small_tree(), "holds spheres, not positions of vertices");
  refused({{"arr_0.npy", npy("<f8", "(2, 3, 4)", std::string(192, '\0'))}},
          "transpose it: numpy.save(FILE, array.transpose(0, 2, 1))");
}

TEST(MotionArray, axes_in_another_order_get_the_line_that_transposes_them) {
  const ScratchFolder folder;
  Mesh mesh;
  for (int i = 0; i < 5; ++i) mesh.positions.push_back({static_cast<double>(i), 0, 0});
  mesh.facets = {{0, 1, 2}};
  const auto refused = [&](const std::string& shape, std::size_t numbers, const std::string& fragment) {
    const fs::path path = folder.file("a.npy", npy("<f8", shape, std::string(8 * numbers, '\0')));
    try {
      Motion(path, mesh);
      ADD_FAILURE() << shape << " was read";
    } catch (const FileError& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(fragment), std::string::npos) << text;
      EXPECT_EQ(text.find("reshape"), std::string::npos) << text;
    }
  };
  refused("(7, 3, 5)", 105,
          "(frames, vertices, 3) is needed; the axes are in another order, so transpose it: numpy.save(FILE, "
          "array.transpose(0, 2, 1))");
  refused("(5, 3, 7)", 105, "array.transpose(2, 0, 1)");
  refused("(3, 5, 7)", 105, "array.transpose(2, 1, 0)");
  refused("(5, 7, 3)", 105, "array.transpose(1, 0, 2)");
  refused("(7, 3, 6)", 126, "array.transpose(0, 2, 1)");
  refused("(7, 15)", 105, "save an array with these axes, in this order");
}

TEST(MissingMotion, says_that_there_is_no_such_folder) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  for (const char* name : {"motion", "motion/", "nowhere/motion"})
    expect_file_error(folder.path() / name, 0, "there is no such folder", [&] { Motion(folder.path() / name, mesh); });
  const fs::path pattern = folder.path() / "nowhere" / "*.obj";
  EXPECT_THROW(Motion(pattern, mesh), FileError);
}

TEST(BallFile, reads_back_and_under_a_tree) {
  const ScratchFolder folder;
  const std::vector<Sphere> balls{{{0.1, -2, 3e30}, 1.5}, {{-0.0, 1e-310, 7}, 0}, {{1, 1, 1}, 2}};
  const fs::path path = folder.path() / "balls.ply";
  write_balls(path, balls);
  EXPECT_EQ(read_balls(path), balls);
  EXPECT_TRUE(is_ball_file(path));
  EXPECT_EQ(read_tree(path).tree.leaf_count(), 3u);
  const fs::path text = folder.file("text.ply",
                                    "ply\nformat ascii 1.0\ncomment of another program\nelement vertex 2\n"
                                    "property float radius\nproperty float x\nproperty uchar red\nproperty float y\n"
                                    "property float z\nend_header\n2 1 255 0 0\n3 0 255 1 0.5\n");
  EXPECT_EQ(read_balls(text), (std::vector<Sphere>{{{1, 0, 0}, 2}, {{0, 1, 0.5}, 3}}));
  write_mesh(folder.path() / "mesh.ply", small_mesh());
  EXPECT_FALSE(is_ball_file(folder.path() / "mesh.ply"));
  EXPECT_FALSE(is_ball_file(folder.path() / "missing.ply"));
  expect_file_error(folder.path() / "mesh.ply", 0, "holds no balls", [&] { read_balls(folder.path() / "mesh.ply"); });
  write_balls(path, {});
  expect_file_error(path, 0, "no balls to make a tree of", [&] { read_tree(path); });
  write_balls(path, std::vector<Sphere>{{{0, 0, 0}, -1}});
  expect_file_error(path, 0, "ball 0 has a negative radius", [&] { read_balls(path); });
  const std::string whole = bytes_of(path);
  expect_file_error(folder.file("cut.ply", whole.substr(0, whole.size() - 3)), 0, "the file ends inside row",
                    [&] { read_balls(folder.path() / "cut.ply"); });
}

}  // namespace
}  // namespace morula::test
