// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <morula/io/file_reference.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/whole_output.hpp>
#include <support/npy.hpp>
#include <support/zip.hpp>
#include <vector>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

TEST(FileReference, schemes_are_split_off_and_paths_decoded) {
  struct Case {
    std::string text, scheme;
    std::vector<std::string> paths;
  };
  for (const Case& c : std::vector<Case>{
           {"a/b.obj", "", {"a/b.obj"}},
           {"a%20b.obj", "", {"a%20b.obj", "a b.obj"}},
           {"file:///a%20b.obj", "", {"/a b.obj", "/a%20b.obj"}},
           {"file://localhost/a.obj", "", {"/a.obj"}},
           {"FILE://LOCALHOST/a.obj", "", {"/a.obj"}},
           {"file:/a.obj", "", {"/a.obj"}},
           {"file:a.obj", "", {"file:a.obj"}},
           {"file://a/b.obj", "", {"a/b.obj"}},
           {"package://p/a%2Fb.obj", "package", {"p/a/b.obj", "p/a%2Fb.obj"}},
           {"Model://m/a", "model", {"m/a"}},
           {"https://host/a?b=%20", "https", {"host/a?b= ", "host/a?b=%20"}},
           {"C:/a/b", "", {"C:/a/b"}},
           {"C:\\a\\b", "", {"C:/a/b"}},
           {"C://a", "", {"C://a"}},
           {"file:///C:/a%20b", "", {"C:/a b", "C:/a%20b"}},
           {"a\\b", "", {"a\\b"}},
           {"a/b://c", "", {"a/b://c"}},
           {"%00%", "", {"%00%"}},
           {"%2e%2E/%zz%4", "", {"%2e%2E/%zz%4", "../%zz%4"}},
           {"", "", {""}},
       }) {
    const FileReference read = parse_file_reference(c.text);
    EXPECT_EQ(read.scheme, c.scheme) << c.text;
    EXPECT_EQ(read.paths, c.paths) << c.text;
  }
}

TEST(FileReference, a_file_is_looked_for_as_written_and_then_decoded) {
  const ScratchFolder scratch;
  const fs::path blank = scratch.file("a b.obj", ""), percent = scratch.file("c%20d.obj", "");
  EXPECT_EQ(referenced_file("a%20b.obj", scratch.path()), blank);
  EXPECT_EQ(referenced_file("c%20d.obj", scratch.path()), percent);
  scratch.file("c d.obj", "");
  EXPECT_EQ(referenced_file("c%20d.obj", scratch.path()), percent);
  EXPECT_EQ(referenced_file("file://" + blank.string(), "/nowhere"), blank);
  EXPECT_EQ(referenced_file("none%20.obj", "x"), fs::path("x/none%20.obj"));
  EXPECT_EQ(referenced_file("https://host/a", "x"), fs::path("x/https://host/a")) << "which is not there";
}

TEST(FileRoots, hold_what_lies_in_them_once_links_are_resolved) {
  if (!can_make_links()) GTEST_SKIP() << no_links;
  const ScratchFolder scratch;
  scratch.file("root/in/a.obj", "");
  scratch.file("root2/b.obj", "");
  fs::create_symlink(scratch.path() / "root2/b.obj", scratch.path() / "root/out.obj");
  fs::create_symlink("in/a.obj", scratch.path() / "root/inside.obj");
  fs::create_directory_symlink(scratch.path() / "root", scratch.path() / "alias");
  const auto at = [&](const char* name) { return scratch.path() / name; };
  for (const char* root : {"root", "root/", "root//", "root/.", "root/in/..", "alias", "alias/", "none/../root"}) {
    const FileRoots roots({at(root)});
    for (const char* file :
         {"root", "root/in/a.obj", "root/inside.obj", "alias/in/a.obj", "root/in/../in/a.obj", "root/none"})
      EXPECT_TRUE(roots.hold(at(file))) << root << " " << file;
    for (const char* file : {"root2/b.obj", "root/out.obj", "alias/out.obj", "root/../root2/b.obj", "", "root2"})
      EXPECT_FALSE(roots.hold(at(file))) << root << " " << file;
  }
  EXPECT_FALSE(FileRoots().hold(at("root/in/a.obj")));
  EXPECT_FALSE(FileRoots({at("none")}).hold(at("root/in/a.obj")));
  EXPECT_TRUE(FileRoots({"/"}).hold(at("root/in/a.obj")));
  EXPECT_TRUE(FileRoots({""}).hold("some file")) << "the working folder";
  EXPECT_FALSE(FileRoots({""}).hold(at("root/in/a.obj")));
  const FileRoots two({at("root"), at("none/")});
  EXPECT_EQ(two.refusal(at("root/in/a.obj"), "--root"), std::nullopt);
  EXPECT_EQ(two.refusal(at("nowhere.obj"), "--root"), std::nullopt) << "there is nothing to open";
  EXPECT_EQ(two.refusal(at("root2/b.obj"), "--root"), "lies outside " + at("root").string() + " and " +
                                                          at("none").string() + "; allow its folder with --root " +
                                                          at("root2").string());
  EXPECT_EQ(two.refusal(at("root/out.obj"), "-x").value().rfind("leads to " + at("root2/b.obj").string(), 0), 0u);
}

// This program may have any code page on Windows.
TEST(FileNames, are_utf8_in_messages_and_in_references_whatever_their_letters) {
  const std::u8string letters = u8"Kügel 中 🌳";
  const std::string name(letters.begin(), letters.end());
  const ScratchFolder scratch;
  const fs::path folder = scratch.path() / letters, file = folder / (letters + u8".obj");
  fs::create_directory(folder);
  const Mesh mesh = small_mesh();
  write_mesh(file, mesh);
  EXPECT_EQ(read_mesh(file).positions, mesh.positions);
  EXPECT_EQ(referenced_file(name + ".obj", folder), file);
  EXPECT_EQ(read_mesh(referenced_file("K%C3%BCgel%20%E4%B8%AD%20%F0%9F%8C%B3.obj", folder)).positions, mesh.positions);
  fs::remove(file);
  try {
    read_mesh(file);
    ADD_FAILURE() << "was read";
  } catch (const SystemFileError& error) {
    EXPECT_EQ(error.file(), file);
    EXPECT_TRUE(
        std::string(error.what()).ends_with(name + ".obj: there is no such file; check the name and the folder"))
        << error.what();
  }
  EXPECT_NE(FileRoots({folder}).refusal(scratch.path(), "--root").value().find(name + "; allow"), std::string::npos);
  // An archive's arrays are named after it.
  const fs::path archive = folder / (letters + u8".npz");
  std::ofstream(archive, std::ios::binary) << zip({{"positions.npy", npy("<f8", "(1, 1, 3)", std::vector<double>(3))}});
  try {
    const Motion motion(archive, mesh);
    ADD_FAILURE() << "was read";
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find(name + ".npz: positions.npy: "), std::string::npos) << error.what();
  }
}

TEST(FileNames, may_be_longer_than_260_characters) {
  const ScratchFolder scratch;
  const fs::path folder = scratch.path() / std::string(120, 'f') / std::string(120, 'g'), file = folder / "a.obj";
  const Mesh mesh = small_mesh();
  {
    WholeFolder made(folder.parent_path());
    made.commit();
  }
  {
    WholeFolder made(folder);
    write_mesh(made.path() / "a.obj", mesh);
    made.commit();
  }
  EXPECT_EQ(read_mesh(file).positions, mesh.positions);
  write_mesh(file, small_mesh());
  const std::string first = bytes_of(file);
  WholeFolder again(folder);
  write_whole(again.path() / "b.obj", first);
  again.commit();
  EXPECT_EQ(read_mesh(folder / "b.obj").positions, mesh.positions);
  EXPECT_EQ(read_mesh(file).positions, mesh.positions) << "was carried over";
}

}  // namespace
}  // namespace morula::test
