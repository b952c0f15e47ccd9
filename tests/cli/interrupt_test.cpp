// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, as a signal to a running child.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <thread>

#include "workbench.hpp"

extern char** environ;

namespace morula::test {
namespace {

using Clock = std::chrono::steady_clock;

/// A command that runs by itself, with its output in a file beside the folder.
class Child {
 public:
  Child(const Workbench& bench, std::vector<std::string> arguments, const std::filesystem::path& err) {
    arguments.insert(arguments.begin(), MORULA_COMMAND);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addchdir_np(&files, bench.folder().c_str());
    posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, 2, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    // A test run in the background has SIGINT ignored, which children would inherit.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGINT);
    sigaddset(&defaults, SIGTERM);
    sigaddset(&defaults, SIGHUP);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    EXPECT_EQ(posix_spawn(&id_, MORULA_COMMAND, &files, &attributes, argv.data(), environ), 0);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
  }
  void send(int signal) const { EXPECT_EQ(kill(id_, signal), 0); }
  bool is_running() const {
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(id_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
  }
  /// The exit code; −1 when a signal ended it.
  int wait() {
    int status = 0;
    EXPECT_EQ(waitpid(id_, &status, 0), id_);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t id_ = -1;
};

TEST(Interrupt, ends_a_build_with_nothing_left_behind) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 24");
  bench.write("old.morula", "an older result");
  const auto before = bench.listing();
  const std::filesystem::path err = bench.folder().string() + ".err";
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
    // Minutes of work.
    Child child(bench, {"build", "limb.obj", "-o", "old.morula", "--method", "medial", "--depth", "6"}, err);
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const auto sent = Clock::now();
    child.send(signal);
    EXPECT_EQ(child.wait(), code);
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - sent).count(), 5.0);
    EXPECT_EQ(bench.listing(), before);
    EXPECT_EQ(bytes_of(err), "morula: interrupted; nothing was written\n");
  }
  std::filesystem::remove(err);
}

/// Hidden files and folders: what is being written.
std::size_t hidden_in(const Workbench& bench) {
  std::size_t count = 0;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator(bench.folder(), gone)) {
    count += entry.path().filename().string().front() == '.' ? 1 : 0;
  }
  return count;
}

TEST(Interrupt, leaves_nothing_of_any_command_that_writes_for_a_while) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 24");
  bench.require("build limb.obj -o limb.morula --method octree --depth 3");
  bench.require("deform limb.obj -o motion.npy --twist 90 --frames 1500");
  bench.require("deform limb.obj -o old --twist 30 --frames 3");
  const auto before = bench.listing();
  const std::filesystem::path err = bench.folder().string() + ".err";
  std::vector<std::vector<std::string>> commands{
      {"deform", "limb.obj", "-o", "new", "--bend", "90", "--frames", "100000"},
      {"deform", "limb.obj", "-o", "new.npy", "--bend", "90", "--frames", "20000"},
      {"deform", "limb.obj", "-o", "motion.npy", "--bend", "90", "--frames", "20000"},
      {"update", "limb.obj", "limb.morula", "motion.npy", "-o", "spheres"},
      {"update", "limb.obj", "limb.morula", "motion.npy", "-o", "spheres.npz"},
  };
  if (has_extra("study")) commands.push_back({"demo", "--quick", "-o", "demo"});
  const std::vector<std::pair<int, int>> signals{{SIGINT, 130}, {SIGTERM, 143}, {SIGHUP, 129}};
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const auto [signal, code] = signals[i % signals.size()];
    Child child(bench, commands[i], err);
    while (hidden_in(bench) == 0) {
      ASSERT_TRUE(child.is_running()) << commands[i].front() << " -o " << commands[i][3];
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20 * i));
    child.send(signal);
    EXPECT_EQ(child.wait(), code) << commands[i].front() << " -o " << commands[i][3];
    EXPECT_EQ(bench.listing(), before) << commands[i].front();
    EXPECT_EQ(bytes_of(err), "morula: interrupted; nothing unfinished was left behind\n");
  }
  std::filesystem::remove(err);
}

TEST(Interrupt, leaves_nothing_of_any_command_that_computes_for_a_while) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 400");
  bench.require("sample limb -o small.obj --resolution 24");
  bench.require("build small.obj -o small.morula --method octree --depth 3");
  bench.require("deform small.obj -o motion.npy --twist 90 --frames 1500");
  bench.require("update small.obj small.morula motion.npy -o spheres.npz");
  bench.write("old.csv", "an older result");
  const auto before = bench.listing();
  const std::filesystem::path err = bench.folder().string() + ".err";
  const std::vector<std::vector<std::string>> commands{
      {"measure", "small.obj", "spheres.npz", "--motion", "motion.npy", "--csv", "old.csv"},
      {"collide", "small.obj", "small.obj", "--motion-a", "motion.npy", "--crossings", "-o", "old.csv"},
      {"collide", "limb.obj", "limb.obj", "-o", "new.csv"},
      {"medial", "limb.obj", "-o", "balls.ply", "--samples", "5000000", "--kind", "voronoi"},
      {"repair", "limb.obj", "-o", "new.obj", "--merge", "0.001", "--cap", "500"},
      {"convert", "limb.obj", "new.ply"},
      {"info", "limb.obj", "--json"},
      {"sample", "limb", "-o", "new.obj", "--resolution", "1500"},
  };
  const std::vector<std::pair<int, int>> signals{{SIGINT, 130}, {SIGTERM, 143}, {SIGHUP, 129}};
  std::size_t stopped_in_time = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const auto [signal, code] = signals[i % signals.size()];
    // A signal that comes before the program has begun ends it as the system does: then once more, later. A slow build,
    // as with sanitizers on a busy machine, takes a while to begin.
    int ended = -1;
    for (std::chrono::milliseconds delay(120); ended == -1 && delay < std::chrono::seconds(10); delay *= 3) {
      Child child(bench, commands[i], err);
      std::this_thread::sleep_for(delay);
      if (child.is_running()) child.send(signal);
      ended = child.wait();
      EXPECT_EQ(hidden_in(bench), 0u) << commands[i].front();
    }
    EXPECT_TRUE(ended == code || ended == 0) << commands[i].front() << " ended with " << ended;
    const auto after = bench.listing();
    if (after == before) {
      stopped_in_time += ended == code ? 1 : 0;
      continue;
    }
    // A quick one was done by then, or had its output in place: that is then the one of a command left alone.
    std::string line;
    for (const std::string& argument : commands[i]) line += argument + " ";
    bench.require(line);
    EXPECT_EQ(bench.listing(), after) << commands[i].front();
    for (const char* name : {"new.ply", "new.obj", "new.csv", "balls.ply"}) std::filesystem::remove(bench / name);
    bench.write("old.csv", "an older result");
  }
  // Some of them take seconds.
  EXPECT_GE(stopped_in_time, 3u);
  std::filesystem::remove(err);
}

TEST(LongInterrupt, leaves_finished_cells_of_a_study_to_go_on_from) {
  if (!has_extra("study")) GTEST_SKIP() << "the command was built without the study";
  const Workbench bench;
  bench.require("sample limb -o body.obj --resolution 8");
  const std::vector<std::string> arguments{"study",   "--quick",         "--mesh",    "body.obj",  "--frames",
                                           "30",      "--resolution",    "64",        "--methods", "grid,octree",
                                           "--rules", "approach2,exact", "--threads", "1"};
  const std::filesystem::path err = bench.folder().string() + ".err";
  const auto with_output = [&](const char* folder) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"-o", folder});
    return all;
  };
  Child child(bench, with_output("stopped"), err);
  const auto cells = [&] {
    std::error_code missing;
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(bench / "stopped/cells", missing)) {
      count += entry.path().extension() == ".json" ? 1 : 0;
    }
    return count;
  };
  while (cells() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  child.send(SIGINT);
  EXPECT_EQ(child.wait(), 130);
  EXPECT_LT(cells(), 12u);
  EXPECT_FALSE(std::filesystem::exists(bench / "stopped/study.json"));
  std::filesystem::remove(err);
  for (const char* folder : {"stopped", "whole"}) {
    Child again(bench, with_output(folder), err);
    EXPECT_EQ(again.wait(), 0);
  }
  EXPECT_TRUE(bench.read("stopped/cells.csv") == bench.read("whole/cells.csv"));
  EXPECT_TRUE(bench.read("stopped/fig2d-twist.csv") == bench.read("whole/fig2d-twist.csv"));
  std::filesystem::remove(err);
}

}  // namespace
}  // namespace morula::test
