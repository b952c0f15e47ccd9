// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What stands in the folder, whatever happens while something is written.
#include <gtest/gtest.h>

#include <fstream>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/whole_output.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

void put(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(WholeFile, a_link_stays_and_what_it_leads_to_is_replaced) {
  if (!can_make_links()) GTEST_SKIP() << no_links;
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "far");
  put(folder.path() / "far/real.txt", "old");
  fs::create_symlink("far/real.txt", folder.path() / "near.txt");
  fs::create_symlink("near.txt", folder.path() / "link.txt");
  write_whole(folder.path() / "link.txt", "new");
  EXPECT_EQ(bytes_of(folder.path() / "far/real.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link.txt"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "near.txt"));
  // A link that leads nowhere yet.
  fs::create_symlink("far/made.txt", folder.path() / "empty.txt");
  write_whole(folder.path() / "empty.txt", "made");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "empty.txt"));
  EXPECT_EQ(bytes_of(folder.path() / "far/made.txt"), "made");
  EXPECT_EQ(folder.names(), (Names{"empty.txt", "far", "link.txt", "near.txt"}));

  fs::create_symlink("b.txt", folder.path() / "a.txt");
  fs::create_symlink("a.txt", folder.path() / "b.txt");
  expect_file_error(folder.path() / "a.txt", 0, "circle", [&] { write_whole(folder.path() / "a.txt", "x"); });
}

TEST(WholeFile, what_others_left_or_put_there_is_neither_touched_nor_in_the_way) {
  const ScratchFolder folder;
  put(folder.path() / "victim", "precious");
  for (int n = 0; n < 1000; ++n) {
    const fs::path taken = folder.path() / (".morula-" + std::to_string(n) + ".tmp");
    if (can_make_links())
      fs::create_symlink("victim", taken);
    else
      fs::create_hard_link(folder.path() / "victim", taken);
  }
  put(folder.path() / "a.csv.partial", "mine");
  write_whole(folder.path() / "a.csv", "table");
  EXPECT_EQ(bytes_of(folder.path() / "a.csv"), "table");
  EXPECT_EQ(bytes_of(folder.path() / "victim"), "precious");
  EXPECT_EQ(bytes_of(folder.path() / "a.csv.partial"), "mine");
  EXPECT_EQ(folder.names().size(), 1003u);
}

TEST(WholeFile, folders_are_not_replaced_and_not_made) {
  const ScratchFolder folder;
  expect_file_error(folder.path(), 0, "is a folder", [&] { write_whole(folder.path(), "x"); });
  expect_file_error(folder.path() / "missing/a", 0, "make the folder first",
                    [&] { write_whole(folder.path() / "missing/a", "x"); });
}

TEST(WholeFile, bytes_come_in_pieces_and_may_be_put_over_earlier_ones) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  {
    WholeFile file(path);
    file.write("hello ");
    file.write("there");
    file.overwrite(1, "u");
    EXPECT_FALSE(fs::exists(path));
    file.commit();
  }
  EXPECT_EQ(bytes_of(path), "hullo there");
  { WholeFile given_up(path); }
  EXPECT_EQ(bytes_of(path), "hullo there");
  EXPECT_EQ(folder.names(), Names{"a.txt"});
}

TEST(WholeFolder, changes_in_one_step_and_carries_everything_else_over) {
  const ScratchFolder folder;
  const fs::path target = folder.path() / "motion";
  fs::create_directories(target / "notes/deep");
  put(target / "0000.obj", "old");
  put(target / "readme.txt", "mine");
  put(target / "notes/deep/a.txt", "mine, too");
  {
    WholeFolder given_up(target);
    write_whole(given_up.path() / "0000.obj", "new");
    EXPECT_EQ(bytes_of(target / "0000.obj"), "old");
  }
  EXPECT_EQ(bytes_of(target / "0000.obj"), "old");
  EXPECT_EQ(folder.names(), Names{"motion"});

  WholeFolder stage(target);
  write_whole(stage.path() / "0000.obj", "new");
  write_whole(stage.path() / "0001.obj", "newer");
  EXPECT_EQ(bytes_of(target / "0000.obj"), "old");
  stage.commit();
  EXPECT_EQ(bytes_of(target / "0000.obj"), "new");
  EXPECT_EQ(bytes_of(target / "0001.obj"), "newer");
  EXPECT_EQ(bytes_of(target / "readme.txt"), "mine");
  EXPECT_EQ(bytes_of(target / "notes/deep/a.txt"), "mine, too");
  EXPECT_EQ(folder.names(), Names{"motion"});
}

TEST(WholeFolder, a_folder_that_cannot_be_made_is_refused_with_the_reason) {
  const ScratchFolder folder;
  const auto expect_reason = [](const fs::path& target, const std::string& reason, std::errc error) {
    try {
      const WholeFolder made(target);
      ADD_FAILURE() << target << " was made";
    } catch (const SystemFileError& failure) {
      EXPECT_NE(std::string(failure.what()).find(reason), std::string::npos) << failure.what();
      EXPECT_EQ(failure.error(), static_cast<int>(error)) << failure.what();
    }
  };
  put(folder.path() / "file", "mine");
  expect_reason(folder.path() / "missing/out", "there is no folder", std::errc::no_such_file_or_directory);
  expect_reason(folder.path() / "file/out", "is a file, not a folder", std::errc::not_a_directory);
#ifndef _WIN32
  expect_reason(folder.path() / "file/a/out", "Not a directory", std::errc::not_a_directory);
  expect_reason(folder.path() / std::string(300, 'a') / "out", "File name too long", std::errc::filename_too_long);
  fs::create_directories(folder.path() / "closed/in");
  fs::permissions(folder.path() / "closed", fs::perms::none);
  std::error_code hidden;
  if (!fs::exists(folder.path() / "closed/in", hidden) && hidden)  // the administrator sees it all the same
    expect_reason(folder.path() / "closed/in/out", "Permission denied", std::errc::permission_denied);
  fs::permissions(folder.path() / "closed", fs::perms::owner_all);
#endif
  EXPECT_EQ(bytes_of(folder.path() / "file"), "mine");
}

TEST(WholeFolder, a_link_to_a_folder_is_written_through) {
  if (!can_make_links()) GTEST_SKIP() << no_links;
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "real");
  fs::create_directory_symlink("real", folder.path() / "link");
  WholeFolder stage(folder.path() / "link/");
  write_whole(stage.path() / "a", "new");
  stage.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(bytes_of(folder.path() / "real/a"), "new");
}

TEST(WholeFolder, the_current_folder_stays_the_current_folder) {
  const ScratchFolder folder;
  put(folder.path() / "0000.obj", "old");
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  {
    WholeFolder stage(".");
    write_whole(stage.path() / "0000.obj", "new");
    EXPECT_EQ(bytes_of("0000.obj"), "old");
    stage.commit();
  }
  fs::current_path(before);
  EXPECT_EQ(bytes_of(folder.path() / "0000.obj"), "new");
  EXPECT_EQ(folder.names(), Names{"0000.obj"});
}

TEST(WholeFolder, a_failure_in_the_middle_of_merging_moves_everything_back) {
  const ScratchFolder folder;
  Names before;
  for (int n = 10; n < 50; n += 2) {
    put(folder.path() / std::to_string(n), "old");
    before.push_back(std::to_string(n));
  }
  {
    WholeFolder stage(folder.path(), WholeFolder::Mode::merge);
    for (int n = 10; n < 50; ++n) put(stage.path() / std::to_string(n), "new");
    // The folder that is written into cannot move into itself.
    put(stage.path() / stage.path().filename(), "in the way");
    expect_file_error(folder.path(), 0, "nothing was changed", [&] { stage.commit(); });
  }
  EXPECT_EQ(folder.names(), before);
  for (const std::string& name : before) EXPECT_EQ(bytes_of(folder.path() / name), "old") << name;
}

TEST(Room, what_plainly_cannot_fit_is_refused_before_it_is_written) {
  const ScratchFolder folder;
  expect_file_error(folder.path() / "a.npy", 0, "its disk has", [&] {
    require_room(folder.path() / "not/yet/a.npy", 1);
    require_room(folder.path() / "a.npy", std::uint64_t{1} << 60);
  });
  const Mesh mesh = small_mesh();
  expect_file_error(folder.path() / "a.npy", 0, "", [&] { MotionWriter(folder.path() / "a.npy", mesh, 1ull << 50); });
  EXPECT_TRUE(folder.names().empty());
}

TEST(SameFile, by_whatever_name) {
  const ScratchFolder folder;
  put(folder.path() / "a", "same");
  put(folder.path() / "b", "same");
  fs::create_hard_link(folder.path() / "a", folder.path() / "hard");
  EXPECT_TRUE(is_same_file(folder.path() / "a", folder.path() / "hard"));
  if (can_make_links()) {
    fs::create_symlink("a", folder.path() / "link");
    EXPECT_TRUE(is_same_file(folder.path() / "link", folder.path() / "hard"));
  }
  EXPECT_FALSE(is_same_file(folder.path() / "a", folder.path() / "b"));
  EXPECT_FALSE(is_same_file(folder.path() / "c", folder.path() / "c"));
}

TEST(MotionWriter, keeps_one_frame_in_memory_and_the_rest_in_a_file) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  MotionWriter writer(folder.path() / "a.npy", mesh, 3);
  std::uintmax_t last = 0;
  for (int frame = 0; frame < 3; ++frame) {
    writer.write(mesh.positions);
    ASSERT_EQ(folder.names().size(), 1u);
    const std::uintmax_t size = fs::file_size(folder.path() / folder.names()[0]);
    EXPECT_GE(size, last + 24 * mesh.vertex_count());
    last = size;
  }
  writer.finish();
  EXPECT_EQ(fs::file_size(folder.path() / "a.npy"), last);
}

TEST(MotionWriter, an_older_motion_stays_whole_until_the_new_one_is) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "m";
  const Mesh mesh = small_mesh();
  Mesh moved = mesh;
  for (Vec3& p : moved.positions) p = 2.0 * p;
  const auto write = [&](const Mesh& shape, std::size_t frames) {
    MotionWriter writer(path, mesh, 3);
    for (std::size_t i = 0; i < frames; ++i) writer.write(shape.positions);
    if (frames == 3) writer.finish();
  };
  write(mesh, 3);
  write(moved, 2);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(Motion(path, mesh).frame(i), mesh.positions);
  write(moved, 3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(Motion(path, mesh).frame(i), moved.positions);
  EXPECT_EQ(folder.names(), Names{"m"});
}

TEST(MotionFile, a_missing_frame_is_named) {
  const ScratchFolder folder;
  const Mesh mesh = small_mesh();
  const auto frames = [&](const Names& names) {
    fs::remove_all(folder.path() / "m");
    fs::create_directory(folder.path() / "m");
    for (const std::string& name : names) write_mesh(folder.path() / "m" / name, mesh);
  };
  const auto missing = [&](const Names& names, const std::string& name) {
    frames(names);
    expect_file_error(folder.path() / "m", 0, name + " is missing between", [&] { Motion(folder.path() / "m", mesh); });
  };
  missing({"0000.obj", "0001.obj", "0003.obj", "0004.obj"}, "0002.obj");
  missing({"body2_f1.ply", "body2_f2.ply", "body2_f9.ply"}, "body2_f3.ply");
  missing({"f008.obj", "f009.obj", "f011.obj"}, "f010.obj");
  missing({"f0.obj", "f5.obj", "f10.obj", "f20.obj"}, "f15.obj");
  const auto fine = [&](const Names& names, const std::string& pattern = "") {
    frames(names);
    const fs::path path = pattern.empty() ? folder.path() / "m" : folder.path() / "m" / pattern;
    EXPECT_EQ(Motion(path, mesh).frame_count() > 0, true);
  };
  fine({"0005.obj", "0006.obj", "0007.obj"});
  fine({"f0.obj", "f5.obj", "f10.obj", "f15.obj"});
  fine({"9.obj", "10.obj", "11.obj"});
  fine({"rest.obj", "left.obj", "right3.obj"});
  fine({"f1.obj", "f01.obj", "f7.obj"});
  // The pattern leaves 2 to 9 out on purpose.
  fine({"f1.obj", "f2.obj", "f10.obj", "f11.obj", "f12.obj"}, "f1*.obj");
}

}  // namespace
}  // namespace morula::test
