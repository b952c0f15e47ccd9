// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/io/motion_file.hpp>
#include <support/meshes.hpp>
#include <support/npy.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

// Frame i, told from all others by its every coordinate.
std::vector<Vec3> frame_positions(const Mesh& mesh, std::size_t i) {
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p = p * (1.0 + static_cast<double>(i) / 3) + Vec3{0.1, -0.0, 0};
  return positions;
}

void write_motion(const fs::path& path, const Mesh& mesh, std::size_t frames, const std::string& extension = ".obj") {
  MotionWriter writer(path, mesh, frames, extension);
  for (std::size_t i = 0; i < frames; ++i) writer.write(frame_positions(mesh, i));
  writer.finish();
}

void expect_motion(const Motion& motion, const Mesh& mesh, std::size_t frames) {
  ASSERT_EQ(motion.frame_count(), frames);
  for (std::size_t i = 0; i < frames; ++i) {
    const Mesh expected{frame_positions(mesh, i), mesh.facets};
    EXPECT_TRUE(same_bits(Mesh{motion.frame(i), mesh.facets}, expected)) << motion.frame_name(i);
  }
}

TEST(MotionFile, every_kind_reads_back_bit_for_bit) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  for (const std::string extension : {".obj", ".off", ".ply"}) {
    const fs::path frames = folder.path() / ("frames_" + extension.substr(1));
    write_motion(frames, mesh, 12, extension);
    expect_motion(Motion(frames, mesh), mesh, 12);
    expect_motion(Motion(frames / "", mesh), mesh, 12);
    EXPECT_EQ(Motion(frames, mesh).frame_name(11), "0011" + extension);
    EXPECT_EQ(Motion(frames / "001?.*", mesh).frame_count(), 2u);
  }
  const fs::path npy = folder.path() / "motion.npy";
  write_motion(npy, mesh, 12);
  expect_motion(Motion(npy, mesh), mesh, 12);
  EXPECT_EQ(Motion(npy, mesh).frame_name(3), "motion.npy frame 3");
}

TEST(MotionFile, awkward_numbers_survive) {
  const ScratchFolder folder;
  const Mesh mesh = awkward_mesh();
  for (const std::string name : {"folder", "motion.npy"}) {
    MotionWriter writer(folder.path() / name, mesh, 1);
    writer.write(mesh.positions);
    writer.finish();
    EXPECT_TRUE(same_bits(Mesh{Motion(folder.path() / name, mesh).frame(0), mesh.facets}, mesh)) << name;
  }
}

TEST(MotionFile, one_mesh_is_one_frame) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  write_mesh(folder.path() / "rest.off", mesh);
  const Motion motion(folder.path() / "rest.off", mesh);
  ASSERT_EQ(motion.frame_count(), 1u);
  EXPECT_EQ(motion.frame(0), mesh.positions);
  EXPECT_EQ(motion.frame_name(0), "rest.off");
}

TEST(MotionFile, frames_come_in_natural_order) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const std::vector<std::string> in_order{"a.obj",
                                          "f.obj",
                                          "f1.obj",
                                          "f01.obj",
                                          "f1b2.obj",
                                          "f1b10.obj",
                                          "f2.obj",
                                          "f9.obj",
                                          "f10.obj",
                                          "f100.obj",
                                          "f18446744073709551617.obj",
                                          "g0.obj",
                                          "g.0.obj"};
  std::vector<std::string> expected = in_order;
  // A dot sorts before letters and digits.
  std::swap(expected[11], expected[12]);
  std::swap(expected[2], expected[3]);
  for (const std::string& name : in_order) write_mesh(folder.path() / name, mesh);
  folder.file(".f3.obj", "hidden");
  folder.file("f3.txt", "not a mesh");
  fs::create_directory(folder.path() / "f4.obj");
  std::vector<std::string> names;
  const Motion motion(folder.path(), mesh);
  for (std::size_t i = 0; i < motion.frame_count(); ++i) names.push_back(motion.frame_name(i));
  EXPECT_EQ(names, expected);

  const auto matching = [&](const std::string& pattern) {
    const Motion matched(folder.path() / pattern, mesh);
    std::vector<std::string> result;
    for (std::size_t i = 0; i < matched.frame_count(); ++i) result.push_back(matched.frame_name(i));
    return result;
  };
  EXPECT_EQ(matching("f??.obj"), (std::vector<std::string>{"f01.obj", "f10.obj"}));
  expect_file_error(folder.path(), 0, "f3.obj is missing between f2.obj and f9.obj", [&] { matching("f?.obj"); });
  EXPECT_EQ(matching("*b*.obj"), (std::vector<std::string>{"f1b2.obj", "f1b10.obj"}));
  EXPECT_EQ(matching("**1*0.*"), (std::vector<std::string>{"f1b10.obj", "f10.obj", "f100.obj"}));
  EXPECT_EQ(matching("g?0*"), (std::vector<std::string>{"g.0.obj"}));
}

TEST(MotionFile, a_pattern_without_a_folder_means_this_folder) {
  const ScratchFolder folder;
  write_mesh(folder.path() / "f1.obj", small_mesh());
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  const std::size_t frames = Motion("f*.obj", small_mesh()).frame_count();
  fs::current_path(before);
  EXPECT_EQ(frames, 1u);
}

TEST(MotionFile, npy_takes_all_versions_and_both_types) {
  const ScratchFolder folder;
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  std::string floats, doubles;
  for (int i = 0; i < 18; ++i) {
    floats += raw(static_cast<float>(i) * 0.1f);
    doubles += raw(i * 0.1);
  }
  for (const int version : {1, 2, 3}) {
    const Motion single(
        folder.file("f4.npy", npy_with_header("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 3), }   \n",
                                              floats, version)),
        mesh);
    ASSERT_EQ(single.frame_count(), 2u);
    EXPECT_EQ(single.frame(1)[2], (Vec3{15 * 0.1f, 16 * 0.1f, 17 * 0.1f}));
    // Other spellings of the same dictionary; Python 2 wrote long integers with an L.
    const Motion both(
        folder.file("f8.npy", npy_with_header("{\"shape\":(2L,3L,3L),\"descr\":\"<f8\",\"fortran_order\":False}",
                                              doubles, version)),
        mesh);
    ASSERT_EQ(both.frame_count(), 2u);
    EXPECT_EQ(both.frame(0)[1], (Vec3{3 * 0.1, 4 * 0.1, 5 * 0.1}));
  }
}

TEST(MotionFile, written_npy_is_what_numpy_expects) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  write_motion(folder.path() / "a.npy", mesh, 3);
  const std::string bytes = bytes_of(folder.path() / "a.npy");
  const std::size_t data = 3 * mesh.vertex_count() * 24;
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ((bytes.size() - data) % 64, 0u);
  EXPECT_EQ(bytes[bytes.size() - data - 1], '\n');
  EXPECT_NE(bytes.find("{'descr': '<f8', 'fortran_order': False, 'shape': (3, " + std::to_string(mesh.vertex_count()) +
                       ", 3), }"),
            bytes.npos);
}

TEST(HostileMotions, npy) {
  const ScratchFolder folder;
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const std::string data(72, '\0');  // one frame of doubles
  const auto with = [&](const std::string& descr, const std::string& order, const std::string& shape) {
    return npy_with_header("{'descr': " + descr + ", 'fortran_order': " + order + ", 'shape': " + shape + ", }", data);
  };
  const std::string good = with("'<f8'", "False", "(1, 3, 3)");
  const std::vector<HostileFile> files{
      {"empty.npy", "", 0, "byte 0: not a NumPy file"},
      {"zip.npy", "PK\3\4 and more bytes", 0, "not a NumPy file"},
      {"only_magic.npy", "\x93NUMPY", 0, "ends inside the .npy header"},
      {"version_9.npy", "\x93NUMPY\x09" + good.substr(7), 0, "version 9 of the .npy format is not read"},
      {"version_0.npy", std::string("\x93NUMPY\0", 7) + good.substr(7), 0, "version 0"},
      {"cut_header.npy", good.substr(0, 40), 0, "ends inside the .npy header"},
      {"huge_header.npy", npy_with_header("", data, 2).replace(8, 4, raw(0xffffffffu)), 0,
       "ends inside the .npy header"},
      {"no_dictionary.npy", npy_with_header("", data), 0, "is malformed"},
      {"open_dictionary.npy", npy_with_header("{'descr': '<f8'", data), 0, "is malformed"},
      {"open_string.npy", npy_with_header("{'descr': '<f8, }", data), 0, "is malformed"},
      {"open_tuple.npy", npy_with_header("{'shape': (1, 3, 3, }", data), 0, "is malformed"},
      {"other_key.npy", npy_with_header("{'color': 'red'}", data), 0, "is malformed"},
      {"no_keys.npy", npy_with_header("{}", data), 0, "the array's type is ''"},
      {"integers.npy", with("'<i8'", "False", "(1, 3, 3)"), 0, "type is ''<i8''"},
      {"big_endian.npy", with("'>f8'", "False", "(1, 3, 3)"), 0, "astype('<f8')"},
      {"half.npy", with("'<f2'", "False", "(1, 3, 3)"), 0, "'<f4' or '<f8' is needed"},
      {"table.npy", with("[('x', '<f8'), ('y', '<f8')]", "False", "(1, 3, 3)"), 0, "'<f4' or '<f8' is needed"},
      {"fortran.npy", with("'<f8'", "True", "(1, 3, 3)"), 0, "numpy.ascontiguousarray"},
      {"flat.npy", with("'<f8'", "False", "(3, 3)"), 0, "(frames, vertices, 3) is needed"},
      {"scalar.npy", with("'<f8'", "False", "()"), 0, "(frames, vertices, 3) is needed"},
      {"transposed.npy", with("'<f8'", "False", "(1, 3, 4)"), 0, "(frames, vertices, 3) is needed"},
      {"negative.npy", with("'<f8'", "False", "(-1, 3, 3)"), 0, "(frames, vertices, 3) is needed"},
      {"words.npy", with("'<f8'", "False", "(one, 3, 3)"), 0, "(frames, vertices, 3) is needed"},
      {"more_frames.npy", with("'<f8'", "False", "(2, 3, 3)"), 0, "72 bytes follow the header"},
      {"overflowing.npy", with("'<f8'", "False", "(6148914691236517206, 4, 3)"), 0, "72 bytes follow the header"},
      {"too_many.npy", with("'<f8'", "False", "(99999999999999999999, 3, 3)"), 0, "(frames, vertices, 3) is needed"},
      {"short_data.npy", good.substr(0, good.size() - 1), 0, "71 bytes follow the header"},
      {"long_data.npy", good + "x", 0, "73 bytes follow the header"},
      {"no_frames.npy", npy_with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (0, 3, 3), }", ""), 0,
       "has no frames"},
      {"no_vertices.npy", npy_with_header("{'descr': '<f8', 'fortran_order': False, 'shape': (5, 0, 3), }", ""), 0,
       "0 vertices a frame, but the mesh has 3"},
      {"other_vertices.npy", with("'<f4'", "False", "(1, 6, 3)"), 0, "6 vertices a frame, but the mesh has 3"},
  };
  for (const HostileFile& hostile : files) {
    SCOPED_TRACE(hostile.name);
    const fs::path path = folder.file(hostile.name, hostile.bytes);
    expect_file_error(path, 0, hostile.fragment, [&] { Motion(path, mesh); });
  }
  EXPECT_EQ(Motion(folder.file("good.npy", good), mesh).frame_count(), 1u);

  std::string nan = good;
  nan.replace(good.size() - 16, 8, raw(std::numeric_limits<double>::quiet_NaN()));
  const fs::path path = folder.file("nan.npy", nan);
  const Motion motion(path, mesh);
  expect_file_error(path, 0, "frame 0: vertex 2 has a coordinate that is not finite", [&] { motion.frame(0); });
  folder.file("nan.npy", "");
  expect_file_error(path, 0, "reading stopped", [&] { motion.frame(0); });
}

TEST(HostileMotions, the_first_frame_of_another_topology_is_named) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  write_motion(folder.path() / "m", mesh, 4);
  const fs::path frame = folder.path() / "m" / "0002.obj";
  const auto refused_as = [&](const Mesh& other, const std::string& fragment) {
    write_mesh(frame, other);
    const Motion motion(folder.path() / "m", mesh);
    EXPECT_EQ(motion.frame(1), frame_positions(mesh, 1));
    expect_file_error(frame, 0, fragment, [&] { motion.frame(2); });
  };
  Mesh other = mesh;
  other.positions.push_back({0, 0, 0});
  refused_as(other, "has 57 vertices, but the mesh has 56");
  other = mesh;
  other.facets.pop_back();
  refused_as(other, "has 107 facets, but the mesh has 108");
  other = mesh;
  std::swap(other.facets[7][0], other.facets[7][1]);
  refused_as(other, "facet 7, counted from 0, has other vertices");
  folder.file("m/0002.obj", "v 0 0 nan\n");
  expect_file_error(frame, 1, "z is not finite", [&] { Motion(folder.path() / "m", mesh).frame(2); });
}

TEST(HostileMotions, names_that_lead_to_no_frames) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const auto refused = [&](const fs::path& path, const std::string& fragment) {
    expect_file_error(path, 0, fragment, [&] { Motion(path, mesh); });
  };
  refused(folder.path(), "no mesh file is there");
  folder.file("readme.txt", "nothing");
  refused(folder.path(), "no mesh file is there");
  refused(folder.path() / "*.obj", "no mesh file is there");
  refused(folder.path() / "missing", "there is no such folder");
  refused(folder.path() / "missing.obj", "there is no such file");
  refused(folder.path() / "missing.npy", "there is no such file");
  refused(folder.path() / "readme.txt", "is not a motion");
  expect_file_error(folder.path() / "missing", 0, "there is no such folder",
                    [&] { Motion(folder.path() / "missing" / "f*.obj", mesh); });
  write_mesh(folder.path() / "f0.obj", mesh);
  write_mesh(folder.path() / "f1.ply", mesh);
  refused(folder.path(), "meshes of several kinds (f0.obj, f1.ply); name one kind");
  EXPECT_EQ(Motion(folder.path() / "*.ply", mesh).frame_count(), 1u);
}

TEST(MotionWriter, refuses_bad_frames_before_writing_them) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  for (const std::string name : {"frames", "motion.npy"}) {
    const fs::path path = folder.path() / name;
    EXPECT_THROW(MotionWriter(path, mesh, 0), std::invalid_argument);
    EXPECT_THROW(MotionWriter(path, Mesh{}, 1), std::invalid_argument);
    EXPECT_THROW(MotionWriter(path, mesh, 1, ".stl"), std::invalid_argument);
    EXPECT_EQ(folder.names().size(), name == "frames" ? 0u : 1u);
    MotionWriter writer(path, mesh, 2);
    std::vector<Vec3> positions = mesh.positions;
    positions.pop_back();
    EXPECT_THROW(writer.write(positions), std::invalid_argument);
    positions.push_back({0, 0, std::numeric_limits<double>::quiet_NaN()});
    EXPECT_THROW(writer.write(positions), std::invalid_argument);
    writer.write(mesh.positions);
    expect_file_error(path, 0, "1 of 2 frames were written", [&] { writer.finish(); });
    writer.write(mesh.positions);
    EXPECT_THROW(writer.write(mesh.positions), std::invalid_argument);
    writer.finish();
    EXPECT_EQ(Motion(path, mesh).frame_count(), 2u);
  }
}

TEST(MotionWriter, the_npy_appears_when_it_is_whole) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  MotionWriter writer(folder.path() / "a.npy", mesh, 1);
  writer.write(mesh.positions);
  EXPECT_FALSE(fs::exists(folder.path() / "a.npy"));
  writer.finish();
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a.npy"});
}

TEST(MotionWriter, refuses_places_where_frames_would_not_be_read_back) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const auto refused = [&](const fs::path& named, const fs::path& path, const std::string& fragment) {
    expect_file_error(named, 0, fragment, [&] { MotionWriter(path, mesh, 2); });
  };
  refused(folder.path() / "a.obj", folder.path() / "a.obj", "into a folder or a .npy, .pc2 or .mdd file");
  refused(folder.file("file", ""), folder.path() / "file", "into a folder or a .npy, .pc2 or .mdd file");
  refused(folder.path() / "file" / "m", folder.path() / "file" / "m", "");
  refused(folder.path() / "missing" / "a.npy", folder.path() / "missing" / "a.npy", "there is no such folder");
  // Made with its parents.
  write_motion(folder.path() / "x" / "y" / "m", mesh, 3);
  // The third frame of the longer motion would become the shorter one's.
  refused(folder.path() / "x" / "y" / "m" / "0002.obj", folder.path() / "x" / "y" / "m",
          "would be read as part of this motion of 2 frames");
  write_motion(folder.path() / "x" / "y" / "m", mesh, 3);
  EXPECT_EQ(Motion(folder.path() / "x" / "y" / "m", mesh).frame_count(), 3u);
}

}  // namespace
}  // namespace morula::test
