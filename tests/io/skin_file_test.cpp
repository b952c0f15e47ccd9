// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <morula/io/skin_file.hpp>
#include <stdexcept>
#include <support/error_text.hpp>
#include <support/npy.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

const std::vector<double> one_frame{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

TEST(SkinFile, weights_are_kept_where_they_are_not_zero_and_add_up_to_one) {
  const ScratchFolder folder;
  const Skin skin = read_skin(
      folder.file("w.npy", npy("<f4", "(3, 2)", std::vector<float>{1, 0, 0.25f, 0.75f, 0.0f, 0.9995f})), one_facet());
  EXPECT_EQ(skin.bone_count, 2u);
  EXPECT_EQ(skin.begin, (std::vector<std::uint32_t>{0, 1, 3, 4}));
  EXPECT_EQ(skin.bones, (std::vector<std::uint32_t>{0, 0, 1, 1}));
  EXPECT_EQ(skin.weights, (std::vector<double>{1, 0.25, 0.75, 1}));
}

TEST(SkinFile, transforms_are_rows_of_matrices) {
  const ScratchFolder folder;
  const BoneFrames bones = read_bone_frames(folder.file("t.npy", npy("<f8", "(1, 1, 3, 4)", one_frame)), 1);
  ASSERT_EQ(bones.frame_count(), 1u);
  EXPECT_EQ(bones.frame(0)[0]({1, 10, 100}), (Vec3{1 + 20 + 300 + 4, 5 + 60 + 700 + 8, 9 + 100 + 1100 + 12}));
}

TEST(SkinFile, what_is_written_is_read_back_to_the_bit) {
  const ScratchFolder folder;
  const Skin skin{.bone_count = 3, .begin = {0, 1, 3, 4}, .bones = {2, 0, 1, 1}, .weights = {1, 0.25, 0.75, 1}};
  write_skin(folder.path() / "w.npy", skin);
  const Skin read = read_skin(folder.path() / "w.npy", one_facet());
  EXPECT_EQ(read.bone_count, 3u);
  EXPECT_EQ(read.begin, skin.begin);
  EXPECT_EQ(read.bones, skin.bones);
  EXPECT_EQ(read.weights, skin.weights);

  BoneFrames frames{2, {}};
  for (int i = 0; i < 4; ++i) {
    AffineTransform t;
    t.columns = {Vec3{0.1 * i, 1e-300, 3}, Vec3{-4, 5, 6e300}, Vec3{7, 1.0 / 3, 9}};
    t.translation = {10, 11.5, -1.0 * i};
    frames.transforms.push_back(t);
  }
  write_bone_frames(folder.path() / "t.npy", frames);
  EXPECT_EQ(read_bone_frames(folder.path() / "t.npy", 2).transforms, frames.transforms);

  EXPECT_THROW(write_skin(folder.path() / "none.npy", {.bone_count = 1, .begin = {0, 1}, .bones = {1}, .weights = {1}}),
               std::invalid_argument);
  frames.transforms.pop_back();
  EXPECT_THROW(write_bone_frames(folder.path() / "none.npy", frames), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder.path() / "none.npy"));
}

TEST(SkinFile, writers_name_what_readers_would_reject) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "none.npy";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto skin = [&](std::size_t bones, std::vector<std::uint32_t> begin, std::vector<double> weights) {
    const std::vector<std::uint32_t> first(weights.size(), 0);
    return error_text([&] { write_skin(path, {bones, std::move(begin), first, std::move(weights)}); });
  };
  EXPECT_EQ(skin(1, {0, 1, 2}, {1, 0.5}),
            "the weights of vertex 1 add up to 0.500000, not to 1; repair them where the skin is made");
  EXPECT_EQ(skin(1, {0, 1}, {nan}),
            "the weights of vertex 0 add up to nan, not to 1; repair them where the skin is made");
  EXPECT_EQ(skin(1, {0, 0, 1}, {1}),
            "the weights of vertex 0 add up to 0.000000, not to 1; repair them where the skin is made");
  EXPECT_EQ(skin(0, {0}, {}), "the skin has 0 bones; a file of a skin has 1 to 16777215");
  EXPECT_EQ(skin(1, {0, 900, 1}, {1}), "the skin's influences do not fit its vertices");
  EXPECT_EQ(skin(1, {1, 1}, {1}), "the skin's influences do not fit its vertices");
  AffineTransform bad;
  bad.translation.y = nan;
  EXPECT_EQ(error_text([&] {
              write_bone_frames(path, {1, {AffineTransform(), bad}});
            }),
            "frame 1: the transform of bone 0 is not finite; repair it where the transforms are made");
  EXPECT_EQ(error_text([&] {
              write_bone_frames(path, {1, {}});
            }),
            "there is no frame to write: a file of transforms has one or more, of one bone or more");
  EXPECT_FALSE(fs::exists(path));
}

TEST(SkinFile, what_does_not_fit_is_refused_by_name) {
  const ScratchFolder folder;
  const auto skin = [&](const std::string& bytes, const std::string& fragment) {
    const fs::path path = folder.file("w.npy", bytes);
    expect_file_error(path, 0, fragment, [&] { read_skin(path, one_facet()); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  skin("v 0 0 0\n", "not a NumPy file");
  skin(npy("<f8", "(2, 1)", std::vector<double>{1, 1}), "(3, bones) for the vertices");
  skin(npy("<f8", "(3, 0)", std::vector<double>{}), "one bone or more");
  skin(npy("<f8", "(3,)", std::vector<double>{1, 1, 1}), "(vertices, bones)");
  skin(npy("<f8", "(3, 1)", std::vector<double>{1, 0.9, 1}), "vertex 1 add up to 0.9");
  skin(npy("<f8", "(3, 1)", std::vector<double>{1, 1, nan}), "vertex 2 add up to nan");
  const auto bones = [&](const std::string& bytes, const std::string& fragment) {
    const fs::path path = folder.file("t.npy", bytes);
    expect_file_error(path, 0, fragment, [&] { read_bone_frames(path, 1); });
  };
  bones(npy("<f8", "(1, 1, 4, 3)", one_frame), "(frames, bones, 3, 4)");
  bones(npy("<f8", "(1, 1, 2, 4)", std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}), "(frames, 1, 3, 4)");
  bones(npy("<f8", "(0, 1, 3, 4)", std::vector<double>{}), "one frame or more");
  std::vector<double> bad = one_frame;
  bad[7] = nan;
  bones(npy("<f8", "(1, 1, 3, 4)", bad), "frame 0: the transform of bone 0 is not finite");
}

#ifndef MORULA_HAS_GLTF
TEST(Gltf, a_build_without_it_says_what_to_do) {
  const ScratchFolder folder;
  const fs::path path = folder.file("body.glb", "glTF");
  const std::string remedy = "MORULA_GLTF";
  expect_file_error(path, 0, remedy, [&] { read_mesh(path); });
  expect_file_error(path, 0, remedy, [&] { Motion(path, one_facet()); });
  expect_file_error(path, 0, remedy, [&] { read_skin(path, one_facet()); });
  expect_file_error(path, 0, remedy, [&] { read_bone_frames(path, 1); });
}
#endif

}  // namespace
}  // namespace morula::test
