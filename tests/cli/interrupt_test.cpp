// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ctrl-C and its like, while a command runs.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "running_command.hpp"

namespace morula::test {
namespace {

using Clock = std::chrono::steady_clock;

TEST(Interrupt, ends_a_build_with_nothing_left_behind) {
  if (!RunningCommand::can_send()) GTEST_SKIP() << RunningCommand::cannot_send;
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 24");
  bench.write("old.morula", "an older result");
  const auto before = bench.listing();
  const std::filesystem::path err = bench.folder().string() + ".err";
  for (const auto& [signal, code] : requests_to_end()) {
    // Minutes of work.
    RunningCommand child(bench, {"build", "limb.obj", "-o", "old.morula", "--method", "medial", "--depth", "6"}, err);
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
  if (!RunningCommand::can_send()) GTEST_SKIP() << RunningCommand::cannot_send;
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
  const auto signals = requests_to_end();
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const auto [signal, code] = signals[i % signals.size()];
    RunningCommand child(bench, commands[i], err);
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
  if (!RunningCommand::can_send()) GTEST_SKIP() << RunningCommand::cannot_send;
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
  const auto signals = requests_to_end();
  std::size_t stopped_in_time = 0;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const auto [signal, code] = signals[i % signals.size()];
    // A signal that comes before the program has begun ends it as the system does: then once more, later. A slow build,
    // as with sanitizers on a busy machine, takes a while to begin.
    int ended = -1;
    for (std::chrono::milliseconds delay(120); ended == -1 && delay < std::chrono::seconds(10); delay *= 3) {
      RunningCommand child(bench, commands[i], err);
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
  if (!RunningCommand::can_send()) GTEST_SKIP() << RunningCommand::cannot_send;
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
  RunningCommand child(bench, with_output("stopped"), err);
  const auto cells = [&] {
    std::error_code missing;
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(bench / "stopped/cells", missing)) {
      count += entry.path().extension() == ".json" ? 1 : 0;
    }
    return count;
  };
  while (cells() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const auto [signal, code] = requests_to_end().front();
  child.send(signal);
  EXPECT_EQ(child.wait(), code);
  EXPECT_LT(cells(), 12u);
  EXPECT_FALSE(std::filesystem::exists(bench / "stopped/study.json"));
  std::filesystem::remove(err);
  for (const char* folder : {"stopped", "whole"}) {
    RunningCommand again(bench, with_output(folder), err);
    EXPECT_EQ(again.wait(), 0);
  }
  EXPECT_TRUE(bench.read("stopped/cells.csv") == bench.read("whole/cells.csv"));
  EXPECT_TRUE(bench.read("stopped/fig2d-twist.csv") == bench.read("whole/fig2d-twist.csv"));
  std::filesystem::remove(err);
}

}  // namespace
}  // namespace morula::test
