// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// An Interrupt ends reads and writes of files: what it throws comes out as it is, and no part of a file is left.
#include <gtest/gtest.h>

#include <functional>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <support/ended_where_asked.hpp>

#include "files.hpp"
#include "solid_files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

// Some 20,000 vertices.
const Mesh& many_facets() {
  static const Mesh mesh = sample_body("limb", 140);
  return mesh;
}

TEST(EndedFiles, meshes_are_read_and_written_in_pieces) {
  const Mesh& mesh = many_facets();
  ASSERT_GT(mesh.vertex_count(), 16384u);
  for (const MeshFileKind& kind : mesh_file_kinds()) {
    if (!kind.is_written) continue;
    const ScratchFolder folder;
    const fs::path path = folder.path() / ("a" + std::string(kind.extension));
    expect_ends_wherever_it_asks("write " + path.filename().string(), 3, [&] { write_mesh(path, mesh); });
    EXPECT_EQ(folder.names(), std::vector<std::string>{path.filename().string()});
    const Mesh whole = read_mesh(path);
    expect_ends_wherever_it_asks("read " + path.filename().string(), 3,
                                 [&] { EXPECT_TRUE(same_bits(read_mesh(path), whole)); });
  }
}

TEST(EndedFiles, solids_are_read_in_pieces) {
  const ScratchFolder folder;
  const Solid solid = tetrahedral_cube(16);
  const std::vector<std::pair<std::string, std::string>> files{{"text.vtk", legacy_vtk(solid, false)},
                                                               {"binary.vtk", legacy_vtk(solid, true)},
                                                               {"a.vtu", xml_vtu(solid)},
                                                               {"text2.msh", gmsh_2(solid, false)},
                                                               {"binary2.msh", gmsh_2(solid, true)},
                                                               {"text4.msh", gmsh_4(solid, false)},
                                                               {"binary4.msh", gmsh_4(solid, true)},
                                                               {"text4_0.msh", gmsh_4_0(solid, false)},
                                                               {"binary4_0.msh", gmsh_4_0(solid, true)}};
  for (const auto& [name, bytes] : files) {
    const fs::path path = folder.file(name, bytes);
    expect_ends_wherever_it_asks(name, 4, [&] { read_mesh(path); });
  }
}

TEST(EndedFiles, trees_balls_and_motions_are_read_and_written_in_pieces) {
  const ScratchFolder folder;
  const Mesh& mesh = many_facets();
  const std::vector<Vec3>& p = mesh.positions;
  std::vector<Sphere> balls;
  for (const Vec3& at : p) balls.push_back({at, 1});
  const auto round_trip = [&](const std::string& name, int least, const std::function<void(const fs::path&)>& write,
                              const std::function<void(const fs::path&)>& read) {
    const fs::path path = folder.path() / name;
    expect_ends_wherever_it_asks("write " + name, least, [&] { write(path); });
    EXPECT_EQ(folder.names(), std::vector<std::string>{name});
    if (read) expect_ends_wherever_it_asks("read " + name, least, [&] { read(path); });
    folder.clear();
  };
  const CoveredTree model = small_built(small_mesh());
  // Archives of few nodes are written without a question.
  for (const std::string name : {"a.morula", "a.sph", "a.json", "a.npz"})
    round_trip(
        name, name == "a.npz" ? 0 : 1, [&](const fs::path& path) { write_tree(path, model); },
        [](const fs::path& path) { read_tree(path); });
  round_trip(
      "balls.ply", 2, [&](const fs::path& path) { write_balls(path, balls); },
      [](const fs::path& path) { read_balls(path); });
  round_trip(
      "a.sph", 2, [&](const fs::path& path) { write_sofa_spheres(path, balls); }, nullptr);
  for (const std::string name : {"a.npy", "a.pc2", "a.mdd", "frames"})
    round_trip(
        name, 3,
        [&](const fs::path& path) {
          MotionWriter writer(path, mesh, 3, ".ply");
          for (int i = 0; i < 3; ++i) writer.write(p);
          writer.finish();
        },
        [&](const fs::path& path) {
          const Motion motion(path, mesh);
          for (std::size_t i = 0; i < motion.frame_count(); ++i) motion.frame(i);
        });
  round_trip(
      "modes.npy", 2,
      [&](const fs::path& path) {
        write_modes(path, {p.size(), 1, p});
      },
      [&](const fs::path& path) { read_modes(path, mesh); });
#ifdef MORULA_HAS_GLTF
  const std::vector<std::vector<Sphere>> frames{std::vector<Sphere>(200, balls[0])};
  round_trip(
      "a.glb", 1, [&](const fs::path& path) { write_gltf_spheres(path, frames); },
      [](const fs::path& path) { read_mesh(path); });
#endif
}

// A frame is written whole or not at all: one that was ended can be written again.
TEST(EndedFiles, frames_that_were_ended_are_written_again) {
  const ScratchFolder folder;
  const Mesh& mesh = many_facets();
  for (const std::string name : {"a.npy", "a.pc2"}) {
    const fs::path once = folder.path() / ("once_" + name), again = folder.path() / name;
    MotionWriter whole(once, mesh, 2), ended(again, mesh, 2);
    for (int frame = 0; frame < 2; ++frame) {
      whole.write(mesh.positions);
      bool is_written = false;
      for (int last = 1; !is_written; ++last) {
        int asked = 0;
        const Interrupt interrupt([&] {
          if (++asked == last) throw Cancelled();
        });
        try {
          ended.write(mesh.positions);
          is_written = true;
        } catch (const Cancelled&) {
        }
      }
    }
    whole.finish();
    ended.finish();
    EXPECT_EQ(bytes_of(again), bytes_of(once));
  }
  const CoveredTree model = small_built(small_mesh());
  const fs::path once = folder.path() / "once.npz", again = folder.path() / "again.npz";
  SphereFramesWriter whole(once, model.tree, 1), ended(again, model.tree, 1);
  whole.write(model.tree.spheres);
  whole.finish();
  {
    const Interrupt interrupt([] { throw Cancelled(); });
    EXPECT_THROW(ended.write(model.tree.spheres), Cancelled);
  }
  ended.write(model.tree.spheres);
  {
    const Interrupt interrupt([] { throw Cancelled(); });
    EXPECT_NO_THROW(ended.finish());
  }
  EXPECT_EQ(bytes_of(again), bytes_of(once));
}

// Ended while bytes go to the disk: nothing is there, or what was there before.
TEST(EndedFiles, a_write_that_is_ended_leaves_what_was_there) {
  const ScratchFolder folder;
  const Mesh mesh = sample_body("limb", 400);
  const auto end_while_writing = [&](const fs::path& path) {
    bool has_begun = false;
    const Interrupt interrupt([&] {
      for (const std::string& name : folder.names()) has_begun = has_begun || name.starts_with(".morula-");
      if (has_begun) throw Cancelled();
    });
    EXPECT_THROW(write_mesh(path, mesh), Cancelled) << path;
    EXPECT_TRUE(has_begun) << path;
  };
  for (const std::string name : {"a.obj", "a.off", "a.ply", "a.stl", "a.vtp"}) {
    end_while_writing(folder.path() / name);
    EXPECT_EQ(folder.names(), std::vector<std::string>{}) << name;
    const fs::path old = folder.file(name, "something else");
    end_while_writing(old);
    EXPECT_EQ(folder.names(), std::vector<std::string>{name});
    EXPECT_EQ(bytes_of(old), "something else");
    folder.clear();
  }
}

}  // namespace
}  // namespace morula::test
