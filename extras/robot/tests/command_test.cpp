// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// The gripper of the library's own tests, copied: two fingers, one that follows, and a hook that follows it.
Workbench& with_gripper(Workbench& bench) {
  bench.write("gripper.urdf", bench.read(std::string(MORULA_PAGES) +
                                         "/extras/robot/tests/robots/gripper_description/urdf/gripper.urdf"));
  return bench;
}

TEST(RobotCommand, one_line_covers_every_link_and_writes_the_usual_files) {
  Workbench bench;
  with_gripper(bench);
  const nlohmann::json report = bench.require("robot gripper.urdf -o out --json").json();
  EXPECT_EQ(report["covered"], true);
  ASSERT_EQ(report["links"].size(), 4u);
  std::size_t spheres = 0;
  for (const nlohmann::json& link : report["links"]) {
    EXPECT_EQ(link["uncovered_distance"], 0);
    EXPECT_GE(link["union_volume"], link["object_volume"].get<double>() * 0.99);
    spheres += link["spheres"].get<std::size_t>();
  }
  EXPECT_EQ(report["spheres"], spheres);
  EXPECT_LE(spheres, 4 * 16u);
  for (const nlohmann::json& file : report["files"])
    EXPECT_FALSE(bench.read("out/" + file.get<std::string>()).empty()) << file;
  EXPECT_EQ(report["files"], nlohmann::json({"spheres.json", "spheres.csv", "links.csv", "curobo.yml",
                                             "gripper_spherized.urdf", "gripper.srdf"}));
  const std::string text = bench.require("robot gripper.urdf -o out").out;
  for (const char* words :
       {"0, proven", "covers   yes", "proven apart", "0 apart in 100000 samples\n", "--tool LINK says otherwise"}) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  }
}

TEST(RobotCommand, formats_by_name_and_all_of_them) {
  Workbench bench;
  with_gripper(bench);
  EXPECT_EQ(bench.require("robot gripper.urdf -o one --spheres 2 --format sdf --format mjcf --json").json()["files"],
            nlohmann::json({"gripper.mjcf.xml", "gripper.sdf"}));
  EXPECT_EQ(bench.require("robot gripper.urdf -o all --spheres 2 --all-formats --json").json()["files"].size(), 21u);
  bench.require("robot gripper.urdf -o trees --spheres 8 --format csv --trees");
  const std::string info = bench.require("info trees/trees/palm.morula --mesh trees/trees/palm.ply --check").out;
  EXPECT_FALSE(info.empty());
}

// The page shows the command that certifies edited spheres, as a shell reads it back.
TEST(RobotCommand, page_quotes_the_name_of_the_robots_file_for_a_shell) {
  Workbench bench;
  if (!bench.has_page()) GTEST_SKIP() << "no page in this build";
  with_gripper(bench);
  std::filesystem::rename(bench / "gripper.urdf", bench / "my gripper.urdf");
#ifdef _WIN32
  const std::string typed = "\\\"my gripper.urdf\\\"";  // as text of JSON
#else
  const std::string typed = "'my gripper.urdf'";
#endif
  bench.require("robot " + (typed.front() == '\'' ? typed : "\"my gripper.urdf\"") +
                " -o out --spheres 2 --format csv --page");
  const std::string page = bench.read("out/robot.html");
  EXPECT_NE(page.find("morula robot " + typed + " -o edited --keep"), std::string::npos);
}

TEST(RobotCommand, inner_spheres_have_files_of_their_own) {
  Workbench bench;
  with_gripper(bench);
  const nlohmann::json report =
      bench.require("robot gripper.urdf -o out --spheres 2 --inner 4 --all-formats --json").json();
  EXPECT_GT(report["inner_spheres"], 4);
  EXPECT_GT(report["links"][0]["inner_volume"], 0);
  // All but spheres.json, which has both, and the figures of those that cover.
  EXPECT_EQ(report["files"].size(), 2 * 21u - 2);
  EXPECT_NE(bench.read("out/inner/curobo.yml").find("they are inside the links and do not cover them"),
            std::string::npos);
  EXPECT_EQ(bench.read("out/curobo.yml").find("do not cover"), std::string::npos);
  const std::string text = bench.require("robot gripper.urdf -o out --spheres 2 --inner 4").out;
  EXPECT_NE(text.find("each proven to be inside its link, fill"), std::string::npos) << text;
}

/// A post with a core inside, a bar that turns above it, and a block in the bar's way, all on the same ground.
TEST(RobotCommand, false_self_collisions_are_told_by_pair) {
  Workbench bench;
  std::string urdf = R"(<robot name="turnstile">)";
  const auto add = [&](const std::string& name, const std::string& center, const std::string& size) {
    urdf += "<link name=\"" + name + "\"><collision><origin xyz=\"" + center + "\"/><geometry><box size=\"" + size +
            "\"/></geometry></collision></link>";
    if (name == "ground") return;
    urdf += "<joint name=\"to_" + name + "\" type=\"" + (name == "bar" || name == "core" ? "revolute" : "fixed") +
            "\"><parent link=\"ground\"/><child link=\"" + name +
            "\"/><axis xyz=\"0 0 1\"/><limit lower=\"-3.14\" upper=\"3.14\"/></joint>";
  };
  add("ground", "0 0 -5", "0.2 0.2 0.2");
  add("post", "0 0 -0.5", "1 1 1");
  add("core", "0 0 -0.5", "0.4 0.4 0.4");
  add("bar", "0.5 0 0.3", "2 0.2 0.2");
  add("block", "-1.2 0 0.3", "0.2 0.2 0.2");
  bench.write("turnstile.urdf", urdf + "</robot>");
  const std::string line = "robot turnstile.urdf -o out --self-collision --max-total 8 --format csv --samples 0";
  const nlohmann::json rates = bench.require(line + " --json").json()["false_collisions"];
  const auto pair_of = [&](const nlohmann::json& list, const char* a, const char* b) -> nlohmann::json {
    for (const nlohmann::json& pair : list)
      if (pair["links"] == nlohmann::json({a, b})) return pair;
    return {};
  };
  const nlohmann::json inside = pair_of(rates["pairs"], "post", "core"), bar = pair_of(rates["pairs"], "post", "bar"),
                       block = pair_of(rates["pairs"], "bar", "block");
  ASSERT_TRUE(inside.is_object() && bar.is_object() && block.is_object()) << rates.dump(1);
  EXPECT_EQ(inside["always_collide"], true);
  EXPECT_EQ(inside["surfaces"], 1.0);
  EXPECT_EQ(bar["always_collide"], false);
  EXPECT_EQ(bar["surfaces"], 0.0);
  EXPECT_GT(bar["false_share"], 0.0);
  EXPECT_EQ(block["always_collide"], false);
  EXPECT_GT(block["surfaces"], 0.0);
  EXPECT_EQ(rates["surfaces"], block["surfaces"]);
  EXPECT_LE(rates["false_share"], rates["evenly"]["false_share"]);
  EXPECT_GT(rates["steps"].back()["spheres"], 8);
  const std::string text = bench.require(line).out;
  for (const char* words : {"post-core: always collide", "post-bar: ", "placed by volume", " spheres would leave "})
    EXPECT_NE(text.find(words), std::string::npos) << text;
}

TEST(RobotCommand, clip_planes_are_told_and_nonsense_is_refused) {
  Workbench bench;
  with_gripper(bench);
  const std::string text = bench.require("robot gripper.urdf -o out --spheres 4 --clip palm=0,0,2,0").out;
  EXPECT_NE(text.find("what clip planes cut off is left out"), std::string::npos) << text;
  EXPECT_NE(text.find("clipped  palm: spheres reach at most"), std::string::npos) << text;
  const nlohmann::json report =
      bench.require("robot gripper.urdf -o out --spheres 4 --clip palm=0,0,1,0 --clip-margin 0.005 --json").json();
  EXPECT_EQ(report["links"][0]["beyond_clip"], 0);
  EXPECT_TRUE(report["covered"]);
  bench.expect_refused("robot gripper.urdf -o out --clip palm=0,0,1,0 --clip-margin 0.005 --padding 0.01",
                       "clip margin 0.005 is too small for link palm");
  bench.expect_refused("robot gripper.urdf -o out --clip palm=0,0,1", "as --clip base=0,0,1,0.02");
  bench.expect_refused("robot gripper.urdf -o out --clip palm=0,0,0,1", "as --clip base=0,0,1,0.02");
  bench.expect_refused("robot gripper.urdf -o out --clip palm=0,0,1,nan", "as --clip base=0,0,1,0.02");
  bench.expect_refused("robot gripper.urdf -o out --clip plam=0,0,1,0", "did you mean palm?");
  bench.expect_refused("robot gripper.urdf -o out --clip grasp=0,0,1,0", "link grasp has no collision shapes");
  bench.expect_refused("robot gripper.urdf -o out --clip-margin 0.01", "add it");
}

TEST(RobotCommand, mjcf_and_sdf_are_read_and_one_tree_holds_the_robot) {
  Workbench bench;
  for (const std::string name : {"mjcf/gripper.xml", "sdf/gripper.sdf"}) {
    const std::string file = "gripper" + name.substr(name.find('.'));
    bench.write(file, bench.read(std::string(MORULA_PAGES) + "/extras/robot/tests/robots/gripper_description/" + name));
    const nlohmann::json report =
        bench.require("robot " + file + " -o out --spheres 4 --all-formats --tree robot --json").json();
    EXPECT_EQ(report["covered"], true);
    EXPECT_EQ(report["files"].size(), 23u) << "the URDF that cuRobo's files need is there once";
    EXPECT_NE(bench.read("out/curobo.yml").find("gripper_spherized.urdf"), std::string::npos);
    EXPECT_FALSE(bench.require("info out/robot.morula --mesh out/robot.ply --check").out.empty());
    // What was written is a robot again.
    for (const std::string written : {"gripper_spherized.urdf", "gripper.mjcf.xml", "gripper.sdf"}) {
      EXPECT_EQ(
          bench.require("robot out/" + written + " -o again --spheres 4 --format csv --json").json()["links"].size(),
          4u);
    }
  }
  bench.expect_refused("robot gripper.sdf -o out --tree robt", "did you mean robot?");
}

TEST(RobotCommand, same_files_for_any_number_of_threads_and_one_link_refitted_alone) {
  Workbench bench;
  with_gripper(bench);
  bench.require("robot gripper.urdf -o one --total 30 --threads 1");
  bench.require("robot gripper.urdf -o three --max-total 30 --threads 3");
  EXPECT_EQ(bench.read("one/spheres.json"), bench.read("three/spheres.json"));
  bench.require("robot gripper.urdf -o two --keep one/spheres.json --refit palm --spheres 5");
  const auto spheres = [&](const std::string& folder) {
    std::map<std::string, nlohmann::json> links;
    const nlohmann::json file = nlohmann::json::parse(bench.read(folder + "/spheres.json"));
    for (const nlohmann::json& link : file["links"]) links[link["link"]] = link["spheres"];
    return links;
  };
  auto before = spheres("one"), after = spheres("two");
  EXPECT_NE(before["palm"], after["palm"]);
  before.erase("palm");
  after.erase("palm");
  EXPECT_EQ(before, after);
  // Without --refit all are kept, and judged again.
  bench.require("robot gripper.urdf -o kept --keep one/spheres.json");
  EXPECT_EQ(spheres("kept"), spheres("one"));
  nlohmann::json less = nlohmann::json::parse(bench.read("one/spheres.json"));
  for (nlohmann::json& sphere : less["links"][0]["spheres"]) sphere["radius"] = 0.001;
  bench.write("less.json", less.dump());
  EXPECT_EQ(bench.run("robot gripper.urdf -o less --keep less.json").exit_code, 1);
}

TEST(RobotCommand, covers_within_a_tolerance_and_a_table_shows_what_that_saves) {
  Workbench bench;
  with_gripper(bench);
  const std::string robot = "robot gripper.urdf -o out --spheres 5 --samples 100 ";
  const nlohmann::json report = bench.require(robot + "--tolerances 0,0.002,0.005 0.01 --json").json();
  EXPECT_EQ(report["covered"], true) << "the files have no tolerance";
  EXPECT_EQ(report["within"], 0);
  ASSERT_EQ(report["tolerances"].size(), 4u);
  const std::vector<double> tolerances{0, 0.002, 0.005, 0.01};
  for (std::size_t k = 0; k < 4; ++k) {
    const nlohmann::json& row = report["tolerances"][k];
    EXPECT_EQ(row["tolerance"], tolerances[k]);
    EXPECT_LE(row["within"], row["tolerance"]);
    EXPECT_EQ(row["within"] > 0, k > 0);
    EXPECT_LE(row["spheres"], 4 * 5u);
    if (k == 0) continue;
    EXPECT_LT(row["outside_volume"], report["tolerances"][k - 1]["outside_volume"]);
  }
  // A row is what a run with this tolerance has.
  const nlohmann::json one = bench.require(robot + "--tolerance 0.005 --json").json();
  EXPECT_EQ(one["covered"], false);
  EXPECT_EQ(one["within"], report["tolerances"][2]["within"]);
  EXPECT_EQ(one["spheres"], report["tolerances"][2]["spheres"]);
  EXPECT_TRUE(one["tolerances"].empty());
  double outside = 0, within = 0;
  for (const nlohmann::json& link : one["links"]) {
    EXPECT_LE(link["uncovered_distance"], link["within"]);
    outside += link["outside_volume"].get<double>();
    within = std::max(within, link["within"].get<double>());
  }
  EXPECT_EQ(within, one["within"]);
  EXPECT_NEAR(outside, report["tolerances"][2]["outside_volume"].get<double>(), 1e-12 * outside);
  EXPECT_EQ(nlohmann::json::parse(bench.read("out/spheres.json"))["links"].size(), 4u);
  const std::string text = bench.require(robot + "--tolerance 0.005 --tolerances 0,0.01").out;
  for (const char* words : {"covers   within 0.00500: every point of every link",
                            "tolerance  proven within  spheres  outside volume", "\n0.0100 "})
    EXPECT_NE(text.find(words), std::string::npos) << text;
  // A tolerance beyond the robot, and a total that links share.
  EXPECT_LE(bench.require("robot gripper.urdf -o out --samples 10 --tolerance 10 --json").json()["within"], 10);
  const nlohmann::json shared =
      bench.require("robot gripper.urdf -o out --samples 10 --total 14 --tolerance 0.004 --json").json();
  EXPECT_LE(shared["spheres"], 14);
  EXPECT_LE(shared["within"], 0.004);
}

TEST(RobotCommand, leaves_a_share_uncovered_and_says_so) {
  Workbench bench;
  with_gripper(bench);
  const std::string robot = "robot gripper.urdf -o out --spheres 5 --samples 100 ", share = "--max-uncovered 0.3 ";
  const nlohmann::json covering = bench.require(robot + "--json").json();
  const nlohmann::json report =
      bench.require(robot + "--tolerance 0.01 --tolerances 0,0.01 " + share + "--json").json();
  EXPECT_EQ(report["covered"], false);
  EXPECT_GT(report["uncovered_share"], 0);
  EXPECT_LE(report["uncovered_share"], 0.3);
  EXPECT_LE(report["within"], 0.01);
  const auto outside = [](const nlohmann::json& of) {
    double sum = 0;
    for (const nlohmann::json& link : of["links"]) sum += link["outside_volume"].get<double>();
    return sum;
  };
  EXPECT_LT(outside(report), outside(covering));
  // The row without a tolerance covers; the other one is the result.
  ASSERT_EQ(report["tolerances"].size(), 2u);
  EXPECT_EQ(report["tolerances"][0]["uncovered_share"], 0);
  EXPECT_EQ(report["tolerances"][1]["uncovered_share"], report["uncovered_share"]);
  EXPECT_EQ(nlohmann::json::parse(bench.read("out/spheres.json"))["uncovered_share"], report["uncovered_share"]);
  const std::string text = bench.require(robot + "--tolerance 0.01 " + share).out;
  EXPECT_NE(text.find(" % of the surface is in no sphere"), std::string::npos) << text;
  for (const char* options : {"", "--tolerance 0.01 --max-protrusion 0.01", "--tolerance 0.01 --self-collision"})
    bench.expect_refused(robot + share + options, "--max-uncovered belongs to --tolerance");
  for (const char* bad : {"0", "-0.1", "1.1", "nan"})
    bench.expect_refused(robot + "--tolerance 0.01 --max-uncovered " + bad, "uncovered");
}

TEST(RobotCommand, refuses_tolerances_that_are_none) {
  Workbench bench;
  with_gripper(bench);
  for (const char* option : {"--tolerance", "--tolerances"})
    for (const char* length : {"-1", "nan", "inf", "1e31", "x"})
      bench.expect_refused(std::string("robot gripper.urdf -o out ") + option + " " + length, option);
  bench.expect_refused("robot gripper.urdf -o out --tolerances 0.001,-1", "--tolerances");
  bench.expect_refused("robot gripper.urdf -o out --tolerance 0.01 --method grid", "use optimized");
  bench.expect_refused("robot gripper.urdf -o out --tolerances 0,0.01 --method octree", "use optimized");
}

TEST(RobotCommand, bad_use_is_one_line_with_a_remedy_and_nothing_is_written) {
  Workbench bench;
  with_gripper(bench);
  bench.write("lost.urdf",
              "<robot name='r'>\n<link name='l'><collision><geometry><mesh "
              "filename='package://p/m.stl'/></geometry></collision></link></robot>");
  bench.write("bare.urdf", "<robot name='r'><link name='l'/></robot>");
  bench.expect_refused("robot none.urdf -o out", "none.urdf: there is no such file");
  bench.expect_refused("robot lost.urdf -o out", "lost.urdf:2: mesh \"package://p/m.stl\" is missing; searched:");
  bench.expect_refused("robot bare.urdf -o out", "no link has collision shapes, and none has visual shapes");
  bench.write(
      "seen.urdf",
      "<robot name='r'><link name='l'><visual><geometry><sphere radius='1'/></geometry></visual></link></robot>");
  bench.expect_refused("robot seen.urdf -o out", "no link has collision shapes; try --geometry visual");
  bench.write(
      "nothing.urdf",
      "<robot name='r'><link name='l'><collision><geometry><sphere radius='0'/></geometry></collision></link></robot>");
  bench.expect_refused("robot nothing.urdf -o out",
                       "no link has collision shapes (a sphere of size 0 in l (line 1) is left out");
  bench.expect_refused("robot gripper.urdf -o out --format curoba", "did you mean curobo?");
  bench.expect_refused("robot gripper.urdf -o out --format xrdf", "did you mean xrdf-1?");
  bench.expect_refused("robot gripper.urdf -o out --keep gripper.urdf",
                       "gripper.urdf: is not JSON; give a spheres.json that morula robot wrote");
  bench.write("other.json", "{\"format\": \"morula robot spheres\", \"format_version\": 1}");
  bench.expect_refused("robot gripper.urdf -o out --keep other.json", "other.json: lacks a part of such a file");
  bench.write("other.json", "{\"format\": \"x\"}");
  bench.expect_refused("robot gripper.urdf -o out --keep other.json", "other.json: has another format");
  bench.expect_refused("robot gripper.urdf -o out --link plam=3", "did you mean palm?");
  bench.expect_refused("robot gripper.urdf -o out --link palm", "give a link and how many spheres");
  bench.expect_refused("robot gripper.urdf -o out --skip lfet", "did you mean left?");
  bench.expect_refused("robot gripper.urdf -o out --spheres 3 --max-total 30", "contradict each other");
  bench.expect_refused("robot gripper.urdf -o out --max-protrusion 0%", "a share of each link's size");
  bench.expect_refused("robot gripper.urdf -o out --refit palm", "--refit belongs to --keep DIR/spheres.json: add it");
  bench.expect_refused("robot gripper.urdf -o out --geometry both", "collision");
  bench.expect_refused("robot gripper.urdf -o out --package-path nowhere", "there is no such folder");
  bench.expect_refused("robot gripper.urdf -o gripper.urdf", "is a file; name a folder");
  bench.expect_refused("robot gripper.urdf -o out --srdf lost.srdf", "lost.srdf");
  for (const char* value : {"nan", "inf", "-1", "0x10", "1%%", "%"}) {
    bench.expect_refused(std::string("robot gripper.urdf -o out --max-protrusion=") + value, "--max-protrusion");
  }
}

TEST(RobotCommand, files_of_an_earlier_run_that_stay_are_named) {
  Workbench bench;
  with_gripper(bench);
  const auto left = [&](const std::string& arguments) -> std::string {
    const nlohmann::json report = bench.require("robot gripper.urdf -o out --spheres 2 --json " + arguments).json();
    for (const auto& note : report["notes"]) {
      const auto text = note.get<std::string>();
      if (text.find("of an earlier run") != std::string::npos) return text;
    }
    return "";
  };
  EXPECT_EQ(left("--format csv --format xrdf-1 --tree robot"), "");
  bench.write("out/robot.html", "old");
  EXPECT_EQ(left("--format csv"),
            "out: of an earlier run, and not written again: robot.html robot.morula robot.ply gripper.1.0.xrdf");
  EXPECT_EQ(bench.read("out/robot.html"), "old");
}

TEST(RobotCommand, xacro_is_expanded_by_the_program_without_a_shell) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell << ", whose scripts stand for the program here";
  Workbench bench;
  with_gripper(bench);
  // A stand-in: it writes down its arguments and prints the gripper.
  bench.write("fake xacro",
              "#!/bin/sh\n[ \"$1\" = --deps ] && exit\n"
              "printf '%s\\n' \"$@\" > \"${0%/*}/said\"\ncat \"${0%/*}/gripper.urdf\"\n");
  bench.write("fails", "#!/bin/sh\necho 'name x is not defined' >&2\necho 'when processing it' >&2\nexit 2\n");
  bench.write("silent", "#!/bin/sh\nexit 0\n");
  bench.write("loud",
              "#!/bin/sh\ni=0\nwhile [ $i -lt 20000 ]; do echo 'warning: a long line of words' >&2; "
              "i=$((i+1)); done\ncat \"${0%/*}/gripper.urdf\"\n");
  for (const char* name : {"fake xacro", "fails", "silent", "loud"})
    std::filesystem::permissions(bench / name, std::filesystem::perms::owner_all);
  bench.write("g.urdf.xacro",
              "<robot name='g' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<xacro:gripper/>\n</robot>");
  bench.require("robot g.urdf.xacro -o out --spheres 2 --xacro './fake xacro' --xacro-arg 'p:=a b;$(touch bad)'");
  EXPECT_EQ(bench.read("said"), (bench / "g.urdf.xacro").string() + "\np:=a b;$(touch bad)\n");
  EXPECT_FALSE(std::filesystem::exists(bench / "bad"));
  bench.require("robot gripper.urdf -o plain --spheres 2 --xacro ./fails");
  EXPECT_EQ(bench.read("out/spheres.csv"), bench.read("plain/spheres.csv"));
  EXPECT_EQ(bench.read("out/gripper_spherized.urdf"), bench.read("plain/gripper_spherized.urdf"));
  EXPECT_NE(bench.read("out/curobo.yml").find("out/gripper_spherized.urdf"), std::string::npos)
      << "planners cannot read xacro";
  bench.require("robot g.urdf.xacro -o many --spheres 2 --format csv --xacro ./loud");
  bench.expect_refused("robot g.urdf.xacro -o no --xacro ./fails",
                       "g.urdf.xacro:2: ./fails fails: name x is not defined when processing it");
  bench.expect_refused("robot g.urdf.xacro -o no --xacro ./silent", "g.urdf.xacro");
  bench.expect_refused("robot g.urdf.xacro -o no --xacro no-such-program",
                       "g.urdf.xacro:2: has macros, and the program no-such-program that expands them cannot be run");
  bench.expect_refused("robot g.urdf.xacro -o no --xacro-arg p=3", "give NAME:=VALUE");
  // Expressions alone need it too; a declaration alone does not.
  bench.write("e.xacro",
              "<robot name='e'><link name='l'><collision><geometry><sphere radius='${r}'/></geometry>"
              "</collision></link></robot>");
  bench.require("robot e.xacro -o e --spheres 2 --format csv --xacro './fake xacro'");
  bench.write("d.urdf",
              "<robot name='d' xmlns:xacro='x'><link name='l'><collision><geometry><sphere radius='1'/>"
              "</geometry></collision></link></robot>");
  bench.require("robot d.urdf -o d --format csv --xacro ./fails");
  // Files that the xacro file reads stay, and those that its arguments name.
  bench.write("lists", "#!/bin/sh\nif [ \"$1\" = --deps ]; then echo \"" + (bench / "parts.xacro").string() + " " +
                           (bench / "out/spheres.csv").string() + "\"; else cat \"${0%/*}/gripper.urdf\"; fi\n");
  bench.write("keeps", "#!/bin/sh\n[ \"$1\" = --deps ] || cat \"${0%/*}/gripper.urdf\"\n");
  for (const char* name : {"lists", "keeps"})
    std::filesystem::permissions(bench / name, std::filesystem::perms::owner_all);
  bench.expect_refused("robot g.urdf.xacro -o out --spheres 2 --xacro ./lists", "is also what is read");
  bench.expect_refused("robot g.urdf.xacro -o out --spheres 2 --xacro ./keeps --xacro-arg p:=out/spheres.csv",
                       "is also what is read");
  bench.require("robot g.urdf.xacro -o out --spheres 2 --xacro ./keeps");
}

TEST(RobotCommand, never_replaces_what_it_reads) {
  Workbench bench;
  with_gripper(bench);
  bench.require("robot gripper.urdf -o out --spheres 2");
  bench.expect_refused("robot out/gripper_spherized.urdf -o out", "is also what is read");
  bench.expect_refused("robot gripper.urdf -o out --keep out/spheres.json --refit palm", "is also what is read");
  bench.expect_refused("robot gripper.urdf -o out --srdf out/gripper.srdf", "is also what is read");
  bench.require("robot gripper.urdf -o other --spheres 2 --srdf out/gripper.srdf");
}

}  // namespace
}  // namespace morula::test
