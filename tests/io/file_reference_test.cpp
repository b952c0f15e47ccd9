// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <morula/io/file_reference.hpp>
#include <support/scratch_folder.hpp>

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

}  // namespace
}  // namespace morula::test
