// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What one command writes, the others read.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/accuracy/measure.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <support/zip.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

struct Bench : Workbench {
  Bench() {
    require("sample bar -o bar.obj --resolution 4");
    require("build bar.obj -o bar.morula --method octree --depth 2");
    require("deform bar.obj -o motion --twist 30 --frames 3");
  }
};

TEST(RoundTrip, flat_sets_are_read_wherever_they_make_sense) {
  const Bench bench;
  bench.require("build bar.obj -o set.ply --spheres 20 --method octree");
  const std::vector<Sphere> balls = read_balls(bench / "set.ply");
  ASSERT_FALSE(balls.empty());
  const auto info = bench.require("info set.ply --json").json();
  EXPECT_EQ(info["kind"], "balls");
  EXPECT_EQ(info["balls"], balls.size());
  EXPECT_NE(bench.require("info set.ply").out.find("without a tree"), std::string::npos);

  // As they are, in one level; the set covers, and so says the library of the balls.
  const auto levels = bench.require("measure bar.obj set.ply --json").json()["frames"][0]["levels"];
  ASSERT_EQ(levels.size(), 1u);
  EXPECT_EQ(levels[0]["spheres"], balls.size());
  EXPECT_TRUE(levels[0]["covered"].get<bool>());
  EXPECT_TRUE(coverage(read_mesh(bench / "bar.obj"), balls).covered);

  bench.require("convert set.ply set.json");
  EXPECT_EQ(read_tree(bench / "set.json").tree.leaf_count(), balls.size());
  bench.require("convert set.ply set.morula --mesh bar.obj");
  EXPECT_EQ(bench.require("info set.morula --check --mesh bar.obj").exit_code, 0);
  bench.require("convert set.json leaves.ply");
  EXPECT_EQ(read_balls(bench / "leaves.ply").size(), balls.size());
  const auto contacts =
      bench.require("collide bar.obj bar.obj --tree-a set.ply --tree-b bar.morula --translate-b 0.3,0,0 --json").json();
  EXPECT_FALSE(contacts["frames"][0]["contacts"].empty());
  bench.require("update bar.obj set.ply motion -o moved.npz");
  if (bench.has_page()) bench.require("view bar.obj set.ply -o set.html --no-measure");
}

TEST(RoundTrip, medial_balls_are_measured_as_they_are) {
  const Bench bench;
  bench.require("medial bar.obj -o balls.ply --samples 200");
  const auto level = bench.require("measure bar.obj balls.ply --json --resolution 64").json()["frames"][0]["levels"][0];
  // They fit inside: nothing sticks out, and the surface is bare.
  EXPECT_LT(level["looseness"].get<double>(), 0.02);
  EXPECT_FALSE(level["covered"].get<bool>());
  // A tree that is to cover has to grow, which is said.
  const CommandResult collided = bench.require("collide bar.obj bar.obj --tree-a balls.ply --tree-b bar.morula");
  EXPECT_NE(collided.err.find("note: spheres of balls.ply grew by up to"), std::string::npos) << collided.err;
}

TEST(RoundTrip, spheres_of_an_update_are_measured_with_their_motion) {
  const Bench bench;
  bench.require("update bar.obj bar.morula motion -o spheres.npz");
  bench.require("update bar.obj bar.morula motion -o spheres --format json");
  const auto info = bench.require("info spheres.npz --check --json").json();
  EXPECT_EQ(info["kind"], "spheres of frames");
  EXPECT_EQ(info["frames"], 3);

  const std::string with = " --motion motion --no-protrusion --resolution 32 --json";
  auto archive = bench.require("measure bar.obj spheres.npz" + with).json()["frames"];
  auto folder = bench.require("measure bar.obj spheres" + with).json()["frames"];
  ASSERT_EQ(archive.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(archive[i]["levels"], folder[i]["levels"]) << i;
  bench.expect_refused("measure bar.obj spheres.npz", "give their positions with --motion");

  bench.require("convert spheres.npz one.json --frame 1");
  EXPECT_EQ(read_tree(bench / "one.json").tree.spheres, read_tree(bench / "spheres/0001.json").tree.spheres);
  bench.require("deform bar.obj -o posed --twist 30 --frames 3");
  bench.require("convert spheres.npz one.morula --frame 1 --mesh posed/0001.obj");
  EXPECT_EQ(bench.require("info one.morula --check --mesh posed/0001.obj").exit_code, 0);
  bench.expect_refused("convert spheres.npz x.json", "say which one with --frame N");
  bench.expect_refused("convert spheres.npz x.json --frame 3", "has frames 0 to 2");
  bench.expect_refused("convert bar.morula x.json --frame 0", "--frame belongs to the .npz of an update");
  for (const std::string command :
       {"update bar.obj spheres.npz motion -o x", "collide bar.obj bar.obj --tree-a spheres.npz"})
    bench.expect_refused(command, "holds the spheres of 3 frames, where one tree is needed");
  if (!bench.has_page()) return;
  bench.require("view bar.obj spheres.npz motion -o page.html --no-measure");
  bench.expect_refused("view bar.obj spheres.npz -o x.html", "give the motion that they were updated for");
  bench.expect_refused("view bar.obj spheres.npz motion -o x.html --rule exact", "is shown as it is");
}

TEST(RoundTrip, trees_as_archives_are_trees) {
  const Bench bench;
  bench.require("convert bar.morula bar.npz");
  EXPECT_EQ(tree_hash(read_tree(bench / "bar.npz").tree), tree_hash(read_tree(bench / "bar.morula").tree));
  bench.require("build bar.obj -o built.npz --method octree --depth 2");
  EXPECT_EQ(bench.read("built.npz"), bench.read("bar.npz"));
  EXPECT_EQ(bench.require("info bar.npz --json").json()["kind"], "tree");
  bench.require("measure bar.obj bar.npz --no-protrusion");
  bench.require("convert bar.npz again.morula --mesh bar.obj");
  bench.require("update bar.obj bar.npz motion -o spheres");
}

TEST(RoundTrip, motions_as_archives_are_motions) {
  const Bench bench;
  bench.require("deform bar.obj -o motion.npy --twist 30 --frames 3");
  bench.write("motion.npz", zip({{"positions.npy", bench.read("motion.npy")}}));
  bench.require("update bar.obj bar.morula motion.npz -o a.npz");
  bench.require("update bar.obj bar.morula motion.npy -o b.npz");
  EXPECT_EQ(bench.read("a.npz"), bench.read("b.npz"));
  bench.require("collide bar.obj bar.obj --tree-a bar.morula --tree-b bar.morula --motion-a motion.npz");
  bench.expect_refused("measure bar.obj motion.npz", "holds positions, not spheres; give it with --motion");
  bench.expect_refused("info motion.npz", "positions of frames");
}

TEST(Early, what_can_be_known_is_known_before_any_work) {
  const Bench bench;
  // Minutes of building, if it began.
  bench.require("sample limb -o limb.obj --resolution 96");
  const std::string slow = "build limb.obj --method medial --depth 6 -o ";
  bench.expect_refused("collide limb.obj missing.obj", "missing.obj: there is no such file");
  bench.expect_refused("collide limb.obj bar.obj --tree-b missing.morula", "missing.morula: there is no such file");
  bench.expect_refused("collide limb.obj bar.obj --motion-b missing", "missing: there is no such folder");
  bench.expect_refused("collide limb.obj bar.obj --rotate-b 0,0,0,3", "no direction");
  bench.expect_refused(slow + "missing/x.morula", "there is no folder missing");
  bench.expect_refused(slow + std::string(300, 'x') + ".morula", "the name is too long");
  bench.expect_refused("update bar.obj bar.morula motion -o " + std::string(300, 'x'), "the name is too long");
  if (Workbench::has_shell() &&
      bench.shell("mkdir closed && chmod 500 closed && touch closed/x 2>/dev/null").exit_code != 0) {
    bench.expect_refused(slow + "closed/x.morula", "cannot make a file in this folder");
    bench.expect_refused("update bar.obj bar.morula motion -o closed/x", "cannot make a folder in");
    if (has_extra("study")) bench.expect_refused("study -o closed/x", "closed");
  }
  if (Workbench::has_shell()) bench.shell("chmod 700 closed");
  if (!has_extra("study")) return;
  bench.expect_refused("study --quick --mesh bar.obj,missing.obj -o study", "missing.obj: there is no such file");
  std::filesystem::create_directory(bench / "trees");
  std::filesystem::copy_file(bench / "bar.obj", bench / "trees/bar.obj");
  bench.write("trees/bar-mine.sph", "1 8\n0 0 0 9 1\n");
  bench.write("trees/bar-other.sph", "1 8\n");
  bench.expect_refused("study --quick --mesh bar.obj --trees trees -o study", "bar-other.sph");
  bench.expect_refused("study --quick --mesh missing.obj -o bar.obj", "is a file; name a folder");
}

TEST(Messages, missing_folders_and_fractions_are_named_like_everything_else) {
  const Bench bench;
  bench.expect_refused("update bar.obj bar.morula moton -o x", "moton: there is no such folder");
  bench.expect_refused("update bar.obj bar.morula 'moton/*.obj' -o x", "moton: there is no such folder");
  bench.expect_refused("measure bar.obj sphres --motion motion", "sphres: there is no such file or folder");
  bench.expect_refused("build bar.obj -o x.morula --branching 8.5", "'8.5' is not a whole number from 2 to 64");
  bench.expect_refused("build bar.obj -o x.morula --depth 9", "'9' is not a whole number from 0 to 8");
  bench.expect_refused("build bar.obj -o x.morula --spheres 0", "'0' is not a whole number of 1 or more");
  bench.expect_refused("sample bar -o x.obj --resolution 2", "'2' is not a whole number from 3 to 4096");
}

TEST(Messages, every_command_takes_threads) {
  const Bench bench;
  for (const std::string command : {"build", "measure", "deform", "update", "collide", "view", "medial", "info",
                                    "repair", "robot", "sample", "convert", "demo", "study", "pairs"})
    if (has_command(command)) {
      EXPECT_NE(bench.require(command + " --help").out.find("--threads"), std::string::npos) << command;
    }
  bench.require("deform bar.obj -o a.npy --twist 3 --threads 1");
  bench.require("sample bar -o b.obj --threads 2");
}

TEST(Messages, are_lines_of_json_where_the_result_is) {
  const Bench bench;
  const auto error_of = [&](const std::string& arguments) {
    const CommandResult result = bench.run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    const auto json = nlohmann::json::parse(result.err);
    EXPECT_EQ(json["exit_code"], 2);
    // The same words as without, in which a command line that is repeated has no --json at its end.
    std::string plain = arguments, words = json["error"].get<std::string>();
    plain.erase(plain.find(" --json"), 7);
    if (words.ends_with(" --json")) words.resize(words.size() - 7);
    EXPECT_EQ(bench.run(plain).err, "morula: error: " + words + "\n");
    return json["error"].get<std::string>();
  };
  EXPECT_NE(error_of("info missing.obj --json").find("missing.obj"), std::string::npos);
  EXPECT_NE(error_of("build bar.obj -o x.morula --json --branching 8.5").find("whole number"), std::string::npos);
  EXPECT_NE(error_of("build bar.obj --jsn -o x.morula --json").find("did you mean --json?"), std::string::npos);
  EXPECT_NE(error_of("bild bar.obj --json").find("did you mean build?"), std::string::npos);
  const CommandResult noted = bench.require("convert bar.morula bar.sph --json");
  EXPECT_NE(nlohmann::json::parse(noted.err)["note"].get<std::string>().find("the cover stays behind"),
            std::string::npos);
  EXPECT_EQ(noted.json()["output"], "bar.sph");
}

TEST(Messages, one_sentence_says_which_of_two_limits_ended_a_flat_set) {
  const Bench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  const auto notes = [&](const std::string& options, int code) {
    const CommandResult result = bench.run("build limb.obj -o x.morula --method octree --json " + options);
    EXPECT_EQ(result.exit_code, code) << result.err;
    return result.json()["notes"].dump();
  };
  const std::string length = notes("--spheres 400 --max-protrusion 1.5", 0);
  EXPECT_NE(length.find("the protrusion ended it: with"), std::string::npos) << length;
  EXPECT_NE(length.find("of at most 400 spheres none sticks out by more than 1.5"), std::string::npos) << length;
  const std::string count = notes("--spheres 12 --max-protrusion 0.01", 1);
  EXPECT_NE(count.find("stick out by more than 0.01"), std::string::npos) << count;
  EXPECT_NE(count.find("ended it"), std::string::npos) << count;
  EXPECT_EQ(notes("--spheres 12", 0).find("ended it"), std::string::npos);
}

TEST(Licenses, are_those_of_what_is_compiled_in) {
  const Bench bench;
  const std::string text = bench.require("--licenses").out;
  for (const char* name :
       {"Apache License, version 2.0", "CLI11", "University of Cincinnati", "{fmt}", "Victor Zverovich",
        "Niels Lohmann", "Permission is hereby granted", "Redistributions in binary form"})
    EXPECT_NE(text.find(name), std::string::npos) << name;
  EXPECT_EQ(text.find("three.js authors") != std::string::npos, bench.has_page());
  EXPECT_EQ(text.find("Leon Sorokin") != std::string::npos, bench.has_page());
  EXPECT_NE(bench.require("--help").out.find("--licenses"), std::string::npos);
}

TEST(RepairCommand, says_what_it_did_and_info_names_it) {
  const Bench bench;
  // A cube as six loose squares, one of them turned over and one missing.
  bench.write("loose.obj",
              "v 0 0 0\nv 0 1 0\nv 1 1 0\nv 1 0 0\nf 1 2 3 4\n"
              "v 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 8 7 6 5\n"
              "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 9 10 11 12\n"
              "v 1 0 0\nv 1 1 0\nv 1 1 1\nv 1 0 1\nf 13 14 15 16\n"
              "v 1 1 0\nv 0 1 0\nv 0 1 1\nv 1 1 1\nf 17 18 19 20\n");
  const std::string info = bench.require("info loose.obj").out;
  EXPECT_NE(info.find("morula repair loose.obj -o OUT"), std::string::npos) << info;
  const auto before = bench.require("repair loose.obj -o merged.obj --json").json();
  EXPECT_EQ(before["merged_vertices"], 12);
  EXPECT_EQ(before["turned_facets"], 2);
  EXPECT_EQ(before["open_holes"], 1);
  EXPECT_EQ(before["after"]["boundary_edges"], 4);
  const auto whole = bench.require("repair loose.obj -o whole.obj --cap 4 --json").json();
  EXPECT_EQ(whole["capped_holes"], 1);
  EXPECT_TRUE(whole["after"]["closed"].get<bool>());
  EXPECT_NEAR(whole["after"]["volume"].get<double>(), 1, 1e-12);
  EXPECT_EQ(bench.run("info whole.obj --check").exit_code, 0);
  EXPECT_EQ(bench.require("info whole.obj").out.find("morula repair"), std::string::npos);
  const std::string text = bench.require("repair loose.obj -o again.obj").out;
  for (const char* part : {"12 vertices merged", "2 facets turned over", "1 hole left open; --cap N", "after    open"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
  const std::string nothing = bench.require("repair whole.obj -o same.ply").out;
  EXPECT_NE(nothing.find("nothing to do"), std::string::npos) << nothing;
  bench.expect_refused("repair loose.obj -o loose.obj", "is also what is read");
  bench.expect_refused("repair loose.obj -o x.obj --merge -1", "--merge");
  bench.expect_refused("repair loose.obj -o x.obj --cap 501", "'501' is not a whole number from 0 to 500");
  bench.expect_refused("repair loose.obj -o x.obj --merge 100", "no facet is left");
}

TEST(MeasureCommand, open_meshes_have_a_figure_and_say_how_uncertain_it_is) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 8");
  bench.require("build bar.obj -o bar.morula --method octree --depth 2");
  // Without its first facet.
  std::string text = bench.read("bar.obj");
  const std::size_t face = text.find("\nf ");
  text.erase(face, text.find('\n', face + 1) - face);
  bench.write("open.obj", text);
  const std::string tree = " bar.morula --no-protrusion --resolution 64";
  const auto closed = bench.require("measure bar.obj" + tree + " --json").json()["frames"][0]["levels"];
  const CommandResult result = bench.require("measure open.obj" + tree + " --json");
  const auto open = result.json()["frames"][0]["levels"];
  for (std::size_t j = 0; j < closed.size(); ++j) {
    EXPECT_FALSE(closed[j].contains("inside"));
    EXPECT_EQ(open[j]["inside"], "winding number");
    const double figure = open[j]["looseness"].get<double>();
    EXPECT_NEAR(figure, closed[j]["looseness"].get<double>(), 0.02 * figure);
    EXPECT_LE(open[j]["looseness_low"].get<double>(), figure);
    EXPECT_GE(open[j]["looseness_high"].get<double>(), figure);
  }
  const std::string words = bench.require("measure open.obj" + tree).out;
  EXPECT_NE(words.find("the mesh is open (3 boundary edges): inside is where it winds around a point more than half a"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("level 0 "), std::string::npos) << words;
}

}  // namespace
}  // namespace morula::test
