// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What commands do to the files and streams around them.
#include <gtest/gtest.h>

#include <morula/io/motion_file.hpp>
#include <regex>

#include "workbench.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

constexpr int ended_by_its_reader = 128 + 13;  // SIGPIPE, which Windows does not have

struct SmallBench : Workbench {
  SmallBench() {
    require("sample bar -o bar.obj --resolution 4");
    require("build bar.obj -o bar.morula --method octree --depth 2");
    require("deform bar.obj -o motion --twist 30 --frames 3");
    require("update bar.obj bar.morula motion -o spheres");
  }
};

/// Another name of a file of the bench: a symbolic link where one may be made, otherwise a hard one.
void name_again(const Workbench& bench, const std::string& file, const std::string& name) {
  if (can_make_links())
    fs::create_symlink(file, bench / name);
  else
    fs::create_hard_link(bench / file, bench / name);
}

TEST(Outputs, none_is_an_input_of_the_same_command) {
  const SmallBench bench;
  bench.require("convert bar.obj bar.ply");
  name_again(bench, "bar.obj", "link.html");
  fs::create_hard_link(bench / "bar.obj", bench / "hard.morula");
  name_again(bench, "bar.ply", "link.ply");
  name_again(bench, "bar.morula", "tree.npz");
  name_again(bench, "motion/0001.obj", "frame.csv");
  std::vector<std::string> commands{
      "measure bar.obj bar.morula --csv bar.obj",
      "measure bar.obj bar.morula --csv ./bar.morula",
      "measure bar.obj spheres --motion motion --csv spheres/0001.sph",
      "measure bar.obj spheres --motion motion --csv frame.csv",
      "build bar.obj -o hard.morula",
      "build bar.ply -o link.ply --spheres 10",
      "medial bar.ply -o bar.ply",
      "convert bar.obj bar.obj",
      "convert bar.ply link.ply",
      "update bar.obj bar.morula motion -o motion",
      "update bar.obj bar.morula 'motion/*.obj' -o motion",
      "update bar.obj bar.morula motion -o tree.npz",
      "collide bar.obj bar.obj -o frame.csv --motion-a motion/0001.obj",
  };
  if (can_make_links()) {
    fs::create_directory_symlink("motion", bench / "other");
    commands.emplace_back("update bar.obj bar.morula motion -o other");
  }
  if (bench.has_page()) commands.emplace_back("view bar.obj bar.morula -o link.html");
  for (const std::string& command : commands) bench.expect_refused(command, "is also what is read");
#ifdef _WIN32  // which drops ".." and the name before it unread
  bench.expect_refused("convert bar.morula bar.obj/../bar.morula", "is also what is read");
#else
  bench.expect_refused("convert bar.morula bar.obj/../bar.morula", "there is no folder bar.obj/..");
#endif
  bench.expect_refused("convert bar.morula bar.obj/bar.sph", "bar.obj is a file, not a folder");
  bench.expect_refused("update bar.obj spheres/0002.sph motion -o spheres", "would replace spheres/0002.sph");
  bench.expect_refused("deform motion/0000.obj -o motion --twist 40 --frames 3", "would replace motion/0000.obj");
  if (!can_make_links()) return;
  fs::create_symlink("bar.csv", bench / "same.csv");
  bench.require("measure bar.obj bar.morula --csv same.csv");
  EXPECT_TRUE(fs::is_symlink(bench / "same.csv"));
  EXPECT_EQ(bench.read("bar.csv").rfind("frame,tree,level", 0), 0u);
}

TEST(Outputs, a_table_beside_a_file_called_partial_leaves_it_alone) {
  const SmallBench bench;
  bench.write("victim", "precious");
  bench.write("b.csv.partial", "mine");
  name_again(bench, "victim", "a.csv.partial");
  bench.require("measure bar.obj bar.morula --csv a.csv");
  bench.require("measure bar.obj bar.morula --csv b.csv");
  EXPECT_EQ(bench.read("victim"), "precious");
  EXPECT_EQ(bench.read("b.csv.partial"), "mine");
  EXPECT_TRUE(is_same_file(bench / "a.csv.partial", bench / "victim"));
}

TEST(Outputs, left_overs_are_in_nobodys_way) {
  const SmallBench bench;
  for (int n = 0; n < 1000; ++n) {
    fs::create_directory(bench / (".out.partial" + std::to_string(n)));
    bench.write(".morula-" + std::to_string(n) + ".tmp", "");
  }
  bench.require("deform bar.obj -o out --twist 30 --frames 3");
  bench.require("convert bar.obj bar.off");
}

TEST(Outputs, a_failing_update_leaves_the_older_one_whole) {
  const SmallBench bench;
  const Mesh mesh = read_mesh(bench / "bar.obj");
  bench.require("deform bar.obj -o far --twist 60 --frames 3");
  Mesh broken = mesh;
  broken.positions[0].x = 1e30;
  write_mesh(bench / "far/0002.obj", broken);
  bench.expect_refused("update bar.obj bar.morula far -o spheres", "too far away");
  bench.write("spheres/readme.txt", "mine");
  const std::string before = bench.read("spheres/0001.sph");
  fs::remove(bench / "far/0002.obj");
  bench.require("deform bar.obj -o far --twist 60 --frames 3");
  bench.require("update bar.obj bar.morula far -o spheres");
  EXPECT_NE(bench.read("spheres/0001.sph"), before);
  EXPECT_EQ(bench.read("spheres/readme.txt"), "mine");
}

TEST(Outputs, what_plainly_does_not_fit_is_refused) {
  const SmallBench bench;
  // Some 5 TB.
  bench.require("sample limb -o limb.ply --resolution 400");
  bench.expect_refused("deform limb.ply -o limb.npy --twist 30 --frames 1000000", "its disk has");
}

TEST(Inputs, a_frame_that_is_missing_is_named) {
  const SmallBench bench;
  bench.require("deform bar.obj -o long --twist 30 --frames 5");
  bench.require("update bar.obj bar.morula long -o balls");
  fs::remove(bench / "balls/0001.sph");
  bench.expect_refused("measure bar.obj balls --motion long", "0001.sph is missing between");
  fs::remove(bench / "long/0002.obj");
  bench.expect_refused("update bar.obj bar.morula long -o out", "0002.obj is missing between 0001.obj and 0003.obj");
  bench.expect_refused("update bar.obj bar.morula 'long/*.obj' -o out", "0002.obj is missing");
}

TEST(Streams, stderr_closed_changes_nothing) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const SmallBench bench;
  const CommandResult done = bench.shell("\"$MORULA\" convert bar.morula bar.sph 2>&-");
  EXPECT_EQ(done.exit_code, 0);
  bench.require("convert bar.morula other.sph");
  EXPECT_EQ(bench.read("bar.sph"), bench.read("other.sph")) << "what is said of a result went into it";
  EXPECT_EQ(bench.shell("\"$MORULA\" info missing.obj 2>&-").exit_code, 2);
  EXPECT_EQ(bench.shell("\"$MORULA\" info missing.obj 2>/dev/full").exit_code, 2);
  EXPECT_EQ(bench.shell("\"$MORULA\" nonsense 2>&-").exit_code, 2);
}

TEST(Streams, a_reader_that_has_gone_ends_the_report_without_a_word) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const SmallBench bench;
  // Each command waits until its reader has gone, and says its own exit code.
  const auto unread = [&](const std::string& arguments) {
    return bench.shell("rm -f go code; ( until [ -e go ]; do sleep 0.01; done; \"$MORULA\" " + arguments +
                       "; echo $? >code ) | ( exec <&-; : >go ); exit $(cat code)");
  };
  for (const std::string arguments :
       {"convert bar.obj out.off", "convert bar.obj out.off --json", "info bar.obj", "info bar.obj --json", "formats",
        "measure bar.obj bar.morula", "build bar.obj -o out.off.morula --depth 1", "--help", "build --help",
        "--licenses", "completion bash", "sample blob -o out.obj"}) {
    const CommandResult result = unread(arguments);
    EXPECT_EQ(result.exit_code, ended_by_its_reader) << arguments;
    EXPECT_EQ(result.err, "") << arguments;
  }
  EXPECT_EQ(bench.require("info out.off").err, "");
  // What is wrong is said all the same.
  EXPECT_EQ(unread("info missing.obj").exit_code, 2);
  // More than a pipe holds, and then nobody.
  bench.require("deform bar.obj -o whole.npy --twist 3 --frames 20000");
  const CommandResult head = bench.shell(
      "( \"$MORULA\" deform bar.obj -o long.npy --twist 3 --frames 20000 --json; echo $? >code ) | head -c 1; exit "
      "$(cat code)");
  EXPECT_EQ(head.exit_code, ended_by_its_reader);
  EXPECT_EQ(head.err, "");
  EXPECT_TRUE(bench.read("long.npy") == bench.read("whole.npy"));
}

TEST(Streams, a_report_that_cannot_be_printed_is_code_1_and_says_what_is_written) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const SmallBench bench;
  for (const std::string to : {">/dev/full", ">&-"}) {
    fs::remove(bench / "out.off");
    const CommandResult result = bench.shell("\"$MORULA\" convert bar.obj out.off " + to);
    EXPECT_TRUE(fs::exists(bench / "out.off")) << to;
    EXPECT_EQ(result.exit_code, 1) << to;
    EXPECT_EQ(result.err.rfind("morula: error: standard output cannot be written", 0), 0u) << result.err;
    EXPECT_NE(result.err.find("; out.off is written"), std::string::npos) << result.err;
  }
  // More than any buffer holds.
  bench.require("deform bar.obj -o long.npy --twist 30 --frames 20000");
  const CommandResult large =
      bench.shell("\"$MORULA\" deform bar.obj -o long.npy --twist 3 --frames 20000 --json >/dev/full");
  EXPECT_EQ(large.exit_code, 1) << large.err;
  EXPECT_NE(large.err.find("long.npy is written"), std::string::npos) << large.err;
  EXPECT_EQ(bench.shell("\"$MORULA\" info bar.obj >/dev/full").exit_code, 1);
}

TEST(Streams, names_that_are_no_text_are_no_error) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const SmallBench bench;
  fs::copy_file(bench / "bar.obj", bench / "b\xffr.obj");
  EXPECT_EQ(bench.run("info b$(printf '\\377')r.obj --json").exit_code, 0);
}

#ifdef MORULA_MEMORY_CAN_BE_LIMITED  // not under sanitizers, which reserve terabytes before main
TEST(Threads, more_than_there_are_to_be_had_is_a_note) {
  if (!Workbench::has_shell()) GTEST_SKIP() << no_shell;
  const SmallBench bench;
  // Room for the stacks of some threads, large ones, and for the work beside them.
  const CommandResult result = bench.shell(
      "ulimit -s 60000; ulimit -v 300000; MALLOC_ARENA_MAX=1 \"$MORULA\" build bar.obj -o few.morula --method octree "
      "--depth 2 "
      "--threads 64");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err.rfind("morula: note: --threads 64: only ", 0), 0u) << result.err;
  EXPECT_EQ(bench.read("few.morula"), bench.read("bar.morula"));
}
#endif

// Every option that a command's help shows with the name of a number.
TEST(Numbers, are_finite_and_written_as_such_in_every_option) {
  const SmallBench bench;
  const std::vector<std::pair<std::string, std::string>> commands{
      {"sample", "sample bar -o out.obj"},
      {"build", "build bar.obj -o out.morula --method octree"},
      {"measure", "measure bar.obj bar.morula --grid fixed --no-protrusion"},
      {"deform", "deform bar.obj -o out.npy --poke --noise 0.01"},
      {"update", "update bar.obj bar.morula motion -o out"},
      {"collide", "collide bar.obj bar.obj --tree-a bar.morula --tree-b bar.morula"},
      {"view", "view bar.obj bar.morula -o out.html"},
      {"medial", "medial bar.obj -o out.ply"},
      {"info", "info bar.obj"},
      {"convert", "convert bar.obj out.off"},
      {"repair", "repair bar.obj -o out.obj"},
      {"demo", "demo --quick -o out"},
      {"study", "study --quick -o out"},
  };
  const std::regex line("\n +(?:-[a-z],)?(--[a-z-]+) (N|S|LENGTH|SHARE|FACTOR|DEGREES|EXPONENT|N\\|TIME)\\b");
  std::size_t options = 0;
  for (const auto& [name, command] : commands) {
    if (!has_command(name)) continue;
    const std::string help = bench.require(name + " --help").out;
    for (std::sregex_iterator match(help.begin(), help.end(), line), end; match != end; ++match) {
      const std::string option = (*match)[1].str();
      ++options;
      for (const std::string value : {"nan", "inf", "-inf", "1e999", "0x10", "1,5", "''", "'1 2'", "--"}) {
        if (name == "view" && bench.run(command).err.find("built without its page") != std::string::npos) continue;
        bench.expect_refused(command + " " + option + "=" + value, value == "--" ? "" : option);
      }
    }
  }
  EXPECT_GE(options, 30u) << "the help shows numbers in another way: teach it to the test";
}

TEST(Numbers, are_not_negative_where_that_means_nothing) {
  const SmallBench bench;
  const auto refused = [&](const std::string& command, const std::vector<std::string>& options) {
    for (const std::string& option : options) bench.expect_refused(command + " " + option + "=-1", option);
  };
  refused("build bar.obj -o out.morula", {"--seed", "--threads", "--spheres", "--max-protrusion", "--time-limit"});
  refused("build bar.obj -o out.morula --optimizer balance --method medial", {"--balance-excess"});
  refused("measure bar.obj bar.morula --grid fixed", {"--resolution", "--voxel-edge", "--threads"});
  refused("deform bar.obj -o out --twist 3", {"--seed", "--frames", "--poke-radius", "--noise-wavelength"});
  refused("medial bar.obj -o out.ply", {"--seed", "--samples"});
  refused("collide bar.obj bar.obj", {"--level", "--margin", "--budget"});
  if (has_extra("study"))
    refused("study --quick -o out",
            {"--seed", "--max-facets", "--frames", "--resolution", "--branching", "--depth", "--threads"});
  refused("update bar.obj bar.morula motion -o out", {"--distance-floor", "--threads"});
  for (const std::string command : {"build bar.obj -o out.morula", "sample bar -o out.obj"})
    for (const std::string option : {"--branching=-1", "--resolution=-1", "--depth=-1", "--depth=9", "--branching=1"})
      if (bench.run(command.substr(0, 6) + " --help").out.find(option.substr(0, option.find('='))) != std::string::npos)
        bench.expect_refused(command + " " + option, "");
  // 010 is ten, not eight, and a sign is a sign.
  bench.require("sample bar -o ten.obj --resolution 10");
  bench.require("sample bar -o padded.obj --resolution 010");
  bench.require("sample bar -o signed.obj --resolution +10");
  EXPECT_EQ(bench.read("padded.obj"), bench.read("ten.obj"));
  EXPECT_EQ(bench.read("signed.obj"), bench.read("ten.obj"));
}

TEST(Numbers, placements_may_be_as_long_or_short_as_they_like) {
  const SmallBench bench;
  const std::string command = "collide bar.obj bar.obj --tree-a bar.morula --tree-b bar.morula --crossings -o out.csv ";
  bench.require(command + "--rotate-b 0,0,1,90 --translate-b 0.1,0.2,0.3");
  const std::string expected = bench.read("out.csv");
  for (const std::string turn : {"0,0,1e300,90", "0,0,1e-300,90", "0,0,1,450", "0,0,7,3690"}) {
    bench.require(command + "--rotate-b " + turn + " --translate-b 0.1,0.2,0.3");
    EXPECT_EQ(bench.read("out.csv"), expected) << turn;
  }
  bench.expect_refused(command + "--rotate-b 0,0,0,90", "no direction");
  bench.expect_refused(command + "--rotate-b 0,0,1,nan", "three numbers");
  bench.expect_refused(command + "--budget 1e14ms", "--budget");
}

}  // namespace
}  // namespace morula::test
