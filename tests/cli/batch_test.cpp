// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Many meshes: every failure is a row, and whatever interrupts a batch, it ends with the same table.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
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

TEST(Batch, names_the_folder_for_temporary_files_that_is_missing) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 3");
  bench.write("list.txt", "bar.obj\n");
  const CommandResult result = bench.shell("TMPDIR=/nowhere $MORULA batch list.txt -o out");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("set TMPDIR to one that is"), std::string::npos) << result.err;
}

#ifndef _WIN32
TEST(Batch, leaves_no_temporary_folder_where_a_signal_ends_it) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 3");
  bench.write("list.txt", "bar.obj\n");
  const CommandResult result = bench.shell(
      "mkdir temporary; TMPDIR=$PWD/temporary $MORULA batch list.txt -o out & batch=$!; "
      "while [ -z \"$(ls -A temporary)\" ] && kill -0 $batch; do :; done; kill -TERM $batch; wait $batch; echo $?; "
      "ls -A temporary");
  EXPECT_EQ(result.out, "143\n") << result.err;
}
#endif

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
  EXPECT_NE(result.err.find("interrupted; what is done is kept, and the same command with --resume goes on"),
            std::string::npos)
      << result.err;
  for (const std::string& line : bench.listing()) EXPECT_EQ(line.find(".tmp"), std::string::npos) << line;
  const CommandResult rest =
      bench.run("batch list.txt -o out --quality best --resume --no-trees --time-limit 0.05 --json");
  EXPECT_EQ(rest.json().at("built"), 1) << "bar was done";
}

namespace fs = std::filesystem;

// A socket by the name of a mesh; its path is short, whatever the folder's is.
void make_socket(const fs::path& folder, const char* name) {
  const fs::path before = fs::current_path();
  fs::current_path(folder);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, name, sizeof address.sun_path - 1);
  const int file = socket(AF_UNIX, SOCK_STREAM, 0);
  EXPECT_EQ(bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(file);
  fs::current_path(before);
}

// Everything of the name of a mesh that is none, and what may hide meshes. Message by name.
std::map<std::string, std::string> write_what_is_no_mesh(const Workbench& bench, const fs::path& folder) {
  EXPECT_EQ(mkfifo((folder / "fifo.obj").c_str(), 0600), 0);
  make_socket(folder, "socket.obj");
  fs::create_symlink("/dev/zero", folder / "device.obj");
  fs::create_symlink("two.obj", folder / "one.obj");
  fs::create_symlink("one.obj", folder / "two.obj");
  fs::create_symlink("nowhere.obj", folder / "dangling.obj");
  fs::create_symlink("gone", folder / "dangling");
  fs::create_directories(folder / "folder.obj");
  fs::create_directories(bench / "elsewhere");
  fs::create_symlink("..", folder / "up");
  return {{"fifo.obj", "is a FIFO, not a file"},
          {"socket.obj", "is a socket, not a file"},
          {"device.obj", "is a device, not a file"},
          {"one.obj", "circle of links"},
          {"two.obj", "circle of links"},
          {"dangling.obj", "is a link to nowhere.obj, which is not there"},
          {"dangling", "is a link to gone, which is not there"},
          {"folder.obj", "is a folder, not a file"},
          {"up", "is a link to a folder"}};
}

TEST(Batch, makes_a_row_of_whatever_lies_in_a_folder) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  const auto refused = write_what_is_no_mesh(bench, bench / "in");
  bench.require("sample bar -o in/folder.obj/inner.obj --resolution 4");
  // Bytes that are not UTF-8, and the text that stands for them.
  const std::string name = "b\xffr.obj", text = "b\\xFFr.obj";
  for (const std::string& copy : {name, text}) fs::copy_file(bench / "in/folder.obj/inner.obj", bench / "in" / copy);
  bench.write("in/notes.txt", "no mesh");
  const CommandResult result = bench.run("batch in -o out --method octree --json");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_EQ(result.json().at("statuses"), (nlohmann::json{{"ok", 3}, {"refused", refused.size()}})) << result.out;
  auto rows = rows_of(bench, "out/table.jsonl");
  for (const auto& [mesh, words] : refused) {
    ASSERT_TRUE(rows.contains(mesh)) << mesh;
    const std::string message = rows[mesh].at("message");
    EXPECT_EQ(rows[mesh].at("status"), "refused") << mesh;
    EXPECT_EQ(message.rfind(mesh + ": ", 0), 0u) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message;
  }
  EXPECT_EQ(rows["folder.obj/inner.obj"].at("status"), "ok");
  EXPECT_EQ(rows["b\\xFFr.obj"].at("status"), "ok") << "the byte";
  EXPECT_EQ(rows["b\\\\xFFr.obj"].at("status"), "ok") << "the text";
  EXPECT_NE(bench.read("out/table.csv").find("\nb\\xFFr.obj,"), std::string::npos);
}

TEST(Batch, makes_rows_of_what_a_list_names) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  auto refused = write_what_is_no_mesh(bench, bench / "in");
  refused["up"] = refused["device.obj"] = "lies outside";
  refused["notes.txt"] = "no known mesh format";
  refused["nowhere"] = "there is no such file";
  refused[std::string("a\0b.obj", 7)] = "zero byte";
  refused[std::string(5000, 'n')] = "cannot be read";
  bench.require("sample bar -o in/bar.obj --resolution 4");
  bench.write("in/notes.txt", "no mesh");
  std::string list = "bar.obj\n";
  for (const auto& [mesh, words] : refused) list += mesh + "\n";
  bench.write("in/list.txt", list);
  const CommandResult result = bench.run("batch in/list.txt -o out --method octree --json");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  auto rows = rows_of(bench, "out/table.jsonl");
  EXPECT_EQ(rows.size(), refused.size() + 1);
  EXPECT_EQ(rows["bar.obj"].at("status"), "ok");
  for (const auto& [mesh, words] : refused) {
    EXPECT_EQ(rows[mesh].at("status"), "refused") << mesh;
    EXPECT_NE(rows[mesh].at("message").get<std::string>().find(words), std::string::npos) << rows[mesh];
  }
}

TEST(Batch, makes_a_row_of_a_folder_that_cannot_be_listed) {
  const Workbench bench;
  const bool is_root = geteuid() == 0;
  if (is_root && bench.shell("setpriv --reuid=65534 --regid=65534 --clear-groups true").exit_code != 0)
    // Without setpriv (a stripped container) root has no way to meet such a folder.
    GTEST_SKIP() << "root may list every folder, and cannot become another user here";
  fs::create_directories(bench / "in/closed");
  bench.require("sample bar -o in/bar.obj --resolution 4");
  fs::permissions(bench / "in/closed", fs::perms::none);
  fs::permissions(bench.folder(), fs::perms::all);
  const CommandResult result =
      bench.shell(std::string(is_root ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "") +
                  "\"$MORULA\" batch in -o out --method octree");
  fs::permissions(bench / "in/closed", fs::perms::owner_all);
  EXPECT_EQ(result.exit_code, 1) << result.err;
  auto rows = rows_of(bench, "out/table.jsonl");
  EXPECT_EQ(rows["bar.obj"].at("status"), "ok");
  EXPECT_EQ(rows["closed"].at("status"), "refused");
  EXPECT_EQ(rows["closed"].at("message"), "closed: cannot be listed: Permission denied");
}

// Files of results and trees by the names of their meshes.
std::map<std::string, fs::path> kept_files(const Workbench& bench, const std::string& out, const std::string& folder,
                                           const std::string& ending) {
  std::map<std::string, fs::path> files;
  for (const auto& [name, row] : rows_of(bench, out + "/table.jsonl")) {
    const std::string key = row.at("key");
    files[name] = bench / out / folder / key.substr(0, 2) / (key + ending);
  }
  return files;
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

TEST(Batch, survives_whatever_lies_in_the_folder_of_results) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  for (const char* name : {"bar", "limb", "torus", "blob"})
    bench.require(std::string("sample ") + name + " -o in/" + name + ".obj --resolution 6");
  bench.require("batch in -o out --method octree --quiet");
  auto trees = kept_files(bench, "out", "trees", ".morula"), results = kept_files(bench, "out", "results", ".json");
  fs::remove(results["bar.obj"]);
  EXPECT_EQ(mkfifo(results["bar.obj"].c_str(), 0600), 0);
  fs::remove(trees["limb.obj"]);
  fs::create_directories(trees["limb.obj"] / "in the way");
  fs::remove_all(results["torus.obj"].parent_path());
  std::ofstream(results["torus.obj"].parent_path()) << "a file";
  fs::remove(results["blob.obj"]);
  fs::create_symlink(results["blob.obj"].filename(), results["blob.obj"]);
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

TEST(Batch, writes_through_no_link_in_the_folder_of_results) {
  const Workbench bench;
  fs::create_directories(bench / "in");
  for (const char* name : {"bar", "limb"})
    bench.require(std::string("sample ") + name + " -o in/" + name + ".obj --resolution 6");
  bench.require("batch in -o out --method octree --quiet");
  const std::string table = bench.read("out/table.jsonl");
  for (const auto& [kind, ending] : {std::pair{"trees", ".morula"}, std::pair{"results", ".json"}}) {
    auto kept = kept_files(bench, "out", kind, ending);
    const std::string limb = bytes_of(kept["limb.obj"]);
    fs::remove(kept["bar.obj"]);
    fs::create_symlink(fs::absolute(kept["limb.obj"]), kept["bar.obj"]);
    bench.require("batch in -o out --method octree --resume --quiet");
    EXPECT_FALSE(fs::is_symlink(kept["bar.obj"])) << kind;
    EXPECT_EQ(bytes_of(kept["limb.obj"]), limb) << kind;
    EXPECT_EQ(bench.read("out/table.jsonl"), table) << kind;
  }
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

// Kills the worker while it builds, `times` in turn; gives the row's status.
std::string status_after_kills_of_the_worker(int times) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 24");
  bench.write("list.txt", "limb.obj\n");
  bench.write(
      "kill.bash",
      "\"$MORULA\" batch list.txt -o out --quiet &\nbatch=$!\n"
      "for kill in $(seq " +
          std::to_string(times) +
          "); do\n"
          "  for wait in $(seq 3000); do\n"
          "    worker=$(cat /proc/$batch/task/$batch/children)\n"
          "    [ -n \"$worker\" ] && [ -d out/trees ] && [ -n \"$(cat /proc/${worker% }/task/*/children)\" ] && break\n"
          "    sleep 0.005\n  done\n  kill -9 $worker\n"
          "  for wait in $(seq 3000); do [ -d /proc/${worker% } ] || break; sleep 0.005; done\ndone\nwait $batch\n");
  const CommandResult result = bench.shell("MORULA=$MORULA bash kill.bash 2>/dev/null");
  EXPECT_EQ(result.exit_code, times < 2 ? 0 : 1) << result.out << result.err;
  return rows_of(bench, "out/table.jsonl")["limb.obj"].at("status");
}

TEST(Batch, replaces_a_worker_that_is_lost) {
  if (!fs::exists("/proc/self/task/" + std::to_string(getpid()) + "/children"))
    // The test has to find the worker: kernels without CONFIG_PROC_CHILDREN hide it.
    GTEST_SKIP() << "this system does not list the children of a process";
  EXPECT_EQ(status_after_kills_of_the_worker(1), "ok");
  EXPECT_EQ(status_after_kills_of_the_worker(2), "crashed");
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
