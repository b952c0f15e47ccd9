// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files by any name, and replaced as a whole or not at all: judged by what the C++ library finds in the folder.
#include "platform/files.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>
#include <morula/io/files.hpp>
#include <morula/io/whole_output.hpp>
#include <string>
#include <support/scratch_folder.hpp>

namespace morula::test {
namespace {

namespace fs = std::filesystem;
using platform::NodeKind;

// Scripts of several planes, a name that ends before its dot, blanks.
const std::vector<std::u8string> odd_names{u8"K\u00fcgelbaum.txt", u8"\u4e2d\u6587 \u6a21\u578b.txt",
                                           u8"\U0001F333.txt", u8"a b  c.txt", u8"\u03b1'&(1).txt"};

std::size_t entries_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(PlatformFiles, names_of_any_script_are_written_replaced_and_read) {
  const ScratchFolder folder;
  for (const std::u8string& name : odd_names) {
    const fs::path path = folder.path() / name;
    write_whole(path, "old");
    EXPECT_EQ(bytes_of(path), "old");
    write_whole(path, "new");
    EXPECT_EQ(bytes_of(path), "new");
    EXPECT_EQ(platform::kind_of(path), NodeKind::file);
    std::string read;
    bool is_file = false;
    EXPECT_EQ(platform::read_file(
                  path, [&](std::string_view part) { read += part; }, is_file),
              0);
    EXPECT_TRUE(is_file);
    EXPECT_EQ(read, "new");
  }
  std::size_t found = 0;
  for (const auto& entry : fs::directory_iterator(folder.path()))
    for (const std::u8string& name : odd_names) found += entry.path().filename().u8string() == name ? 1 : 0;
  EXPECT_EQ(found, odd_names.size());
  EXPECT_EQ(entries_in(folder.path()), odd_names.size());
}

TEST(PlatformFiles, long_paths_are_written_replaced_and_read) {
  const ScratchFolder folder;
  fs::path deep = folder.path();
  while (deep.native().size() < 400) {
    deep /= std::string(60, 'd');
    ASSERT_EQ(platform::create_folder(deep, false), 0) << deep;
  }
  const fs::path path = deep / "file.txt";
  {
    WholeFile given_up(path);
    given_up.write("half");
  }
  EXPECT_EQ(platform::kind_of(path), NodeKind::missing);
  write_whole(path, "old");
  write_whole(path, "new");
  std::string read;
  bool is_file = false;
  EXPECT_EQ(platform::read_file(
                path, [&](std::string_view part) { read += part; }, is_file),
            0);
  EXPECT_EQ(read, "new");
  EXPECT_TRUE(is_same_file(path, deep / "." / "file.txt"));
  // Near the limit of systems that have one, the hidden name beside a file is longer than its own.
  for (std::size_t length = 225; length <= 265; ++length) {
    fs::path near = folder.path() / std::string(60, 'd');
    if (near.native().size() + 2 >= length) continue;
    near /= std::string(std::min<std::size_t>(length - near.native().size() - 1, 200), 'n');
    write_whole(near, "near");
    EXPECT_EQ(platform::kind_of(near), NodeKind::file) << length;
    EXPECT_EQ(platform::remove_file(near), 0);
  }
}

TEST(PlatformFiles, an_abandoned_or_failed_write_changes_nothing) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  write_whole(path, "old");
  {
    WholeFile given_up(path);
    given_up.write(std::string(100000, 'x'));
    EXPECT_EQ(bytes_of(path), "old");
    EXPECT_EQ(entries_in(folder.path()), 2u);
  }
  EXPECT_EQ(bytes_of(path), "old");
  EXPECT_EQ(entries_in(folder.path()), 1u);
  // A name that a folder takes while the file is written.
  const fs::path taken = folder.path() / "taken";
  {
    WholeFile file(taken);
    file.write("new");
    fs::create_directory(taken);
    EXPECT_THROW(file.commit(), FileError);
  }
  EXPECT_TRUE(fs::is_directory(taken));
  EXPECT_EQ(entries_in(folder.path()), 2u);
}

TEST(PlatformFiles, a_file_that_is_read_meanwhile_is_replaced_or_stays_as_it_was) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  write_whole(path, "old");
  std::ifstream reader(path, std::ios::binary);
  ASSERT_TRUE(reader);
  bool is_replaced = true;
  try {
    write_whole(path, "new");
  } catch (const FileError& error) {
    is_replaced = false;
    EXPECT_NE(std::string(error.what()).find("nothing was changed"), std::string::npos) << error.what();
  }
  std::string read;
  reader >> read;
  EXPECT_EQ(read, "old");
  reader.close();
  EXPECT_EQ(bytes_of(path), is_replaced ? "new" : "old");
  EXPECT_EQ(entries_in(folder.path()), 1u);
}

TEST(PlatformFiles, a_folder_with_an_open_file_is_filled_and_keeps_the_files_of_others) {
  const ScratchFolder folder;
  const fs::path target = folder.path() / "frames";
  fs::create_directory(target);
  write_whole(target / "0000.obj", "old");
  write_whole(target / "notes.txt", "mine");
  std::ifstream reader(target / "notes.txt", std::ios::binary);
  WholeFolder stage(target);
  write_whole(stage.path() / "0000.obj", "new");
  write_whole(stage.path() / "0001.obj", "newer");
  stage.commit();
  reader.close();
  EXPECT_EQ(bytes_of(target / "0000.obj"), "new");
  EXPECT_EQ(bytes_of(target / "0001.obj"), "newer");
  EXPECT_EQ(bytes_of(target / "notes.txt"), "mine");
  EXPECT_EQ(entries_in(target), 3u);
  EXPECT_EQ(entries_in(folder.path()), 1u);
}

TEST(PlatformFiles, bytes_come_in_parts_and_may_be_put_over_earlier_ones) {
  const ScratchFolder folder;
  int error = -1;
  const int file = platform::create_file(folder.path() / "a", false, error);
  ASSERT_GE(file, 0);
  EXPECT_EQ(error, 0);
  EXPECT_EQ(platform::append(file, "hello\n"), 0);
  EXPECT_EQ(platform::overwrite(file, 1, "u"), 0);
  EXPECT_EQ(platform::append(file, "there"), 0);
  EXPECT_EQ(platform::sync_file(file), 0);
  EXPECT_EQ(platform::close_file(file), 0);
  EXPECT_EQ(bytes_of(folder.path() / "a"), "hullo\nthere");
  EXPECT_EQ(platform::create_file(folder.path() / "a", false, error), -1);
  EXPECT_EQ(error, EEXIST);
  EXPECT_EQ(platform::create_file(folder.path() / "none/a", false, error), -1);
  EXPECT_EQ(error, ENOENT);
  EXPECT_EQ(platform::create_folder(folder.path() / "a", false), EEXIST);
}

TEST(PlatformFiles, kinds_and_names_are_told_apart) {
  const ScratchFolder folder;
  const fs::path a = folder.path() / "a", b = folder.path() / "b";
  write_whole(a, "same");
  write_whole(b, "same");
  ASSERT_EQ(platform::link_file(a, folder.path() / "link"), 0);
  EXPECT_TRUE(platform::is_same_file(a, folder.path() / "link"));
  EXPECT_FALSE(platform::is_same_file(a, b));
  EXPECT_FALSE(platform::is_same_file(folder.path() / "c", folder.path() / "c"));
  EXPECT_TRUE(platform::is_same_file(folder.path(), folder.path() / "."));
  int error = 0;
  EXPECT_EQ(platform::kind_of(folder.path() / "c", error), NodeKind::missing);
  EXPECT_EQ(error, ENOENT);
  EXPECT_EQ(platform::kind_of(folder.path(), error), NodeKind::folder);
  EXPECT_EQ(error, 0);
  bool is_file = true;
  const auto nothing = [](std::string_view) { FAIL() << "a folder is read"; };
  EXPECT_TRUE(platform::read_file(folder.path(), nothing, is_file) != 0 || !is_file);
  EXPECT_FALSE(platform::is_mount_point(folder.path()));
}

TEST(PlatformFiles, a_name_that_no_file_can_have_is_too_long) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / std::string(300, 'x');
  int error = 0;
  EXPECT_EQ(platform::kind_of(path, error), NodeKind::missing);
  EXPECT_EQ(error, ENAMETOOLONG);
  EXPECT_EQ(platform::create_file(path, false, error), -1);
  EXPECT_EQ(error, ENAMETOOLONG);
  EXPECT_EQ(platform::create_folder(path, false), ENAMETOOLONG);
  write_whole(folder.path() / "a", "kept");
  EXPECT_EQ(platform::rename_over(folder.path() / "a", path), ENAMETOOLONG);
  EXPECT_EQ(bytes_of(folder.path() / "a"), "kept");
}

TEST(PlatformFiles, the_root_is_a_mount_point) {
  EXPECT_TRUE(platform::is_mount_point(fs::current_path().root_path()));
}

TEST(PlatformFiles, two_folders_change_names_in_one_step_or_not_at_all) {
  const ScratchFolder folder;
  const fs::path a = folder.path() / "a", b = folder.path() / "b";
  write_whole(folder.file("a/in_a", "1"), "1");
  write_whole(folder.file("b/in_b", "2"), "2");
  const bool is_changed = platform::exchange(a, b);
  EXPECT_EQ(fs::exists(a / "in_b"), is_changed);
  EXPECT_EQ(fs::exists(b / "in_a"), is_changed);
  EXPECT_EQ(fs::exists(a / "in_a"), !is_changed);
  EXPECT_EQ(fs::exists(b / "in_b"), !is_changed);
}

}  // namespace
}  // namespace morula::test
