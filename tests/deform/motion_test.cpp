// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <morula/deform/deformation.hpp>
#include <scenes/scenes.hpp>
#include <stdexcept>
#include <support/scoped_variable.hpp>
#include <support/scratch_folder.hpp>

namespace morula {
namespace {

TEST(FrameParameters, go_out_and_come_back) {
  for (std::size_t count = 3; count <= 40; ++count) {
    const std::vector<double> t = frame_parameters(count);
    ASSERT_EQ(t.size(), count);
    EXPECT_EQ(t.front(), 0.0);
    EXPECT_EQ(t.back(), 0.0);
    EXPECT_EQ(t[count / 2], 1.0) << count;
    EXPECT_EQ(t[(count - 1) / 2], 1.0) << count;
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(t[i], t[count - 1 - i]) << count;
    for (std::size_t i = 0; i < (count - 1) / 2; ++i) EXPECT_LT(t[i], t[i + 1]) << count;
  }
  EXPECT_EQ(frame_parameters(5), (std::vector<double>{0, 0.5, 1, 0.5, 0}));
  EXPECT_EQ(frame_parameters(6), (std::vector<double>{0, 0.5, 1, 1, 0.5, 0}));
}

TEST(FrameParameters, too_few_frames_stay_at_rest) {
  EXPECT_TRUE(frame_parameters(0).empty());
  EXPECT_EQ(frame_parameters(1), std::vector<double>{0});
  EXPECT_EQ(frame_parameters(2), (std::vector<double>{0, 0}));
  EXPECT_TRUE(frame_parameters(0, false).empty());
  EXPECT_EQ(frame_parameters(1, false), std::vector<double>{0});
}

TEST(FrameParameters, can_only_go_out) {
  EXPECT_EQ(frame_parameters(2, false), (std::vector<double>{0, 1}));
  EXPECT_EQ(frame_parameters(5, false), (std::vector<double>{0, 0.25, 0.5, 0.75, 1}));
  for (std::size_t count = 2; count <= 40; ++count) EXPECT_EQ(frame_parameters(count, false).back(), 1.0);
}

TEST(Scenes, standard_motions_are_one_of_each_kind) {
  std::vector<std::string> names;
  std::vector<std::size_t> kinds;
  for (const scenes::NamedMotion& motion : scenes::standard_motions()) {
    names.push_back(motion.name);
    ASSERT_EQ(motion.deformations.size(), 1u);
    kinds.push_back(motion.deformations[0].index());
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"stretch 2", "twist 180", "bend 90", "poke 0.15", "noise 0.05", "rotate 90"}));
  EXPECT_EQ(kinds, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Scenes, corpus_is_where_the_variable_says) {
  namespace fs = std::filesystem;
  const test::ScratchFolder scratch;
  const fs::path& folder = scratch.path();
  for (const char* name : {"b.off", "a.obj", "notes.txt", "below/c.stl"}) scratch.file(name, "x");
  {
    const test::ScopedVariable variable("MORULA_CORPUS", folder.string());
    EXPECT_EQ(scenes::corpus_folder(), folder);
    const std::vector<fs::path> expected{folder / "a.obj", folder / "b.off", folder / "below" / "c.stl"};
    EXPECT_EQ(scenes::corpus_meshes(), expected);
  }
  {
    const test::ScopedVariable variable("MORULA_CORPUS", "");
    EXPECT_EQ(scenes::corpus_folder(), std::nullopt);
    EXPECT_TRUE(scenes::corpus_meshes().empty());
  }
  {
    const test::ScopedVariable variable("MORULA_CORPUS", (folder / "missing").string());
    EXPECT_THROW(scenes::corpus_folder(), std::invalid_argument);
  }
}

}  // namespace
}  // namespace morula
