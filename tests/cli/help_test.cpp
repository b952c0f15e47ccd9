// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/version.hpp>
#include <regex>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// Those of the library, then those of the extras that the command was built with.
std::vector<std::string> commands_of_this_build() {
  std::vector<std::string> all{"build", "measure", "deform",   "update",  "collide", "pairs",   "medial", "bounds",
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

/// The lines of commands in what was printed, as a shell takes them.
std::vector<std::string> commands_in(const std::string& text) {
  std::vector<std::string> commands;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("  morula ", 0) == 0) commands.push_back(line.substr(8));
  return commands;
}

/// The three commands that this command line prints work when they are pasted, in their order.
void expect_commands_that_work(const Workbench& bench, const std::string& arguments, const std::string& error) {
  const auto before = bench.listing();
  const CommandResult result = bench.run(arguments);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.err, "morula: error: " + error + "\n");
  EXPECT_EQ(bench.listing(), before);
  const std::vector<std::string> commands = commands_in(result.out);
  EXPECT_EQ(commands.size(), 3u) << result.out;
  for (const std::string& command : commands) {
    const CommandResult pasted = bench.run(command);
    const bool no_page = !bench.has_page() && command.find(" view ") != std::string::npos;
    EXPECT_EQ(pasted.exit_code, no_page ? 2 : 0) << command << "\n" << pasted.err;
  }
}

TEST(NextSteps, without_a_command_are_three_that_work) {
  const Workbench bench;
  expect_commands_that_work(bench, "", "no command; see morula --help");
}

TEST(NextSteps, of_a_mesh_build_and_show_it_whatever_its_name) {
  const Workbench bench;
  for (const std::string name : {"bar.obj", "my bar's $HOME (1).obj", "folder/Größe.off"}) {
    std::filesystem::create_directory(bench / "folder");
    const std::string quoted = "\"" + std::regex_replace(name, std::regex("\\$"), "\\$$") + "\"";
    bench.require("sample bar -o " + quoted + " --resolution 4");
    const std::string error = bench.run(quoted).err;
    EXPECT_EQ(error.rfind("morula: error: '" + name + "' is a mesh, not a command; try morula build ", 0), 0u) << error;
    expect_commands_that_work(bench, quoted, error.substr(15, error.size() - 16));
    const std::string tree = std::filesystem::path(name).replace_extension(".morula").string();
    EXPECT_TRUE(std::filesystem::exists(bench / tree)) << tree;
  }
}

TEST(NextSteps, of_a_tree_name_the_mesh_beside_it) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  const std::string first = has_command("view") ? "view bar.obj bar.morula -o bar.html" : "measure bar.obj bar.morula";
  expect_commands_that_work(bench, "bar.morula", "'bar.morula' is a tree, not a command; try morula " + first);
  std::filesystem::rename(bench / "bar.obj", bench / "other.obj");
  EXPECT_NE(bench.run("bar.morula").out.find("morula measure MESH bar.morula "), std::string::npos);
}

TEST(NextSteps, of_other_files_and_folders_name_a_command_that_takes_them) {
  const Workbench bench;
  std::filesystem::create_directory(bench / "meshes");
  bench.require("sample bar -o meshes/bar.obj --resolution 4");
  bench.require("medial meshes/bar.obj -o balls.ply");
  bench.require("sample limb-coords -o coords.npy");
  bench.write("picture.png", "");
  bench.write("arm.urdf", "<robot/>");
  EXPECT_NE(bench.run("meshes").err.find("is a folder, not a command; try morula batch meshes -o trees"),
            std::string::npos);
  EXPECT_NE(bench.run("balls.ply").err.find("is a file of balls, not a command; try morula info balls.ply"),
            std::string::npos);
  EXPECT_NE(bench.run("coords.npy").err.find("is a motion, not a command; try morula update MESH TREE coords.npy"),
            std::string::npos);
  if (has_extra("robot")) {
    EXPECT_NE(bench.run("arm.urdf").err.find("is a robot, not a command; try morula robot arm.urdf -o arm\n"),
              std::string::npos);
  }
  bench.expect_refused("picture.png", "unknown command 'picture.png', which is a file, but neither a mesh (.obj");
  bench.expect_refused("lost.obj", "unknown command 'lost.obj', and there is no file of that name");
}

TEST(NextSteps, of_a_wrong_word_repeat_the_line_with_the_right_one) {
  const Workbench bench;
  bench.expect_refused("buidl", "unknown command 'buidl'; did you mean build? See morula build --help\n");
#ifdef _WIN32
  const std::string quoted = "\"a b.obj\"";  // as cmd.exe takes it, too
#else
  const std::string quoted = "'a b.obj'";
#endif
  bench.expect_refused("buidl 'a b.obj' -o a.morula",
                       "did you mean build? Try morula build " + quoted + " -o a.morula\n");
  bench.expect_refused("xyzzy", "unknown command 'xyzzy'; known: build, measure, deform");
  bench.expect_refused("''", "unknown command ''; known: build");
  bench.expect_refused("help", "unknown command 'help'; try morula --help\n");
  bench.expect_refused("help build", "unknown command 'help'; try morula build --help\n");
  bench.expect_refused("version", "unknown command 'version'; try morula --version\n");
}

TEST(NextSteps, are_no_text_beside_json) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  const CommandResult result = bench.run("bar.obj --json");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(nlohmann::json::parse(result.err)["error"],
            "'bar.obj' is a mesh, not a command; try morula build bar.obj -o bar.morula");
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
#ifndef _WIN32  // where a folder with a name that is too long is one that is not there
  bench.expect_refused("sample bar -o " + std::string(300, 'a') + "/bar.obj", "the name is too long");
#endif
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
