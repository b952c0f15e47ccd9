// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What stands in the folder, judged with the calls of POSIX: permissions, numbers of nodes, pipes and processes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>  // NOLINT(modernize-deprecated-headers): POSIX has more in it
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <thread>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

mode_t mode_of(const fs::path& path) {
  struct stat found {};
  EXPECT_EQ(stat(path.c_str(), &found), 0) << path;
  return found.st_mode & 07777;
}

ino_t inode_of(const fs::path& path) {
  struct stat found {};
  EXPECT_EQ(lstat(path.c_str(), &found), 0) << path;
  return found.st_ino;
}

void put_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Runs in a process of its own, which ends without a word.
void in_child(const std::function<void()>& work) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    work();
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  ASSERT_EQ(WEXITSTATUS(status), 0);
}

TEST(WholeFile, permissions_are_those_of_the_old_file_or_of_the_umask) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.txt";
  const mode_t before = umask(027);
  write_whole(path, "new");
  umask(before);
  EXPECT_EQ(mode_of(path), 0640u);
  for (const mode_t mode : {0600u, 0444u, 0755u, 0666u}) {
    ASSERT_EQ(chmod(path.c_str(), mode), 0);
    write_whole(path, "newer");
    EXPECT_EQ(mode_of(path), mode);
  }
}

TEST(WholeFile, a_full_disk_leaves_the_old_file_alone) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "a.bin";
  put_text(path, "old");
  in_child([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit small{100000, 100000};
    if (setrlimit(RLIMIT_FSIZE, &small) != 0) _exit(1);
    try {
      write_whole(path, std::string(200000, 'x'));
      _exit(2);
    } catch (const FileError& error) {
      if (std::string(error.what()).find("nothing was changed") == std::string::npos) _exit(3);
    }
  });
  EXPECT_EQ(bytes_of(path), "old");
  EXPECT_EQ(folder.names(), Names{"a.bin"});
}

TEST(WholeFile, devices_and_pipes_are_not_replaced) {
  const ScratchFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder.path() / "null");
  for (const fs::path& path : {pipe, folder.path() / "null"}) {
    expect_file_error(path, 0, "a device or a pipe", [&] { write_whole(path, "x"); });
  }
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(Abandon, removes_what_is_unfinished_and_lets_nobody_finish) {
  const ScratchFolder folder;
  put_text(folder.path() / "old", "old");
  in_child([&] {
    WholeFile file(folder.path() / "old");
    file.write("half");
    WholeFolder stage(folder.path() / "m");
    write_whole(stage.path() / "0000.obj", "half");
    WholeFile inside(stage.path() / "0001.obj");
    abandon_unfinished();
    std::thread([&] { file.commit(); }).detach();
    std::thread([&] { write_whole(folder.path() / "late", "late"); }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    _exit(0);
  });
  EXPECT_EQ(folder.names(), Names{"old"});
  EXPECT_EQ(bytes_of(folder.path() / "old"), "old");
}

TEST(WholeFolder, changes_in_one_step_and_keeps_permissions_and_nodes_of_everything_else) {
  const ScratchFolder folder;
  const fs::path target = folder.path() / "motion";
  fs::create_directories(target / "notes/deep");
  put_text(target / "0000.obj", "old");
  put_text(target / "readme.txt", "mine");
  put_text(target / "notes/deep/a.txt", "mine, too");
  fs::create_symlink("readme.txt", target / "link");
  ASSERT_EQ(chmod(target.c_str(), 0750), 0);
  const ino_t readme = inode_of(target / "readme.txt");
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
  EXPECT_EQ(inode_of(target / "readme.txt"), readme);
  EXPECT_EQ(bytes_of(target / "notes/deep/a.txt"), "mine, too");
  EXPECT_EQ(fs::read_symlink(target / "link"), "readme.txt");
  EXPECT_EQ(mode_of(target), 0750u);
  EXPECT_EQ(folder.names(), Names{"motion"});
}

TEST(WholeFolder, the_current_folder_stays_the_same_node) {
  const ScratchFolder folder;
  put_text(folder.path() / "0000.obj", "old");
  const ino_t inode = inode_of(folder.path());
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  {
    WholeFolder stage(".");
    write_whole(stage.path() / "0000.obj", "new");
    EXPECT_EQ(bytes_of("0000.obj"), "old");
    stage.commit();
  }
  fs::current_path(before);
  EXPECT_EQ(inode_of(folder.path()), inode);
  EXPECT_EQ(bytes_of(folder.path() / "0000.obj"), "new");
  EXPECT_EQ(folder.names(), Names{"0000.obj"});
}

}  // namespace
}  // namespace morula::test
