// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// --plot of measure, update and collide, and the small drawings in tables.
#include <gtest/gtest.h>

#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// A limb that bends, with a tree of levels 0 to 2, and a tool.
void prepare(const Workbench& bench) {
  bench.require("sample limb -o limb.obj --resolution 10");
  bench.require("sample capsule -o tool.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --method octree --depth 2");
  bench.require("build tool.obj -o tool.morula --method octree --depth 2");
  bench.require("deform limb.obj -o bend.npy --bend 60 --frames 5");
  bench.require("deform limb.obj -o bend --bend 60 --frames 5");
}

const std::string touch = "collide limb.obj tool.obj --tree-a limb.morula --tree-b tool.morula --motion-a bend.npy";

TEST(Plots, are_whole_drawings_that_name_their_panels_and_lines) {
  const Workbench bench;
  prepare(bench);
  bench.require("update limb.obj limb.morula bend.npy -o spheres --rule approach2 --measure --plot update.svg");
  bench.require("measure limb.obj limb.morula --no-protrusion --plot rest.svg");
  bench.require("measure limb.obj spheres --motion bend --no-protrusion --plot motion.svg");
  bench.require(touch + " --crossings --plot touch.svg");
  const auto names = [&](const char* file, std::initializer_list<const char*> words) {
    const std::string svg = bench.read(file);
    EXPECT_EQ(svg.rfind("<svg", 0), 0U) << file;
    EXPECT_EQ(count_of(svg, "</svg>"), 1U) << file;
    EXPECT_EQ(svg.find("nan"), std::string::npos) << file;
    for (const char* word : words) EXPECT_NE(svg.find(word), std::string::npos) << file << " has no " << word;
    EXPECT_EQ(svg.find("level 0"), std::string::npos) << file;
  };
  names("update.svg", {"radii, of those at rest", "looseness, object volumes", "uncovered area, %", "update, µs",
                       "level 1", "level 2", "frame"});
  names("rest.svg", {"looseness, object volumes", "uncovered area, %", ">level<", "1 (8 spheres)"});
  names("motion.svg", {"looseness, object volumes", "uncovered area, %", "level 1", "level 2", ">frame<"});
  names("touch.svg", {"contacts", "deepest, mesh units", "pair tests", "facet pairs", "limb.obj and tool.obj"});
  // Without a time in them they are the same each time.
  for (const char* file : {"motion.svg", "touch.svg"}) {
    const std::string before = bench.read(file);
    bench.require(std::string(file) == "touch.svg"
                      ? touch + " --crossings --plot touch.svg"
                      : "measure limb.obj spheres --motion bend --no-protrusion --plot motion.svg");
    EXPECT_EQ(bench.read(file), before);
  }
}

TEST(Plots, are_refused_before_any_work) {
  const Workbench bench;
  prepare(bench);
  const auto before = bench.listing();
  for (const std::string& command :
       {std::string("measure limb.obj limb.morula"), std::string("update limb.obj limb.morula bend.npy -o s"), touch}) {
    for (const char* plot : {"plot.png", "plot", "no/such/folder/plot.svg"}) {
      const CommandResult result = bench.run(command + " --plot " + plot);
      EXPECT_EQ(result.exit_code, 2) << command << ' ' << plot;
      EXPECT_EQ(result.err.rfind("morula: error: ", 0), 0U) << result.err;
    }
  }
  EXPECT_EQ(bench.listing(), before);
}

// The longest bar belongs to the loosest level below the root, and bars are as long as the figures say.
TEST(Tables, draw_looseness_to_scale) {
  const Workbench bench;
  prepare(bench);
  const auto levels =
      bench.require("measure limb.obj limb.morula --no-protrusion --json").json()["frames"][0]["levels"];
  std::istringstream text(bench.require("measure limb.obj limb.morula --no-protrusion").out);
  std::vector<std::size_t> blocks;
  for (std::string line; std::getline(text, line);)
    if (line.find("yes") != std::string::npos) blocks.push_back(count_of(line, "█"));
  ASSERT_EQ(blocks.size(), 3U);
  EXPECT_EQ(blocks[0], 0U);
  EXPECT_EQ(blocks[1], 24U);
  const double share = levels[2]["looseness"].get<double>() / levels[1]["looseness"].get<double>();
  EXPECT_NEAR(static_cast<double>(blocks[2]), 24 * share, 1);
}

TEST(Tables, draw_looseness_over_the_frames) {
  const Workbench bench;
  prepare(bench);
  const CommandResult result = bench.require("update limb.obj limb.morula bend.npy -o s --rule approach2 --measure");
  const std::size_t worst = result.out.rfind("worst");
  ASSERT_NE(worst, std::string::npos);
  std::size_t drawn = 0;
  for (const char* block : {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"}) drawn += count_of(result.out.substr(worst), block);
  EXPECT_EQ(drawn, 3U * 5U) << result.out;  // a character for each frame of each level
}

}  // namespace
}  // namespace morula::test
