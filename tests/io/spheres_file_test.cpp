// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Archives of spheres, taken apart again by another reading of the format.
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <morula/io/spheres_file.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <support/zip.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

template <class Value>
Value at(const std::string& bytes, std::size_t offset) {
  Value value{};
  if (offset + sizeof value > bytes.size()) throw std::out_of_range("past the end");
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// The files of an archive, found from its end as unzip does; every local header must agree with the directory.
std::map<std::string, std::string> unzipped(const std::string& bytes) {
  std::map<std::string, std::string> files;
  const std::size_t end = bytes.size() - 22;
  EXPECT_EQ(at<std::uint32_t>(bytes, end), 0x06054b50u);
  const auto count = at<std::uint16_t>(bytes, end + 10);
  std::size_t entry = at<std::uint32_t>(bytes, end + 16);
  EXPECT_EQ(entry + at<std::uint32_t>(bytes, end + 12), end);
  for (int k = 0; k < count; ++k) {
    EXPECT_EQ(at<std::uint32_t>(bytes, entry), 0x02014b50u);
    const auto size = at<std::uint32_t>(bytes, entry + 24);
    const auto name_size = at<std::uint16_t>(bytes, entry + 28);
    const std::string name = bytes.substr(entry + 46, name_size);
    const std::size_t local = at<std::uint32_t>(bytes, entry + 42);
    EXPECT_EQ(at<std::uint32_t>(bytes, local), 0x04034b50u);
    EXPECT_EQ(bytes.substr(local + 4, 26), bytes.substr(entry + 6, 26)) << name;
    EXPECT_EQ(bytes.substr(local + 30, name_size), name);
    EXPECT_EQ(at<std::uint32_t>(bytes, entry + 20), size) << "stored, so both sizes are the same";
    const std::string contents = bytes.substr(local + 30 + name_size, size);
    EXPECT_EQ(at<std::uint32_t>(bytes, entry + 16), plain_crc(contents)) << name;
    files[name] = contents;
    entry += 46 + name_size;
  }
  return files;
}

// The numbers of an array file whose header promises this type and shape.
template <class Value>
std::vector<Value> numbers(const std::string& npy, const std::string& descr, const std::string& shape) {
  EXPECT_EQ(npy.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t data = 10 + at<std::uint16_t>(npy, 8);
  EXPECT_EQ(data % 64, 0u);
  EXPECT_EQ(npy.substr(10, data - 10).find("{'descr': '" + descr + "', 'fortran_order': False, 'shape': " + shape), 0u)
      << npy.substr(10, data - 10);
  std::vector<Value> values((npy.size() - data) / sizeof(Value));
  std::memcpy(values.data(), npy.data() + data, values.size() * sizeof(Value));
  return values;
}

TEST(SpheresFile, reads_back_bit_for_bit) {
  const ScratchFolder folder;
  const SphereTree tree = small_built(small_mesh()).tree;
  const std::size_t nodes = tree.node_count();
  const std::vector<double> awkward = awkward_numbers();
  const fs::path path = folder.path() / "spheres.npz";
  SphereFramesWriter writer(path, tree, 3);
  std::vector<double> written;
  for (std::size_t frame = 0; frame < 3; ++frame) {
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < nodes; ++i) {
      const double number = awkward[(i + frame) % awkward.size()];
      spheres.push_back({{number, static_cast<double>(i), 0.1}, static_cast<double>(frame)});
      written.insert(written.end(), {number, static_cast<double>(i), 0.1, static_cast<double>(frame)});
    }
    writer.write(spheres);
  }
  EXPECT_FALSE(fs::exists(path));
  writer.finish();
  EXPECT_EQ(folder.names(), std::vector<std::string>{"spheres.npz"});

  auto files = unzipped(bytes_of(path));
  EXPECT_EQ(files.size(), 5u);
  const std::string n = std::to_string(nodes);
  const auto spheres = numbers<double>(files["spheres.npy"], "<f8", "(3, " + n + ", 4)");
  ASSERT_EQ(spheres.size(), written.size());
  EXPECT_EQ(std::memcmp(spheres.data(), written.data(), written.size() * sizeof(double)), 0);
  const auto same = [&](const std::string& name, const std::vector<std::uint32_t>& expected) {
    const auto values =
        numbers<std::int32_t>(files[name + ".npy"], "<i4", "(" + std::to_string(expected.size()) + ",)");
    ASSERT_EQ(values.size(), expected.size()) << name;
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_EQ(values[i], expected[i] == no_node ? -1 : static_cast<int>(expected[i])) << name << ' ' << i;
  };
  same("level_begin", tree.level_begin);
  same("parent", tree.parent);
  same("first_child", tree.first_child);
  same("child_count", tree.child_count);
}

TEST(SpheresFile, says_that_the_tree_is_nested_where_every_frame_is) {
  const ScratchFolder folder;
  SphereTree tree = small_built(small_mesh()).tree;
  const std::vector<Sphere> outside = tree.spheres;
  make_nested(tree);
  const fs::path path = folder.path() / "spheres.npz";
  for (const bool last_is_outside : {false, true}) {
    SphereFramesWriter writer(path, tree, 2);
    writer.write(tree.spheres);
    writer.write(last_is_outside ? outside : tree.spheres);
    writer.finish();
    for (std::size_t frame = 0; frame < 2; ++frame)
      EXPECT_EQ(SphereFrames(path).frame(frame).nested, !last_is_outside) << frame;
  }
}

TEST(SpheresFile, crc_has_the_check_value_of_the_standard) {
  EXPECT_EQ(plain_crc("123456789"), 0xcbf43926u);
}

TEST(SpheresFile, what_cannot_be_written_is_refused) {
  const ScratchFolder folder;
  const SphereTree tree = small_built(small_mesh()).tree;
  const fs::path path = folder.path() / "a.npz";
  EXPECT_THROW(SphereFramesWriter(folder.path() / "a.npy", tree, 1), std::invalid_argument);
  const fs::path nowhere = folder.path() / "nowhere" / "a.npz";
  expect_file_error(nowhere, 0, "there is no such folder", [&] { SphereFramesWriter(nowhere, tree, 1); });
  expect_file_error(path, 0, "4 GiB", [&] { SphereFramesWriter(path, tree, std::size_t{1} << 40); });
  {
    SphereFramesWriter writer(path, tree, 1);
    EXPECT_THROW(writer.write({}), std::invalid_argument);
    expect_file_error(path, 0, "0 of 1 frames were written", [&] { writer.finish(); });
    writer.write(tree.spheres);
    EXPECT_THROW(writer.write(tree.spheres), std::invalid_argument);
    EXPECT_FALSE(fs::exists(path)) << "frames go to a hidden file until the last one is there";
  }
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace morula::test
