// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A stranger's first hour, in five roles: what they type in an empty folder, slips and damaged files too, and what the
// command has to answer. Every line is one that somebody could paste.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// What is typed after "morula"; its exit code; words that stdout and stderr together must hold; files that are there
/// afterwards.
struct Step {
  std::string typed;
  int exit_code = 0;
  std::vector<std::string> says{};
  std::vector<std::string> leaves{};
};

void walk(const Workbench& bench, const std::vector<Step>& steps) {
  for (const Step& step : steps) {
    if (!has_command(step.typed.substr(0, step.typed.find(' ')))) continue;
    const auto before = bench.listing();
    const CommandResult result = bench.run(step.typed);
    EXPECT_EQ(result.exit_code, step.exit_code) << "morula " << step.typed << "\n" << result.out << result.err;
    for (const std::string& words : step.says)
      EXPECT_NE((result.out + result.err).find(words), std::string::npos)
          << "morula " << step.typed << " does not say: " << words << "\n"
          << result.out << result.err;
    for (const std::string& file : step.leaves)
      EXPECT_TRUE(std::filesystem::exists(bench / file)) << "morula " << step.typed << " leaves no " << file;
    if (step.exit_code == 2) {
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << step.typed << "\n" << result.err;
      EXPECT_EQ(bench.listing(), before) << "morula " << step.typed << " was refused and changed files";
    }
    EXPECT_EQ(result.err.find("internal"), std::string::npos) << result.err;
  }
}

// 1: "does it do what the paper says, and does it cover?"
TEST(Stranger, in_graphics_research) {
  const Workbench bench;
  walk(bench,
       {
           {"--version"},
           {"sample limb -o limb.obj --resolution 16", 0, {"640 facets"}, {"limb.obj"}},
           {"build limb.obj -o limb.morula --method hubbard", 0, {"covers", "written"}, {"limb.morula"}},
           {"info limb.morula --check --mesh limb.obj", 0},
           {"measure limb.obj limb.morula --csv levels.csv --plot levels.svg --resolution 64",
            0,
            {"Covers"},
            {"levels.csv", "levels.svg"}},
           {"deform limb.obj -o bend --bend 90 --frames 5", 0, {}, {"bend/0000.obj"}},
           {"update limb.obj limb.morula bend -o spheres --rule approach2 --measure",
            0,
            {"Does not cover"},
            {"spheres"}},
           {"update limb.obj limb.morula bend -o spheres --rule exact", 0, {"certificate  holds"}},
           {"build limb.obj -o limb.morula --method hubard", 2, {"hubard", "hubbard"}},
           {"studdy", 2, {"studdy"}},
           {"study --quick --mesh limb.obj --methods grid --rules approach2,exact --frames 3 --resolution 32 -o study",
            0,
            {"exact leaves no surface uncovered"},
            {"study/cells.csv", bench.has_page() ? "study/index.html" : "study/study.json"}},
       });
}

// 2: "fifty bodies, a millisecond, and my own exporter's files"
TEST(Stranger, in_games) {
  const Workbench bench;
  bench.write("crate.obj",
              "o crate\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
              "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  // Every facet with corners of its own, as exporters for games write them.
  bench.write("soup.obj",
              "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 0 0\nv 0 1 0\nv 0 0 1\nv 1 0 0\nv 0 0 1\n"
              "v 0 1 0\nf 1 3 2\nf 4 6 5\nf 7 9 8\nf 10 12 11\n");
  walk(bench, {
                  {"build crate.obj -o crate.morula", 0, {"covers"}, {"crate.morula"}},
                  {"info crate.morula", 0, {"depth 1"}},
                  {"build crate.obj -o crate.ply --spheres 12 --quality fast", 0, {}, {"crate.ply"}},
                  {"info crate.ply", 0, {"12"}},
                  {"info soup.obj", 0, {"repair"}},
                  {"repair soup.obj -o whole.obj", 0, {"merged"}, {"whole.obj"}},
                  {"info whole.obj --json", 0, {"\"closed\""}},
                  {"collide crate.obj crate.obj --translate-b 0.5,0.2,0 --crossings --budget 200us", 0, {"contacts"}},
                  {"collide crate.obj", 2, {"name another one", "--self"}},
                  {"collide crate.obj missing.obj", 2, {"missing.obj", "no such file"}},
                  {"build crate.obj -o no/such/folder/crate.morula", 2, {"no/such/folder"}},
                  {"build crate.obj -o crate.morula --branching 8.5", 2, {"8.5", "whole number"}},
              });
}

// 3: "a liver with modes, and a probe that must not miss it"
TEST(Stranger, in_surgery) {
  const Workbench bench;
  walk(
      bench,
      {
          {"sample limb -o leber.ply --resolution 12", 0, {}, {"leber.ply"}},
          {"sample limb-modes -o modes.npy --resolution 12", 0, {}, {"modes.npy"}},
          {"sample limb-coords -o coords.npy", 0, {}, {"coords.npy"}},
          {"build leber.ply -o leber.morula --quality fast", 0, {"covers"}},
          {"update leber.ply leber.morula --modes modes.npy --coords coords.npy -o moved.npz",
           0,
           {"holds"},
           {"moved.npz"}},
          {"info moved.npz", 0},
          {"sample tool -o tool.obj", 0, {}, {"tool.obj"}},
          {"deform leber.ply -o poke.npy --poke --frames 4", 0, {}, {"poke.npy"}},
          {"collide leber.ply tool.obj --tree-a leber.morula --motion-a poke.npy --translate-b 0,0.8,0 -o contacts.csv "
           "--plot contacts.svg",
           0,
           {"summary"},
           {"contacts.csv", "contacts.svg"}},
          {"update leber.ply leber.morula gone/ -o moved.npz", 2, {"no such folder"}},
          {"deform tool.obj -o tool.npy --twist 20 --frames 3", 0, {}, {"tool.npy"}},
          {"update tool.obj leber.morula tool.npy -o other.npz", 2, {"leber.morula"}},
      });
}

// 4: "spheres for my planner, as few as do"
TEST(Stranger, in_robotics) {
  const Workbench bench;
  walk(bench,
       {
           {"sample capsule -o \"Größe 链接.obj\" --resolution 12", 0, {}, {"Größe 链接.obj"}},
           {"build \"Größe 链接.obj\" -o \"Größe 链接.ply\" --spheres 16 --quality fast", 0, {}, {"Größe 链接.ply"}},
           {"build \"Größe 链接.obj\" -o link.json --max-protrusion 0.05 --method grid", 0, {}, {"link.json"}},
           {"measure \"Größe 链接.obj\" link.json --resolution 48", 0, {"Covers"}},
           {"convert link.json link.sph", 0, {}, {"link.sph"}},
           {"convert link.sph link.morula --mesh \"Größe 链接.obj\"", 0, {}, {"link.morula"}},
           {"build \"Größe 链接.obj\" -o link.ply --spheres 0",
            2,
            {"--spheres", "'0' is not a whole number of 1 or more"}},
           {"build \"Größe 链接.obj\" -o link.ply", 2, {"--spheres"}},
           {"--licenses", 0, {"CLI11", bench.has_page() ? "three.js" : "nlohmann"}},
       });
}

// 5: "ten thousand files, some of them rubbish"
TEST(Stranger, with_data) {
  const Workbench bench;
  bench.require("sample torus -o torus.obj --resolution 8");
  bench.write("half.obj", bench.read("torus.obj").substr(0, bench.read("torus.obj").size() / 2));
  bench.write("open.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  bench.write("words.obj", "v 0 0 zero\nf 1 1 1\n");
  bench.write("empty.obj", "");
  bench.write("picture.png", "\x89PNG");
  bench.write("cut.morula", "MORULA");
  walk(bench, {
                  {"info torus.obj --json", 0, {"\"facets\""}},
                  {"build torus.obj -o torus.npz --method octree", 0, {}, {"torus.npz"}},
                  {"info torus.npz", 0},
                  {"info half.obj", 2, {"half.obj"}},
                  {"build words.obj -o x.morula", 2, {"words.obj:1", "not a number"}},
                  {"build empty.obj -o x.morula", 2, {"empty.obj"}},
                  {"build picture.png -o x.morula", 2, {"picture.png", ".obj"}},
                  {"info cut.morula", 2, {"cut.morula"}},
                  {"build open.obj -o open.morula --method octree", 0, {"covers"}},
                  {"measure open.obj open.morula --resolution 48", 0, {"Covers"}},
                  {"measure torus.obj open.morula --csv torus.obj", 2, {"torus.obj"}},
                  {"build torus.obj --json -o y.morula --method nothing", 2, {"{", "nothing"}},
                  {"build torus.obj -o torus.morula --method octree --time-limit 60", 0, {"covers"}},
              });
}

}  // namespace
}  // namespace morula::test
