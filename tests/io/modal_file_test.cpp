// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/io/modal_file.hpp>
#include <stdexcept>
#include <support/error_text.hpp>
#include <support/npy.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

template <class Value>
std::vector<Value> counting(std::size_t count) {
  std::vector<Value> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<Value>(i) * Value(0.1));
  return values;
}

TEST(ModalFile, modes_and_coordinates_of_both_types_are_read) {
  const ScratchFolder folder;
  const Modes doubles = read_modes(folder.file("m8.npy", npy("<f8", "(2, 3, 3)", counting<double>(18))), one_facet());
  const Modes floats = read_modes(folder.file("m4.npy", npy("<f4", "(2, 3, 3)", counting<float>(18))), one_facet());
  EXPECT_EQ(doubles.mode_count, 2u);
  EXPECT_EQ(doubles.vertex_count, 3u);
  EXPECT_EQ(doubles.mode(1)[2], (Vec3{15 * 0.1, 16 * 0.1, 17 * 0.1}));
  EXPECT_EQ(floats.mode(0)[1], (Vec3{3 * 0.1f, 4 * 0.1f, 5 * 0.1f}));

  const auto motion = read_coordinates(folder.file("q8.npy", npy("<f8", "(3, 2)", counting<double>(6))), 2);
  EXPECT_EQ(motion.frame_count(), 3u);
  EXPECT_EQ(motion.frame(2)[1], 5 * 0.1);
  EXPECT_EQ(read_coordinates(folder.file("q4.npy", npy("<f4", "(3, 2)", counting<float>(6))), 2).frame(0)[1], 0.1f);
}

TEST(ModalFile, what_is_written_is_read_back_to_the_bit) {
  const ScratchFolder folder;
  const fs::path modes_path = folder.path() / "modes.npy", coordinates_path = folder.path() / "coords.npy";
  Modes modes{3, 2, {}};
  for (int i = 0; i < 6; ++i) modes.displacements.push_back({0.1 * i, -1e-300, 1e300 / (i + 1)});
  write_modes(modes_path, modes);
  const Modes read = read_modes(modes_path, one_facet());
  EXPECT_EQ(read.mode_count, 2u);
  EXPECT_EQ(read.displacements, modes.displacements);
  const ModalCoordinates motion{2, {0, 0.1, -0.2, 1.0 / 3}};
  write_coordinates(coordinates_path, motion);
  EXPECT_EQ(read_coordinates(coordinates_path, 2).coordinates, motion.coordinates);
  // Written by hand, of version 1: other programs read it.
  EXPECT_EQ(bytes_of(coordinates_path).substr(0, 6), "\x93NUMPY");

  modes.displacements.pop_back();
  EXPECT_THROW(write_modes(folder.path() / "short.npy", modes), std::invalid_argument);
  EXPECT_THROW(write_coordinates(folder.path() / "short.npy", {2, {1, 2, 3}}), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder.path() / "short.npy"));
}

/// A number that a careless writer changes, or, seldom, one that no reader takes.
double any_number(Random& random) {
  static const std::vector<double> good = awkward_numbers();
  const std::size_t i = random.next() % (8 * good.size());
  if (i == 0) return std::numeric_limits<double>::quiet_NaN();
  if (i == 1) return -std::numeric_limits<double>::infinity();
  return good[i % good.size()];
}

/// Expects the path to hold nothing, if `write` rejects its data; otherwise what `same` finds equal. Returns whether it
/// was written.
bool is_written(const fs::path& path, const std::function<void()>& write, const std::function<bool()>& same) {
  fs::remove(path);
  try {
    write();
  } catch (const std::invalid_argument& error) {
    EXPECT_FALSE(fs::exists(path)) << error.what();
    return false;
  }
  EXPECT_TRUE(same());
  return true;
}

TEST(ModalFile, writers_reject_what_readers_reject_and_the_rest_is_read_back) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "array with spaces.npy";
  Random random(4);
  std::size_t written = 0, rejected = 0;
  for (int round = 0; round < 600; ++round) {
    Mesh mesh;
    mesh.positions.resize(random.next() % 4);
    Modes modes{mesh.vertex_count(), static_cast<std::size_t>(random.next() % 4), {}};
    if (random.next() % 20 == 0) modes.mode_count |= std::size_t{1} << 63;  // the product of the counts overflows
    const std::size_t count = (modes.mode_count & 7) * modes.vertex_count + (random.next() % 10 == 0 ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i)
      modes.displacements.push_back({any_number(random), any_number(random), any_number(random)});
    const bool ok = is_written(
        path, [&] { write_modes(path, modes); },
        [&] {
          const Modes read = read_modes(path, mesh);
          const auto same = [](const Vec3& a, const Vec3& b) {
            return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
          };
          return read.mode_count == modes.mode_count &&
                 std::equal(read.displacements.begin(), read.displacements.end(), modes.displacements.begin(),
                            modes.displacements.end(), same);
        });
    ++(ok ? written : rejected);

    ModalCoordinates motion{static_cast<std::size_t>(random.next() % 4), {}};
    const std::size_t numbers = motion.mode_count * (random.next() % 4) + (random.next() % 10 == 0 ? 1 : 0);
    for (std::size_t i = 0; i < numbers; ++i) motion.coordinates.push_back(any_number(random));
    const bool moves = is_written(
        path, [&] { write_coordinates(path, motion); },
        [&] {
          const ModalCoordinates read = read_coordinates(path, motion.mode_count);
          return std::equal(read.coordinates.begin(), read.coordinates.end(), motion.coordinates.begin(),
                            motion.coordinates.end(), [](double a, double b) { return same_bits(a, b); });
        });
    ++(moves ? written : rejected);
  }
  EXPECT_GT(written, 100u);
  EXPECT_GT(rejected, 100u);
}

TEST(ModalFile, writers_name_what_they_reject) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "none.npy";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_text([&] {
              write_modes(path, {3, 0, {}});
            }),
            "there is no mode to write: a file of modes has one or more");
  EXPECT_EQ(error_text([&] {
              write_modes(path, {1, 2, {{1, 2, 3}, {0, nan, 0}}});
            }),
            "mode 1: the displacement of vertex 0 is not finite; repair it where the modes are made");
  EXPECT_EQ(error_text([&] {
              write_coordinates(path, {2, {}});
            }),
            "there is no frame to write: a file of coordinates has one or more, of one mode or more");
  EXPECT_EQ(error_text([&] {
              write_coordinates(path, {2, {1, 2, 3, nan}});
            }),
            "frame 1: coordinate 1 is not finite; repair it where the coordinates are made");
  EXPECT_FALSE(fs::exists(path));
}

TEST(ModalFile, what_does_not_fit_is_refused_with_both_shapes) {
  const ScratchFolder folder;
  const auto modes = [&](const std::string& bytes, const std::string& fragment) {
    const fs::path path = folder.file("modes.npy", bytes);
    expect_file_error(path, 0, fragment, [&] { read_modes(path, one_facet()); });
  };
  modes("v 0 0 0\n", "not a NumPy file");
  modes(
      npy("<f8", "(2, 4, 3)", counting<double>(24)),
      "the array's shape is '(2, 4, 3)', but (modes, 3, 3) for the vertices of the mesh, one mode or more, is needed");
  modes(npy("<f8", "(0, 3, 3)", counting<double>(0)), "the array's shape is '(0, 3, 3)'");
  modes(npy("<f8", "(3, 3)", counting<double>(9)), "the array's shape is '(3, 3)', but (modes, vertices, 3) is needed");
  modes(npy("<f8", "(3, 3, 2)", counting<double>(18)), "(modes, vertices, 3) is needed");
  modes(npy("<f8", "(2, 3, 3)", counting<double>(17)), "136 bytes follow the header");
  modes(npy("<i4", "(2, 3, 3)", counting<std::int32_t>(18)), "'<f4' or '<f8' is needed");
  std::vector<double> values = counting<double>(18);
  values[13] = std::numeric_limits<double>::quiet_NaN();
  modes(npy("<f8", "(2, 3, 3)", values), "mode 1: the displacement of vertex 1 is not finite");

  const auto coordinates = [&](const std::string& bytes, const std::string& fragment) {
    const fs::path path = folder.file("coords.npy", bytes);
    expect_file_error(path, 0, fragment, [&] { read_coordinates(path, 2); });
  };
  coordinates(npy("<f8", "(2, 3)", counting<double>(6)),
              "the array's shape is '(2, 3)', but (frames, 2) for the modes given, one frame or more, is needed");
  coordinates(npy("<f8", "(0, 2)", counting<double>(0)), "the array's shape is '(0, 2)'");
  coordinates(npy("<f8", "(6,)", counting<double>(6)), "but (frames, modes) is needed");
  coordinates(npy("<f8", "(2, 3, 1)", counting<double>(6)), "but (frames, modes) is needed");
  values.resize(6);
  values[5] = std::numeric_limits<double>::infinity();
  coordinates(npy("<f8", "(3, 2)", values), "frame 2: coordinate 1 is not finite");
  const fs::path missing = folder.path() / "missing.npy";
  expect_file_error(missing, 0, "", [&] { read_coordinates(missing, 2); });
}

}  // namespace
}  // namespace morula::test
