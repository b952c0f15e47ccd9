// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Valid files of every format, damaged in small ways by a seeded generator: each is either refused with a FileError or
// read into something that can be used. Which of the two is not the question here.
#include <gtest/gtest.h>

#include <morula/geometry/reproducible.hpp>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>

#include "files.hpp"
#include "solid_files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

std::size_t below(Random& random, std::size_t bound) {
  return static_cast<std::size_t>(random.next() % bound);
}

// Words that parsers trip over.
const std::vector<std::string> nasty_words{
    "nan",   "-inf", "1e999", "-1", "0", "4294967295", "4294967296", "+",    "99999999999", "0x1p3",
    "1/2/3", "\\\n", "#",     "\"", "}", "[",          "\r",         "\n\n", "1e-400",      ""};

std::string mutated(std::string bytes, Random& random) {
  for (std::size_t n = 1 + below(random, 3); n > 0 && !bytes.empty(); --n) {
    const std::size_t at = below(random, bytes.size());
    const std::size_t length = 1 + below(random, std::min<std::size_t>(64, bytes.size() - at));
    switch (below(random, 7)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(random, 8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random.next());
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 4:
        bytes.erase(at, length);
        break;
      case 5:
        bytes.replace(at, std::min<std::size_t>(4, bytes.size() - at), 4, '\xff');
        break;
      default: {
        // A whole word.
        std::size_t begin = bytes.find_first_of(" \n,", at);
        if (begin == bytes.npos) break;
        const std::size_t end = std::min(bytes.find_first_of(" \n,", ++begin), bytes.size());
        bytes.replace(begin, end - begin, nasty_words[below(random, nasty_words.size())]);
      }
    }
  }
  return bytes;
}

class Mutations : public testing::Test {
 protected:
  // use: reads the file and checks what it gave; may throw FileError.
  template <class Use>
  void survive(const std::string& name, const std::string& valid, const Use& use, bool reseal = false) {
    constexpr int cases = 300;
    Random random(valid.size());
    int refused = 0;
    use(folder.file(name, valid));
    for (int i = 0; i < cases; ++i) {
      std::string bytes = mutated(valid, random);
      if (reseal && bytes.size() >= 32) bytes = resealed(std::move(bytes));
      const fs::path path = folder.file(name, bytes);
      try {
        use(path);
      } catch (const FileError& error) {
        ++refused;
        EXPECT_EQ(std::string(error.what()).find(path.string()), 0u) << error.what();
      } catch (const std::exception& error) {
        ADD_FAILURE() << name << ", case " << i << ": not a FileError: " << error.what();
      }
    }
    EXPECT_GT(refused, cases / 4) << name << ": the damage is too mild to show anything";
  }

  const ScratchFolder folder;
};

TEST_F(Mutations, meshes_are_refused_or_usable) {
  const auto use = [](const fs::path& path) { require_usable(read_mesh(path)); };
  for (const std::string name : {"a.obj", "a.off", "a.ply"}) {
    write_mesh(folder.path() / name, small_mesh());
    survive(name, bytes_of(folder.path() / name), use);
  }
  const Mesh mesh = small_mesh();
  std::string ascii =
      "ply\nformat ascii 1.0\nelement vertex 56\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 108\nproperty uchar red\nproperty list uchar int vertex_indices\nend_header\n";
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 56\nproperty float x\nproperty double y\n"
      "property float z\nelement face 108\nproperty list ushort short vertex_indices\nend_header\n";
  std::string solid = "solid a\n", binary(80, ' ');
  binary += raw(108u);
  const auto text = [](const Vec3& p) {
    return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  };
  for (const Vec3& p : mesh.positions) {
    ascii += text(p);
    big += raw(static_cast<float>(p.x), true) + raw(p.y, true) + raw(static_cast<float>(p.z), true);
  }
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    ascii += "255 3";
    big += raw(std::uint16_t{3}, true);
    solid += "facet normal 0 0 0\nouter loop\n";
    binary += std::string(12, '\0');
    for (const std::uint32_t v : mesh.facets[f]) {
      ascii += " " + std::to_string(v);
      big += raw(static_cast<std::int16_t>(v), true);
      solid += "vertex " + text(mesh.positions[v]);
      for (int axis = 0; axis < 3; ++axis) binary += raw(static_cast<float>(mesh.positions[v][axis]));
    }
    ascii += "\n";
    solid += "endloop\nendfacet\n";
    binary += "xx";
  }
  survive("ascii.ply", ascii, use);
  survive("big.ply", big, use);
  survive("text.stl", solid + "endsolid a\n", use);
  survive("binary.stl", binary, use);
}

TEST_F(Mutations, solids_are_refused_or_usable) {
  const auto use = [](const fs::path& path) { require_usable(read_mesh(path)); };
  const Solid solid = tetrahedral_cube(1);
  survive("text.vtk", legacy_vtk(solid, false), use);
  survive("binary.vtk", legacy_vtk(solid, true), use);
  survive("text.vtu", xml_vtu(solid), use);
  for (const bool binary : {false, true}) {
    survive("old.msh", gmsh_2(solid, binary), use);
    survive("new.msh", gmsh_4(solid, binary), use);
  }
  write_mesh(folder.path() / "a.vtp", small_mesh());
  survive("a.vtp", bytes_of(folder.path() / "a.vtp"), use);
}

TEST_F(Mutations, motions_are_refused_or_usable) {
  const Mesh mesh = small_mesh();
  MotionWriter writer(folder.path() / "a.npy", mesh, 2);
  writer.write(mesh.positions);
  writer.write(mesh.positions);
  writer.finish();
  std::string bytes = bytes_of(folder.path() / "a.npy");
  const auto use = [&](const fs::path& path) {
    const Motion motion(path, mesh);
    for (std::size_t i = 0; i < motion.frame_count(); ++i) {
      const Mesh moved{motion.frame(i), mesh.facets};
      EXPECT_EQ(moved.vertex_count(), mesh.vertex_count());
      require_usable(moved);
    }
  };
  survive("a.npy", bytes, use);
  // Damage in the header alone: it is short, so the whole file seldom shows it.
  const std::string data = bytes.substr(128);
  survive("header.npy", bytes.substr(0, 128), [&](const fs::path& path) {
    const std::string header = bytes_of(path);
    use(folder.file("header.npy", header + data));
  });
}

TEST_F(Mutations, modes_are_refused_or_usable) {
  const Mesh mesh = small_mesh();
  MotionWriter writer(folder.path() / "a.npy", mesh, 2);  // modes lie in files as frames do
  writer.write(mesh.positions);
  writer.write(mesh.positions);
  writer.finish();
  survive("a.npy", bytes_of(folder.path() / "a.npy"), [&](const fs::path& path) {
    const Modes modes = read_modes(path, mesh);
    EXPECT_EQ(modes.displacements.size(), modes.mode_count * mesh.vertex_count());
    for (const Vec3& u : modes.displacements) EXPECT_TRUE(is_finite(u));
  });
}

TEST_F(Mutations, trees_are_refused_or_usable) {
  const Mesh mesh = small_mesh();
  const CoveredTree model = small_built(mesh);
  const auto use = [&](const fs::path& path) {
    const TreeFile file = read_tree(path);
    EXPECT_TRUE(validate(file.tree).empty());
    if (!file.cover) return;
    // Touches every index; the sanitizers watch.
    ASSERT_EQ(file.cover->region_begin.size(), file.tree.node_count());
    if (file.cover->vertex_count > 100'000) return;
    const std::vector<Vec3> positions(file.cover->vertex_count);
    for (std::uint32_t i = 0; i < file.tree.node_count(); ++i)
      for (const std::uint32_t corner : file.cover->region_corners(i)) {
        EXPECT_TRUE(is_finite(corner_position(*file.cover, corner, positions)));
      }
  };
  for (const std::string name : {"a.sph", "a.json", "a.morula"}) {
    write_tree(folder.path() / name, model);
    survive(name, bytes_of(folder.path() / name), use);
  }
  write_tree(folder.path() / "a.morula", model);
  const std::string native = bytes_of(folder.path() / "a.morula");
  survive("sealed.morula", native, use, true);
  survive(
      "built.morula", native,
      [&](const fs::path& path) {
        const CoveredTree read = read_covered_tree(path, mesh);
        EXPECT_TRUE(certify(read.cover, mesh.positions, read.tree.spheres).covered);
      },
      true);
}

}  // namespace
}  // namespace morula::test
