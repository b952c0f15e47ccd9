// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that promise more than they hold: no count in a file of about a kilobyte makes a reader allocate much.
#include <gtest/gtest.h>

#include <cstring>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>
#include <support/allocations.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

// Numbers that no file of a kilobyte can mean.
const std::vector<std::string> large_counts{
    "1000000",    "2147483647",          "2147483648",          "4294967295",
    "4294967296", "4611686018427387904", "9223372036854775807", "18446744073709551615"};

class Memory : public testing::Test {
 protected:
  template <class Read>
  void refused_with_little(const std::string& name, const std::string& bytes, const Read& read) {
    ASSERT_LE(bytes.size(), 8192u) << "the file is no small one";
    const fs::path path = folder.file(name, bytes);
    const std::size_t before = allocated_bytes;
    EXPECT_THROW(read(path), FileError) << name << ": " << bytes.substr(0, 200);
    // All allocations together, those freed meanwhile included.
    EXPECT_LE(allocated_bytes - before, std::size_t{64} << 20) << name << ": " << bytes.substr(0, 200);
  }

  const ScratchFolder folder;
};

TEST_F(Memory, of_mesh_readers_does_not_follow_counts) {
  const auto read = [](const fs::path& path) { read_mesh(path); };
  for (const std::string& n : large_counts) {
    refused_with_little("a.obj", "v 0 0 0\nf 1 1 " + n + "\n", read);
    refused_with_little("a.off", "OFF " + n + " 1 0\n0 0 0\n", read);
    refused_with_little("a.off", "OFF 1 " + n + " 0\n0 0 0\n3 0 0 0\n", read);
    refused_with_little("a.off", "OFF 1 1 0\n0 0 0\n" + n + " 0 0 0\n", read);
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      const std::string head = "ply\nformat " + format + " 1.0\n";
      const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
      const std::string corners = "property list uint uint vertex_indices\nend_header\n";
      refused_with_little("a.ply", head + "element vertex " + n + "\n" + xyz + "element face 1\n" + corners, read);
      refused_with_little("a.ply", head + "element vertex 1\n" + xyz + "element face " + n + "\n" + corners, read);
      refused_with_little(
          "a.ply",
          head + "element other " + n + "\nproperty char a\nelement vertex 1\n" + xyz + "element face 1\n" + corners,
          read);
      // Rows that take no space at all.
      refused_with_little(
          "a.ply", head + "element other " + n + "\nelement vertex 0\n" + xyz + "element face 0\n" + corners, read);
      // A list that is too long, in text and in both orders of bytes.
      const std::string one = head + "element vertex 1\n" + xyz + "element face 1\n" + corners;
      refused_with_little("a.ply", one + "0 0 0\n" + n + " 0 0 0\n", read);
      refused_with_little("a.ply", one + std::string(12, '\0') + std::string(8, '\xff'), read);
      refused_with_little("a.ply", one + std::string(12, '\0') + "\x7f\xff\xff\xff" + std::string(12, '\0'), read);
    }
  }
  for (const std::uint32_t n : {1u, 0x7fffffffu, 0x80000000u, 0xffffffffu})
    refused_with_little("a.stl", std::string(80, ' ') + raw(n) + std::string(n == 1 ? 49 : 50, '\0'), read);
}

TEST_F(Memory, of_tree_readers_does_not_follow_counts) {
  const auto read = [](const fs::path& path) { read_tree(path); };
  for (const std::string& n : large_counts) {
    refused_with_little("a.sph", n + " 8\n0 0 0 1 1\n", read);
    refused_with_little("a.sph", "2 " + n + "\n0 0 0 1 1\n", read);
    refused_with_little("a.json",
                        R"({"format":"morula spheres","version":1,"branching":8,"levels":)" + n +
                            R"(,"nodes":[{"center":[0,0,0],"radius":1,"children":[]}]})",
                        read);
    refused_with_little("a.json",
                        R"({"format":"morula spheres","version":1,"branching":8,"levels":2,"nodes":[{"center":[0,0,0],)"
                        R"("radius":1,"children":[)" +
                            n + "]}]}",
                        read);
  }
  // The most slots that a .sph may have, and none of them there.
  refused_with_little("a.sph", "8 9\n0 0 0 1 1\n", read);
  refused_with_little("a.json", std::string(4000, '['), read);
  refused_with_little("a.json", std::string(2000, '[') + std::string(2000, ']'), read);
}

TEST_F(Memory, of_native_trees_does_not_follow_the_table) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {Facet{0, 1, 2}}};
  SphereTree tree;
  tree.append_level({}, std::vector<Sphere>{{{0.5, 0.5, 0}, 1}});
  write_tree(folder.path() / "a.morula", cover(mesh, tree));
  const std::string valid = bytes_of(folder.path() / "a.morula");
  const auto read = [](const fs::path& path) { read_tree(path); };
  int tried = 0;
  for (const std::string key : {"\"rows\": ", "\"offset\": ", "\"width\": ", "\"vertices\": ", "\"branching\": "})
    for (std::size_t at = valid.find(key); at != std::string::npos; at = valid.find(key, at + 1))
      for (const std::string& n : large_counts) {
        const std::size_t begin = at + key.size();
        const std::size_t length = valid.find_first_not_of("0123456789", begin) - begin;
        // As many bytes more in the header as the number is longer.
        std::string bytes = valid;
        bytes.replace(begin, length, n);
        std::uint32_t header = 0;
        std::memcpy(&header, bytes.data() + 12, sizeof header);
        bytes.replace(12, 4, raw(static_cast<std::uint32_t>(header + n.size() - length)));
        bytes = resealed(std::move(bytes));
        ++tried;
        // Numbers of the mesh are not checked before there is one: such a file may be read, at no greater cost.
        const fs::path path = folder.file("a.morula", bytes);
        const std::size_t before = allocated_bytes;
        try {
          read(path);
        } catch (const FileError&) {
        }
        EXPECT_LE(allocated_bytes - before, std::size_t{64} << 20) << key << n;
      }
  EXPECT_GT(tried, 100);
}

TEST_F(Memory, of_array_readers_does_not_follow_the_shape) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {Facet{0, 1, 2}}};
  const auto array = [](const std::string& shape, const std::string& version, const std::string& length) {
    return "\x93NUMPY" + version + length + "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }\n";
  };
  for (const std::string& n : large_counts)
    for (const std::string& shape : {"(" + n + ", 3, 3)", "(1, " + n + ", 3)", "(1, 3, " + n + ")",
                                     "(" + n + ", " + n + ", 3)", "(" + n + ", 2)"}) {
      const std::string header = array(shape, std::string(), std::string());
      const std::size_t dictionary = header.size() - 6;
      for (const std::string& bytes :
           {array(shape, std::string("\1\0", 2), raw(static_cast<std::uint16_t>(dictionary))),
            array(shape, std::string("\2\0", 2), raw(static_cast<std::uint32_t>(dictionary))),
            array(shape, std::string("\3\0", 2), std::string(4, '\xff'))}) {
        refused_with_little("a.npy", bytes, [&](const fs::path& path) { Motion motion(path, mesh); });
        refused_with_little("a.npy", bytes, [&](const fs::path& path) { read_modes(path, mesh); });
        refused_with_little("a.npy", bytes, [&](const fs::path& path) { read_coordinates(path, 2); });
      }
    }
}

}  // namespace
}  // namespace morula::test
