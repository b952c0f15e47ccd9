// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/version.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// Those of the library, then those of the extras that the command was built with.
std::vector<std::string> commands_of_this_build() {
  std::vector<std::string> all{"build", "measure", "deform",   "update",  "collide", "pairs",   "medial",
                               "info",  "repair",  "paraview", "formats", "sample",  "convert", "batch"};
  if (has_extra("grains")) all.push_back("clump");
  if (has_extra("page")) all.push_back("view");
  if (has_extra("robot")) all.push_back("robot");
  if (has_extra("study")) all.insert(all.end(), {"demo", "study"});
  all.push_back("completion");
  return all;
}
const std::vector<std::string> all_commands = commands_of_this_build();

TEST(Help, lists_the_commands_that_exist_and_no_others) {
  const Workbench bench;
  const std::string help = bench.require("--help").out;
  const std::size_t list = help.find("Subcommands:");
  ASSERT_NE(list, std::string::npos) << help;
  std::istringstream lines(help.substr(list));
  std::vector<std::string> listed;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.rfind("  ", 0) == 0) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (line[2] != ' ') listed.push_back(word);
  }
  EXPECT_EQ(listed, all_commands);
}

TEST(Help, every_command_explains_itself_with_an_example) {
  const Workbench bench;
  for (const std::string& command : all_commands) {
    const std::string help = bench.require(command + " --help").out;
    EXPECT_NE(help.find("Example:"), std::string::npos) << help;
    EXPECT_NE(help.find("  morula " + command + " "), std::string::npos) << help;
  }
}

TEST(Help, commands_that_take_a_motion_name_every_form_of_one) {
  const Workbench bench;
  for (const std::string command : {"update", "view", "measure", "collide", "paraview"}) {
    if (!has_command(command)) continue;
    std::string help = bench.require(command + " --help").out;
    help.erase(std::unique(help.begin(), help.end(), [](char a, char b) { return a == ' ' && b == ' '; }), help.end());
    for (const std::string form : {"folder of meshes", "glob", ".npy", ".npz", ".pc2", ".mdd"})
      EXPECT_NE(help.find(form), std::string::npos) << command << " does not name " << form << ": " << help;
    for (const auto& format : bench.require("formats --json").json()["formats"]) {
      if (format["for"] == "motions" && format["read"]) {
        EXPECT_NE(help.find(format["extension"].get<std::string>()), std::string::npos) << command << ": " << help;
      }
    }
  }
}

TEST(Help, says_the_version_of_the_library) {
  const Workbench bench;
  EXPECT_EQ(bench.require("--version").out, std::string("morula ") + version + "\n");
}

TEST(BadUse, without_a_command_shows_the_help_and_fails) {
  const Workbench bench;
  const CommandResult result = bench.run("");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.out.find("Subcommands:"), std::string::npos);
  EXPECT_EQ(result.err, "morula: error: no command; see morula --help\n");
}

TEST(BadUse, names_what_is_known_and_what_was_nearly_right) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  bench.expect_refused("biuld bar.obj -o x.morula", "did you mean build?");
  bench.expect_refused("--threads 2 biuld bar.obj -o x.morula", "unknown command 'biuld'");
  const CommandResult as_json = bench.run("--json biuld bar.obj -o x.morula");
  EXPECT_EQ(as_json.exit_code, 2);
  const auto said = nlohmann::json::parse(as_json.err);
  EXPECT_EQ("morula: error: " + said["error"].get<std::string>() + "\n", bench.run("biuld bar.obj -o x.morula").err);
  EXPECT_EQ(bench.run("--version biuld").exit_code, 0);
  bench.expect_refused("build bar.obj -o x.morula --methd grid", "did you mean --method?");
  bench.expect_refused("build bar.obj -o x.morula --method gird",
                       "known: octree, grid, hubbard, spawn, medial, combined, optimized; did you mean grid?");
  bench.expect_refused("build bar.obj -o x.morula --method xyzzy", "unknown method 'xyzzy'; known: octree, grid");
  bench.expect_refused("sample lim -o x.obj", "did you mean limb?");
  bench.expect_refused("sample lim-modes -o x.npy", "did you mean limb?");
  bench.expect_refused("sample limb-mode -o x.npy", "known: modes, coords, weights, bones; did you mean modes?");
  bench.expect_refused("sample limb --modes 3 -o x.obj", "a mesh has none; did you mean limb-modes?");
  bench.expect_refused("sample limb-modes --frames 3 -o x.npy", "--frames: limb-modes has none");
  bench.expect_refused("update bar.obj bar.morula bar.obj -o s --rule aproach2", "did you mean approach2?");
  bench.expect_refused("measure bar.obj bar.morula --grid levels", "known: level, fixed; did you mean level?");
  bench.expect_refused("deform bar.obj -o m --bend 90 --axis w", "unknown axis 'w'; known: x, y, z, auto");
}

TEST(BadUse, options_before_the_command_are_named_with_their_place) {
  const Workbench bench;
  for (const std::string option : {"--json", "--threads=2"}) {
    const CommandResult result = bench.run(option + " sample bar -o bar.obj");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.err.find("'?'"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(option), std::string::npos) << result.err;
  }
  const std::string error = bench.run("--json info bar.obj").err;
  EXPECT_NE(error.find("'--json' comes after the command: morula info … --json"), std::string::npos) << error;
  bench.expect_refused("--jsn info bar.obj", "unknown option '--jsn', did you mean --json?");
}

TEST(BadUse, missing_and_surplus_arguments_are_named) {
  const Workbench bench;
  bench.expect_refused("build", "MESH is required; see morula build --help");
  bench.expect_refused("build bar.obj", "--output is required");
  bench.expect_refused("sample bar -o x.obj y.obj", "unexpected argument 'y.obj'");
  bench.expect_refused("sample bar -o x.obj --resolution many", "--resolution");
  bench.expect_refused("sample bar -o x.obj --resolution 2", "resolution");
}

TEST(BadUse, outputs_that_cannot_be_are_refused_before_any_work) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.expect_refused("sample bar -o bar.msh", "meshes are written as .obj, .off, .ply, .stl or .vtp");
  bench.expect_refused("sample bar-modes -o bar.obj", "bar.obj: arrays are written as .npy");
  bench.expect_refused("sample bar -o nowhere/bar.obj", "there is no folder nowhere");
  bench.expect_refused("build bar.obj -o bar.tree", "trees are written as .morula");
  bench.expect_refused("build missing.obj -o nowhere/bar.morula", "there is no folder nowhere");
  bench.expect_refused("deform bar.obj -o motion.obj --bend 90", "folder of meshes or a .npy file");
  bench.expect_refused("measure bar.obj bar.obj --csv nowhere/x.csv", "there is no folder nowhere");
}

TEST(BadInput, broken_files_are_named_and_nothing_is_written) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.write("empty.obj", "");
  bench.write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  bench.write("nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n");
  bench.write("lying.morula", "this is no tree");
  bench.write("short.sph", "2 8\n0 0 0 1 0\n");
  bench.expect_refused("build missing.obj -o x.morula", "missing.obj");
  bench.expect_refused("build empty.obj -o x.morula", "empty.obj");
  bench.expect_refused("build broken.obj -o x.morula", "broken.obj");
  bench.expect_refused("build nan.obj -o x.morula", "nan.obj");
  bench.expect_refused("build bar.xyz -o x.morula", "bar.xyz");
  bench.expect_refused("measure bar.obj lying.morula", "lying.morula");
  bench.expect_refused("measure bar.obj short.sph --csv x.csv", "short.sph");
  bench.expect_refused("info bar.xyz", "neither a mesh");
  bench.expect_refused("convert lying.morula x.sph", "lying.morula");
  bench.expect_refused("deform broken.obj -o motion --twist 90", "broken.obj");
}

}  // namespace
}  // namespace morula::test
