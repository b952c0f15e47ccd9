// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Many meshes: every failure is a row, and whatever interrupts a batch, it ends with the same table.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <set>
#include <support/scoped_variable.hpp>
#include <thread>

#include "batch_rows.hpp"
#include "running_command.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

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
    EXPECT_EQ(line.find(".morula-"), std::string::npos) << "left behind: " << line;
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
  const bool has_link = can_make_links();
  if (has_link) std::filesystem::create_symlink(bench / "in/bar.obj", bench / "lists/link.obj");
  std::filesystem::copy_file(bench / "in/bar.obj", bench / "lists/own.obj");
  const std::string limb = (bench / "in/limb.obj").generic_string(), more = has_link ? "link.obj" : "./../in/bar.obj";
  bench.write("lists/list.txt",
              "own.obj\n../in/bar.obj\n%2e%2e/in/bar.obj\n" + limb + "\nfile://" + limb + "\n" + more + "\n");
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
  const std::size_t links = has_link ? 1 : 0;
  expect("batch lists", "c", links, 1);
  expect("batch lists --root in", "d", 0, 1 + links);
}

TEST(Batch, refuses_options_before_it_reads_meshes) {
  const Workbench bench;
  write_meshes(bench);
  for (const auto& [options, words] :
       std::map<std::string, std::string>{{"--method gird", "did you mean grid?"},
                                          {"--spheres 8 --depth 2", "contradict each other"},
                                          {"--qualty fast", "did you mean --quality?"},
                                          {"--depth 99", "depth"},
                                          {"--method grid --reducers merge", "takes no list of reducers"},
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

#ifdef _WIN32
constexpr const char* temporary_variable = "TMP";
#else
constexpr const char* temporary_variable = "TMPDIR";
#endif

TEST(Batch, names_the_folder_for_temporary_files_that_is_missing) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 3");
  bench.write("list.txt", "bar.obj\n");
  const ScopedVariable moved(temporary_variable, (bench / "nowhere").string());
  bench.expect_refused("batch list.txt -o out", std::string("set ") + temporary_variable + " to one that is");
}

TEST(Batch, of_a_shard_without_meshes_is_done) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 3");
  bench.write("list.txt", "bar.obj\n");
  EXPECT_EQ(bench.require("batch list.txt -o out --method octree --shard 1/2").out.rfind("1 mesh, 1 built", 0), 0u);
  EXPECT_EQ(bench.require("batch list.txt -o out --method octree --shard 2/2").out.rfind("0 meshes, 0 built", 0), 0u);
  EXPECT_TRUE(rows_of(bench, "out/table-2-of-2.jsonl").empty());
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
  const fs::path errors = bench.folder().string() + ".err";
  for (const int after : {10, 50, 100, 150, 200, 300}) {
    RunningCommand batch(bench, {"batch", "in", "-o", "torn", "--quality", "fast", "--resume", "--jobs", "2"}, errors);
    std::this_thread::sleep_for(std::chrono::milliseconds(after));
    batch.kill();
    killed += batch.wait() == -1 ? 1 : 0;
  }
  fs::remove(errors);
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
  if (!RunningCommand::can_send()) GTEST_SKIP() << RunningCommand::cannot_send;
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 96");
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.write("list.txt", "bar.obj\nlimb.obj\n");
  const fs::path errors = bench.folder().string() + ".err";
  RunningCommand batch(bench, {"batch", "list.txt", "-o", "out", "--quality", "best", "--jobs", "1"}, errors);
  const auto is_one_done = [&] {
    std::error_code error;
    for (fs::recursive_directory_iterator file(bench / "out/results", error), end; !error && file != end;
         file.increment(error))
      if (file->path().extension() == ".json") return true;
    return false;
  };
  while (batch.is_running() && !is_one_done()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto [signal, code] = requests_to_end().front();
  batch.send(signal);
  EXPECT_EQ(batch.wait(), code);
  const std::string said = bytes_of(errors);
  fs::remove(errors);
  EXPECT_NE(said.find("interrupted; what is done is kept, and the same command with --resume goes on"),
            std::string::npos)
      << said;
  for (const std::string& line : bench.listing()) EXPECT_EQ(line.find(".tmp"), std::string::npos) << line;
  const CommandResult rest =
      bench.run("batch list.txt -o out --quality best --resume --no-trees --time-limit 0.05 --json");
  EXPECT_EQ(rest.json().at("built"), 1) << "bar was done";
}

TEST(Batch, builds_again_what_is_damaged_or_has_lost_its_tree) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  for (const char* name : {"bar", "limb", "torus", "blob", "capsule", "two", "tool"})
    bench.require(std::string("sample ") + name + " -o in/" + name + ".obj --resolution 6");
  bench.require("batch in -o out --method octree --quiet");
  const std::string csv = bench.read("out/table.csv"), jsonl = bench.read("out/table.jsonl");
  auto trees = kept_files(bench, "out", "trees", ".morula"), results = kept_files(bench, "out", "results", ".json");
  std::map<fs::path, std::string> before;
  for (const auto& files : {trees, results})
    for (const auto& [name, file] : files) before[file] = bytes_of(file);

  fs::remove(trees["bar.obj"]);
  fs::resize_file(trees["limb.obj"], fs::file_size(trees["limb.obj"]) / 2);
  std::string changed = before[trees["torus.obj"]];
  changed[changed.size() / 2] = static_cast<char>(changed[changed.size() / 2] ^ 1);
  std::ofstream(trees["torus.obj"], std::ios::binary) << changed;
  fs::copy_file(trees["two.obj"], trees["blob.obj"], fs::copy_options::overwrite_existing);
  std::ofstream(results["capsule.obj"]) << R"({"status":"ok"})";
  const CommandResult result = bench.run("batch in -o out --method octree --resume --json");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.json().at("remade"), 5);
  EXPECT_EQ(result.json().at("built"), 5);
  EXPECT_EQ(result.json().at("kept"), 2);
  EXPECT_NE(result.err.find("5 results in the folder were damaged"), std::string::npos) << result.err;
  EXPECT_EQ(bench.read("out/table.csv"), csv);
  EXPECT_EQ(bench.read("out/table.jsonl"), jsonl);
  for (const auto& [name, file] : trees) EXPECT_EQ(bytes_of(file), before[file]) << name;
  EXPECT_EQ(bench.run("batch in -o out --method octree --resume --json").json().at("built"), 0);
}

TEST(Batch, survives_folders_and_files_in_the_way_of_results) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  for (const char* name : {"bar", "limb", "torus", "blob"})
    bench.require(std::string("sample ") + name + " -o in/" + name + ".obj --resolution 6");
  bench.require("batch in -o out --method octree --quiet");
  auto trees = kept_files(bench, "out", "trees", ".morula"), results = kept_files(bench, "out", "results", ".json");
  fs::remove(trees["limb.obj"]);
  fs::create_directories(trees["limb.obj"] / "in the way");
  fs::remove_all(results["torus.obj"].parent_path());
  std::ofstream(results["torus.obj"].parent_path()) << "a file";
  const CommandResult result = bench.run("batch in -o out --method octree --resume");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  for (const auto& [name, row] : rows_of(bench, "out/table.jsonl")) {
    const std::string status = row.at("status"), message = row.at("message");
    EXPECT_TRUE(status == "ok" || (status == "failed" && !message.empty())) << row;
  }
  // What was in the way is taken out of it: nothing of the failure was kept.
  fs::remove_all(bench / "out/results");
  fs::remove_all(bench / "out/trees");
  bench.require("batch in -o out --method octree --resume");
}

TEST(Batch, reports_progress_on_stderr_alone) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  bench.require("sample bar -o in/0.obj --resolution 4");
  for (int i = 1; i < 20; ++i)
    bench.write("in/" + std::to_string(i) + ".obj", bench.read("in/0.obj") + "# " + std::to_string(i) + "\n");
  const CommandResult loud = bench.run("batch in -o loud --method octree --jobs 1");
  EXPECT_EQ(loud.exit_code, 0);
  EXPECT_EQ(std::count(loud.err.begin(), loud.err.end(), '\n'), 9) << loud.err;
  EXPECT_EQ(loud.err.rfind("morula: note: 2 of 20 meshes", 0), 0u) << loud.err;
  EXPECT_EQ(loud.out.rfind("20 meshes, 20 built, 0 kept\n", 0), 0u) << loud.out;
  const CommandResult quiet = bench.run("batch in -o quiet --method octree --jobs 1 --quiet");
  EXPECT_EQ(quiet.err, "");
  EXPECT_EQ(bench.read("loud/table.csv"), bench.read("quiet/table.csv"));
}

TEST(Batch, measures_as_measure_does) {
  const Workbench bench;
  write_meshes(bench);
  bench.run("batch in -o out --method octree --depth 2 --measure");
  auto rows = rows_of(bench, "out/table.jsonl");
  const nlohmann::json& row = rows["limb.obj"];
  const nlohmann::json levels =
      bench.require("measure in/limb.obj out/" + row.at("tree").get<std::string>() + " --json")
          .json()
          .at("frames")
          .at(0)
          .at("levels");
  ASSERT_EQ(row.at("looseness").size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(row.at("looseness").at(i), levels.at(i).at("looseness")) << levels.at(i);
    EXPECT_EQ(row.at("uncovered_area").at(i), levels.at(i).at("uncovered_area"));
    EXPECT_EQ(row.at("uncovered_distance").at(i), levels.at(i).at("uncovered_distance"));
    EXPECT_EQ(row.at("protrusion").at(i), levels.at(i).at("protrusion_worst"));
  }
  EXPECT_EQ(row.at("closed"), true);
  EXPECT_FALSE(rows["broken.obj"].contains("looseness"));
  bench.run("batch in -o plain --method octree --depth 2");
  EXPECT_FALSE(rows_of(bench, "plain/table.jsonl")["limb.obj"].contains("looseness"));
}

#ifdef MORULA_MEMORY_CAN_BE_LIMITED
TEST(Batch, a_mesh_that_takes_all_memory_costs_its_own_row_alone) {
  const Workbench bench;
  write_meshes(bench);
  bench.require("sample limb -o in/bars.obj --resolution 384");  // between others, of one worker
  bench.run("batch in -o out --method octree --depth 2 --jobs 1 --memory-limit 64");
  auto rows = rows_of(bench, "out/table.jsonl");
  EXPECT_EQ(rows["bars.obj"].at("status"), "memory limit") << rows["bars.obj"];
  fs::remove(bench / "in/bars.obj");
  bench.run("batch in -o alone --method octree --depth 2");
  for (const auto& [name, row] : rows_of(bench, "alone/table.jsonl")) EXPECT_EQ(rows[name], row) << name;
}
#endif

}  // namespace
}  // namespace morula::test
