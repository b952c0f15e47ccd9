// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Batches among pipes, sockets, devices, links and closed folders, and whose worker is killed.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "batch_rows.hpp"

namespace morula::test {
namespace {

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

}  // namespace
}  // namespace morula::test
