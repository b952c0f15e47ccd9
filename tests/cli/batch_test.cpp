// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Many meshes: every failure is a row, and whatever interrupts a batch, it ends with the same table.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "workbench.hpp"

namespace morula::test {
namespace {

// Six meshes in a folder: three different ones, two copies of one of them, and one that is no mesh.
void write_meshes(const Workbench& bench) {
  std::filesystem::create_directories(bench / "in" / "more");
  bench.require("sample bar -o in/bar.obj --resolution 6");
  bench.require("sample limb -o in/limb.obj --resolution 10");
  bench.require("sample torus -o in/more/torus.ply --resolution 8");
  for (const char* copy : {"in/again.obj", "in/more/third.obj"})
    std::filesystem::copy_file(bench / "in/bar.obj", bench / copy);
  bench.write("in/broken.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n");
}

std::map<std::string, nlohmann::json> rows_of(const Workbench& bench, const std::string& table) {
  std::map<std::string, nlohmann::json> rows;
  std::istringstream lines(bench.read(table));
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json row = nlohmann::json::parse(line);
    rows.emplace(row.at("name"), row);
  }
  return rows;
}

TEST(Batch, makes_a_row_of_every_mesh) {
  const Workbench bench;
  write_meshes(bench);
  const CommandResult result = bench.run("batch in -o out --method octree --jobs 2 --json");
  EXPECT_EQ(result.exit_code, 1) << "one mesh is broken";
  EXPECT_EQ(result.json().at("meshes"), 6);
  EXPECT_EQ(result.json().at("built"), 4) << "copies share a result";
  EXPECT_EQ(result.json().at("statuses"), (nlohmann::json{{"ok", 5}, {"refused", 1}}));
  auto rows = rows_of(bench, "out/table.jsonl");
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_NE(rows["broken.obj"].at("message").get<std::string>().find("broken.obj:3"), std::string::npos);
  EXPECT_EQ(rows["bar.obj"].at("key"), rows["again.obj"].at("key"));
  EXPECT_EQ(rows["bar.obj"].at("tree"), rows["more/third.obj"].at("tree"));
  std::set<std::string> trees;
  for (const char* mesh : {"bar.obj", "limb.obj", "more/torus.ply"}) {
    const nlohmann::json& row = rows[mesh];
    // The same tree as `build` makes by itself.
    bench.require(std::string("build in/") + mesh + " -o one.morula --method octree");
    EXPECT_EQ(bench.read("out/" + row.at("tree").get<std::string>()), bench.read("one.morula")) << mesh;
    const nlohmann::json info = bench.require("info one.morula --json").json();
    EXPECT_EQ(row.at("tree_hash"), info.at("tree_hash")) << mesh;
    EXPECT_EQ(row.at("covered"), true);
    trees.insert(row.at("tree"));
  }
  EXPECT_EQ(trees.size(), 3u);
  const std::string csv = bench.read("out/table.csv");
  EXPECT_EQ(csv.rfind("name,key,status,message,", 0), 0u);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  for (const std::string& line : bench.listing())
    EXPECT_EQ(line.find("morula-batch"), std::string::npos) << "left behind: " << line;
}

TEST(Batch, reads_lists_and_tables) {
  const Workbench bench;
  write_meshes(bench);
  bench.write("list.txt", "# two of them\nin/bar.obj\n\n  in/limb.obj \r\n");
  bench.require("batch list.txt -o a --method octree --no-trees");
  EXPECT_EQ(rows_of(bench, "a/table.jsonl").size(), 2u);
  EXPECT_FALSE(rows_of(bench, "a/table.jsonl")["in/bar.obj"].contains("tree"));
  bench.write("list.csv", "name,weight,mesh\n\"a \"\"bar\"\", perhaps\",3,in/bar.obj\nlimb,1,\"in/limb.obj\"\n");
  bench.require("batch list.csv -o b --method octree");
  EXPECT_TRUE(rows_of(bench, "b/table.jsonl").contains("a \"bar\", perhaps"));
  EXPECT_NE(bench.read("b/table.csv").find("\n\"a \"\"bar\"\", perhaps\","), std::string::npos);
  bench.write("missing.txt", "in/bar.obj\nin/nowhere.obj\n");
  EXPECT_EQ(bench.run("batch missing.txt -o c --method octree").exit_code, 1);
  EXPECT_NE(rows_of(bench, "c/table.jsonl")["in/nowhere.obj"].at("message").get<std::string>().find("no such file"),
            std::string::npos);

  // Names that are written as URIs.
  std::filesystem::copy_file(bench / "in/bar.obj", bench / "in/a bar.obj");
  bench.write("uris.txt", "in/a%20bar.obj\nfile://" + (bench / "in/limb.obj").generic_string() + "\n");
  bench.require("batch uris.txt -o uris --method octree --no-trees");

  bench.write("none.txt", "# nothing\n");
  bench.expect_refused("batch none.txt -o d", "none.txt: no line names a mesh");
  bench.write("bad.csv", "name,weight\na,1\n");
  bench.expect_refused("batch bad.csv -o d", "bad.csv: line 1: no column is called mesh, path or file");
  bench.write("short.csv", "name,mesh\na\n");
  bench.expect_refused("batch short.csv -o d", "short.csv: line 2: 1 cells, but 2 columns");
  bench.expect_refused("batch in/bar.obj -o d", "this is a mesh");
  bench.expect_refused("batch nowhere.txt -o d", "nowhere.txt");
  bench.expect_refused("batch in -o a", "add --resume");
  bench.expect_refused("batch in -o d --shard 3/2", "--shard 3/2");
  bench.expect_refused("batch in -o d --shard 2", "--shard 2");
}

TEST(Batch, meshes_outside_of_the_manifests_folder_are_rows_that_are_refused) {
  const Workbench bench;
  write_meshes(bench);
  std::filesystem::create_directory(bench / "lists");
  std::filesystem::create_symlink(bench / "in/bar.obj", bench / "lists/link.obj");
  std::filesystem::copy_file(bench / "in/bar.obj", bench / "lists/own.obj");
  bench.write("lists/list.txt", "own.obj\n../in/bar.obj\n%2e%2e/in/bar.obj\n" + (bench / "in/limb.obj").string() +
                                    "\nfile://" + (bench / "in/limb.obj").string() + "\nlink.obj\n");
  const auto expect = [&](const std::string& command, const std::string& out, std::size_t refused, std::size_t ok) {
    const CommandResult result = bench.run(command + " -o " + out + " --method octree --no-trees");
    EXPECT_EQ(result.exit_code, refused == 0 ? 0 : 1) << result.err;
    std::size_t outside = 0, good = 0;
    for (const auto& [name, row] : rows_of(bench, out + "/table.jsonl")) {
      const std::string message = row.at("message");
      outside += row.at("status") == "refused" && message.find("lies outside ") != std::string::npos &&
                         message.find("; allow its folder with --root ") != std::string::npos
                     ? 1
                     : 0;
      good += row.at("status") == "ok" ? 1 : 0;
    }
    EXPECT_EQ(outside, refused) << command;
    EXPECT_EQ(good, ok) << command;
  };
  expect("batch lists/list.txt", "a", 5, 1);
  expect("batch lists/list.txt --root in/", "b", 0, 6);
  expect("batch lists", "c", 1, 1);
  expect("batch lists --root in", "d", 0, 2);
}

TEST(Batch, refuses_options_before_it_reads_meshes) {
  const Workbench bench;
  write_meshes(bench);
  for (const auto& [options, words] :
       std::map<std::string, std::string>{{"--method gird", "did you mean grid?"},
                                          {"--spheres 8 --depth 2", "contradict each other"},
                                          {"--branching 99", "branching"}}) {
    const CommandResult result = bench.run("batch in -o out " + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  }
}

TEST(Batch, of_shards_is_the_whole) {
  const Workbench bench;
  write_meshes(bench);
  bench.run("batch in -o whole --method octree");
  for (const char* shard : {"1/3", "2/3", "3/3"})
    bench.run(std::string("batch in -o parts --method octree --shard ") + shard);
  EXPECT_EQ(rows_of(bench, "parts/table-2-of-3.jsonl").size(), 2u);
  const CommandResult rest = bench.run("batch in -o parts --method octree --resume --json");
  EXPECT_EQ(rest.json().at("built"), 0);
  EXPECT_EQ(bench.read("parts/table.csv"), bench.read("whole/table.csv"));
}

TEST(Batch, ends_what_takes_too_long_or_too_much) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 96");
  bench.write("list.txt", "limb.obj\n");
  EXPECT_EQ(bench.run("batch list.txt -o late --quality best --time-limit 0.05").exit_code, 1);
  EXPECT_EQ(rows_of(bench, "late/table.jsonl")["limb.obj"].at("status"), "time limit");
  EXPECT_FALSE(rows_of(bench, "late/table.jsonl")["limb.obj"].contains("tree"));
  for (const std::string& line : bench.listing()) EXPECT_EQ(line.find(".tmp"), std::string::npos) << line;
  // Without --retry it stays as it is; with it, and time, it is built.
  bench.run("batch list.txt -o late --quality best --time-limit 0.05 --resume");
  EXPECT_EQ(rows_of(bench, "late/table.jsonl")["limb.obj"].at("status"), "time limit");
#ifdef MORULA_MEMORY_CAN_BE_LIMITED
  // 368,000 facets: their index alone takes some 90 MB, whatever else is made smaller.
  bench.require("sample limb -o large.obj --resolution 384");
  bench.write("large.txt", "large.obj\n");
  EXPECT_EQ(bench.run("batch large.txt -o small --method medial --memory-limit 64").exit_code, 1);
  const std::string status = rows_of(bench, "small/table.jsonl")["large.obj"].at("status");
  EXPECT_EQ(status, "memory limit") << bench.read("small/table.csv");
#endif
  bench.require("batch list.txt -o late --method octree --retry");
}

TEST(Batch, killed_at_any_instant_and_resumed_ends_with_the_same_table) {
  const Workbench bench;
  write_meshes(bench);
  bench.run("batch in -o straight --quality fast");
  int killed = 0;
  for (const char* after : {"0.01", "0.05", "0.1", "0.15", "0.2", "0.3"}) {
    const CommandResult result =
        bench.shell(std::string("\"$MORULA\" batch in -o torn --quality fast --resume --jobs 2 & sleep ") + after +
                    "; kill -9 $! 2>/dev/null; wait $!");
    killed += result.exit_code == 137 ? 1 : 0;
  }
  EXPECT_GT(killed, 0);
  EXPECT_EQ(bench.run("batch in -o torn --quality fast --resume").exit_code, 1);
  EXPECT_EQ(bench.read("torn/table.csv"), bench.read("straight/table.csv"));
  EXPECT_EQ(bench.read("torn/table.jsonl"), bench.read("straight/table.jsonl"));
  for (const auto& [name, row] : rows_of(bench, "straight/table.jsonl")) {
    if (row.at("status") != "ok") continue;
    const std::string tree = row.at("tree");
    EXPECT_EQ(bench.read("torn/" + tree), bench.read("straight/" + tree));
  }
}

TEST(Batch, keeps_what_is_done_when_it_is_interrupted) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 96");
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.write("list.txt", "bar.obj\nlimb.obj\n");
  // In a shell of its own: one that starts jobs in the background makes them ignore Ctrl-C.
  bench.write("interrupt.bash",
              "set -m\n\"$MORULA\" batch list.txt -o out --quality best --jobs 1 &\n"
              "for wait in $(seq 3000); do\n"
              "  [ -z \"$(find out/results -name '*.json' 2>/dev/null)\" ] || break\n  sleep 0.02\ndone\n"
              "kill -INT $!\nwait $!\n");
  const CommandResult result = bench.shell("MORULA=$MORULA bash interrupt.bash");
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_NE(result.err.find("--resume"), std::string::npos) << result.err;
  const CommandResult rest =
      bench.run("batch list.txt -o out --quality best --resume --no-trees --time-limit 0.05 --json");
  EXPECT_EQ(rest.json().at("built"), 1) << "bar was done";
}

}  // namespace
}  // namespace morula::test
