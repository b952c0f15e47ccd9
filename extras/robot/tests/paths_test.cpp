// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Which files a robot's file may name, in all its formats.
#include <gtest/gtest.h>

#include <support/scoped_variable.hpp>

#include "formats.hpp"

namespace morula::test {
namespace {

/// A robot's file of each format that names one mesh, or includes one file.
std::string urdf_naming(const std::string& mesh) {
  return "<robot name='r'><link name='l'><collision><geometry><mesh filename='" + mesh +
         "'/></geometry></collision></link></robot>";
}
std::string sdf_naming(const std::string& mesh) {
  return "<sdf version='1.9'><model name='r'><link name='l'><collision name='c'><geometry><mesh><uri>" + mesh +
         "</uri></mesh></geometry></collision></link></model></sdf>";
}
std::string mjcf_naming(const std::string& mesh, const std::string& compiler = "") {
  return "<mujoco>" + compiler + "<asset><mesh name='m' file='" + mesh +
         "'/></asset><worldbody><body name='l'><geom type='mesh' mesh='m'/></body></worldbody></mujoco>";
}

class Paths : public Formats {
 protected:
  /// The mesh that is found, from the scratch folder on, or what is said instead.
  std::string found(const std::string& robot_file, const std::string& text, const robot::ReadOptions& options = {}) {
    const fs::path file = write(robot_file, text);
    std::string result;
    const std::string refusal = words_of([&] {
      const robot::Robot read = robot::read_robot(file, options);
      for (const robot::Link& link : read.links) {
        for (const robot::Shape& shape : link.collision)
          result += shape.file.lexically_relative(folder.path()).generic_string();
      }
    });
    return refusal.empty() ? result : refusal;
  }
  void link(const std::string& name, const fs::path& target) {
    fs::create_directories((folder.path() / name).parent_path());
    fs::create_symlink(target, folder.path() / name);
  }
  std::string at(const std::string& name) const { return (folder.path() / name).generic_string(); }
  /// The same as the path of a URI, which begins with a slash before a drive, too.
  std::string uri_at(const std::string& name) const { return at(name)[0] == '/' ? at(name) : "/" + at(name); }

  static void expect_outside(const std::string& said, const std::string& what) {
    EXPECT_NE(said.find("lies outside "), std::string::npos) << what << "\n" << said;
    EXPECT_NE(said.find("; allow its folder with the package path "), std::string::npos) << what << "\n" << said;
  }
};

TEST_F(Paths, common_layouts_of_robots_are_read) {
  // A package as it is, with and without package.xml, in a workspace, and below a folder of its name.
  write("one/arm_description/meshes/a.obj", tetrahedron);
  const std::string a = "one/arm_description/meshes/a.obj", urdf = "one/arm_description/urdf/r.urdf";
  EXPECT_EQ(found(urdf, urdf_naming("package://arm_description/meshes/a.obj")), a);
  EXPECT_EQ(found(urdf, urdf_naming("../meshes/a.obj")), a);
  EXPECT_EQ(found(urdf, urdf_naming("package://another_name/meshes/a.obj")), a) << "the folder was renamed";
  EXPECT_EQ(found("one/arm_description/urdf/deep/r.urdf", urdf_naming("package://arm_description/meshes/a.obj")), a);
  expect_outside(found("one/arm_description/urdf/deep/r.urdf", urdf_naming("../../meshes/a.obj")), "two folders above");
  write("one/arm_description/package.xml", "<package/>");
  EXPECT_EQ(found("one/arm_description/urdf/deep/r.urdf", urdf_naming("../../meshes/a.obj")), a) << "a package is one";
  EXPECT_EQ(found("one/arm_description/r.urdf", urdf_naming("meshes/a.obj")), a);
  write("ws/src/hand_description/package.xml", "<package/>");
  write("ws/src/hand_description/meshes/h.obj", tetrahedron);
  EXPECT_EQ(found("ws/src/arm/urdf/r.urdf", urdf_naming("package://hand_description/meshes/h.obj")),
            "ws/src/hand_description/meshes/h.obj");
  // Models of SDF lie side by side, and their file in their own folder.
  write("models/box/model.config", "<model/>");
  write("models/box/meshes/b.obj", tetrahedron);
  for (const char* file : {"models/box/model.sdf", "models/other/model.sdf"}) {
    EXPECT_EQ(found(file, sdf_naming("model://box/meshes/b.obj")), "models/box/meshes/b.obj") << file;
  }
  EXPECT_EQ(found("models/box/model.sdf", sdf_naming("meshes/b.obj")), "models/box/meshes/b.obj");
  // MuJoCo's folders of assets beside that of the model, and what is included from there.
  write("mj/assets/m.obj", tetrahedron);
  EXPECT_EQ(found("mj/xml/r.xml", mjcf_naming("m.obj", "<compiler meshdir='../assets'/>")), "mj/assets/m.obj");
  EXPECT_EQ(found("mj/xml/r.xml", mjcf_naming("m.obj", "<compiler meshdir='../assets/'/>")), "mj/assets/m.obj");
  write("mj/common/compiler.xml", "<mujocoinclude><compiler meshdir='../assets'/></mujocoinclude>");
  EXPECT_EQ(found("mj/xml/r.xml", mjcf_naming("m.obj", "<include file='../common/compiler.xml'/>")), "mj/assets/m.obj");
}

TEST_F(Paths, no_spelling_leads_out_of_the_robots_folders) {
  write("secret/s.obj", tetrahedron);
  write("up/arm/urdf/empty", "");
  const std::string secret = at("secret/s.obj");
  const std::string uri = uri_at("secret/s.obj");
  std::vector<std::string> names{
      secret,
      "file://" + secret,
      "file://localhost" + uri,
      "FILE://" + uri,
      "file:" + uri,
      "../../../secret/s.obj",
      "..//..///../secret/s.obj",
      "x/../../../../secret/s.obj",
      "%2e%2e/%2E%2e/../secret/s.obj",
      "%2e%2e%2f..%2f..%2fsecret%2fs.obj",
      "file://../../../secret/s.obj",
      "file:///" + secret,
  };
#ifndef _WIN32
  names.push_back("/" + secret);  // on Windows this is no file at all
#endif
  for (const std::string& name : names) {
    expect_outside(found("up/arm/urdf/r.urdf", urdf_naming(name)), name);
    expect_outside(found("up/arm/urdf/r.sdf", sdf_naming(name)), name);
    expect_outside(found("up/arm/urdf/r.xml", mjcf_naming(name)), name);
    if (name[0] == '.') {
      expect_outside(found("up/arm/urdf/r.xml",
                           mjcf_naming("s.obj", "<compiler meshdir='" + name.substr(0, name.size() - 6) + "'/>")),
                     name);
    }
  }
  // A package is searched in folders of the robot alone: what is absolute behind its name is not.
  const std::vector<std::string> rests{"x/" + secret,
                                       "x//" + secret,
                                       "/" + secret,
                                       "x/%2F" + secret.substr(1),
                                       "x/..%2f..%2f../secret/s.obj",
                                       "../secret/s.obj",
                                       "%2e%2e/secret/s.obj",
                                       "secret/s.obj",
                                       "./../../../secret/s.obj",
                                       folder.path().filename().string() + "/secret/s.obj"};
  for (const std::string scheme : {"package", "model", "PACKAGE"}) {
    for (const std::string& rest : rests) {
      for (const std::string& text : {urdf_naming(scheme + "://" + rest), sdf_naming(scheme + "://" + rest)}) {
        const std::string said = found("up/arm/urdf/r.urdf", text);
        EXPECT_NE(said.find(": mesh \"" + scheme), std::string::npos) << scheme << "://" << rest << "\n" << said;
      }
    }
  }
}

TEST_F(Paths, slashes_more_than_one_are_one) {
  write("ws/arm/meshes/a.obj", tetrahedron);
  for (const char* name : {"package://arm//meshes/a.obj", "package:///arm/meshes//a.obj",
                           "package://arm/./meshes/a.obj", "package://arm/urdf/../meshes/a.obj", "..//meshes/a.obj"}) {
    EXPECT_EQ(found("ws/arm/urdf/r.urdf", urdf_naming(name)), "ws/arm/meshes/a.obj") << name;
  }
}

TEST_F(Paths, links_are_followed_to_where_they_lead) {
  if (!test::can_make_links()) GTEST_SKIP() << test::no_links;
  write("secret/s.obj", tetrahedron);
  write("ws/arm/meshes/a.obj", tetrahedron);
  link("ws/arm/meshes/inside.obj", "a.obj");
  link("ws/arm/meshes/outside.obj", at("secret/s.obj"));
  link("ws/arm/elsewhere", at("secret"));
  EXPECT_EQ(found("ws/arm/urdf/r.urdf", urdf_naming("../meshes/inside.obj")), "ws/arm/meshes/inside.obj");
  for (const char* name : {"../meshes/outside.obj", "package://arm/meshes/outside.obj", "../elsewhere/s.obj",
                           "package://arm/elsewhere/s.obj", "../elsewhere/../secret/s.obj"}) {
    const std::string said = found("ws/arm/urdf/r.urdf", urdf_naming(name));
    if (std::string(name).find("/../secret") == std::string::npos) {
      expect_outside(said, name);
      EXPECT_NE(said.find("which leads to " + at("secret/s.obj")), std::string::npos) << said;
    } else {
      EXPECT_NE(said.find("is missing"), std::string::npos) << "taken as text: " << said;
    }
  }
  link("ws/arm/urdf/part.xml", at("secret/part.xml"));
  write("secret/part.xml", "<mujocoinclude/>");
  expect_outside(found("ws/arm/urdf/r.xml", mjcf_naming("../meshes/a.obj", "<include file='part.xml'/>")), "include");
  // A robot that is opened through a link has the folders of the place that the link leads to, as workspaces have it.
  write("ws/arm/urdf/real.urdf", urdf_naming("../meshes/a.obj"));
  link("install/share/arm/urdf/linked.urdf", at("ws/arm/urdf/real.urdf"));
  link("install/share/arm/meshes/a.obj", at("ws/arm/meshes/a.obj"));
  EXPECT_EQ(words_of([&] { robot::read_robot(at("install/share/arm/urdf/linked.urdf")); }), "");
}

TEST_F(Paths, folders_that_the_user_names_are_allowed_however_they_are_written) {
  write("secret/s.obj", tetrahedron);
  write("store/hand/h.obj", tetrahedron);
  for (const char* given : {"secret", "secret/", "secret//", "secret/.", "x/../secret"}) {
    const robot::ReadOptions options{.package_paths = {folder.path() / given}};
    EXPECT_EQ(found("up/arm/urdf/r.urdf", urdf_naming(at("secret/s.obj")), options), "secret/s.obj") << given;
    EXPECT_EQ(found("up/arm/urdf/r.urdf", urdf_naming("package://secret/s.obj"), options), "secret/s.obj") << given;
    EXPECT_EQ(found("up/arm/urdf/r.urdf", urdf_naming("s.obj"), options), "secret/s.obj") << given;
    EXPECT_EQ(found("up/arm/urdf/r.xml", mjcf_naming("../../../secret/s.obj"), options), "secret/s.obj") << given;
  }
  EXPECT_EQ(found("up/arm/urdf/r.urdf", urdf_naming("package://hand/h.obj"), {.package_paths = {at("store/")}}),
            "store/hand/h.obj");
  // What the message says is what helps.
  const std::string said = found("up/arm/urdf/r.urdf", urdf_naming(at("secret/s.obj")));
  const std::string option = "the package path ";
  const fs::path remedy = said.substr(said.find(option) + option.size());
  EXPECT_EQ(found("up/arm/urdf/r.urdf", urdf_naming(at("secret/s.obj")), {.package_paths = {remedy}}), "secret/s.obj");
  // A neighbor whose name begins with that of a root is another folder.
  write("secret2/s.obj", tetrahedron);
  expect_outside(found("up/arm/urdf/r.urdf", urdf_naming(at("secret2/s.obj")), {.package_paths = {at("secret")}}), "");
}

TEST_F(Paths, names_are_decoded_and_names_with_percent_signs_are_read) {
  write("ws/arm/my meshes/a b.obj", tetrahedron);
  write("ws/arm/my meshes/50%20.obj", tetrahedron);
  const std::string a = "ws/arm/my meshes/a b.obj";
  for (const std::string& name :
       {std::string("../my%20meshes/a%20b.obj"), std::string("../my meshes/a b.obj"),
        std::string("package://arm/my%20meshes/a%20b.obj"), "file://" + at("ws/arm/my%20meshes/a%20b.obj"),
        "file://localhost" + uri_at("ws/arm/my%20meshes/a%20b.obj"), at("ws/arm/my%20meshes/a%20b.obj")}) {
    EXPECT_EQ(found("ws/arm/urdf/r.urdf", urdf_naming(name)), a) << name;
    EXPECT_EQ(found("ws/arm/urdf/r.sdf", sdf_naming(name)), a) << name;
  }
  EXPECT_EQ(found("ws/arm/urdf/r.xml", mjcf_naming("a%20b.obj", "<compiler meshdir='../my%20meshes'/>")), a);
  EXPECT_EQ(found("ws/arm/urdf/r.urdf", urdf_naming("../my meshes/50%20.obj")), "ws/arm/my meshes/50%20.obj");
  EXPECT_NE(found("ws/arm/urdf/r.urdf", urdf_naming("../my meshes/a b.obj%00.stl")).find("is missing"),
            std::string::npos);
  EXPECT_NE(found("ws/arm/urdf/r.urdf", urdf_naming("../my meshes/%zz%2")).find("is missing"), std::string::npos);
}

TEST_F(Paths, names_of_any_letters_are_read_in_every_format) {
  const auto name_of = [](const char8_t* text) { return std::string(reinterpret_cast<const char*>(text)); };
  const std::string mesh = name_of(u8"größe/меш 網.obj");
  fs::create_directories(folder.path() / fs::path(u8"größe"));
  fs::copy_file(write("plain.obj", tetrahedron), folder.path() / fs::path(u8"größe/меш 網.obj"));
  const auto found_as = [&](const std::string& ending, const std::string& text) {
    const fs::path file = folder.path() / fs::path(u8"rôbot." + std::u8string(ending.begin(), ending.end()));
    fs::copy_file(write("plain." + ending, text), file, fs::copy_options::overwrite_existing);
    const robot::Robot robot = robot::read_robot(file);
    EXPECT_EQ(robot.links.at(0).collision.at(0).file.lexically_relative(folder.path()), fs::path(u8"größe/меш 網.obj"));
    return robot;
  };
  found_as("urdf", urdf_naming(mesh));
  found_as("sdf", sdf_naming(mesh));
  found_as("xml", mjcf_naming(mesh));
  const robot::Robot robot =
      found_as("xml", mjcf_naming(name_of(u8"меш 網.obj"), "<compiler meshdir='" + name_of(u8"größe") + "'/>"));
  EXPECT_EQ(robot.links[0].collision[0].file_name, mesh) << "with slashes";
}

TEST_F(Paths, drive_letters_are_places_on_another_machine) {
  write("ws/arm/meshes/a.obj", tetrahedron);
  write("secret/s.obj", tetrahedron);
  for (const char* name : {"C:/robots/arm/meshes/a.obj", "c:\\robots\\arm\\meshes\\a.obj",
                           "file:///C:/robots/arm/meshes/a.obj", "D:/meshes/a.obj"}) {
    EXPECT_EQ(found("ws/arm/urdf/r.urdf", urdf_naming(name)), "ws/arm/meshes/a.obj") << name;
  }
  for (const char* name : {"C:/../../../secret/s.obj", "C:\\..\\..\\..\\secret\\s.obj", "C:/secret/s.obj"}) {
    const std::string said = found("ws/arm/urdf/r.urdf", urdf_naming(name));
    EXPECT_NE(said.find("is missing"), std::string::npos) << name << "\n" << said;
  }
}

TEST_F(Paths, a_home_folder_is_not_the_surroundings_of_a_file_in_it) {
  write("home/me/private/p.obj", tetrahedron);
#ifdef _WIN32
  const test::ScopedVariable home("USERPROFILE", at("home/me"));
#else
  const test::ScopedVariable home("HOME", at("home/me"));
#endif
  expect_outside(found("home/me/downloads/r.urdf", urdf_naming("../private/p.obj")), "the folder around is home");
  expect_outside(found("home/me/downloads/r.urdf", urdf_naming("package://me/private/p.obj")), "a folder of its name");
  expect_outside(found("home/me/downloads/r.urdf", urdf_naming("package://home/me/private/p.obj")), "home is in it");
  EXPECT_EQ(found("home/me/private/r.urdf", urdf_naming("p.obj")), "home/me/private/p.obj");
}

TEST_F(Paths, files_that_xacro_lists_are_included) {
#ifdef _WIN32
  GTEST_SKIP() << "a script of a shell is no program";
#endif
  const fs::path file = write("x/r.xacro", "<robot name='r' xmlns:xacro='x'>\n<xacro:r/></robot>");
  write("x/expanded.urdf", urdf_naming("m.obj")), write("x/m.obj", tetrahedron);
  const auto included = [&](const std::string& deps) {
    const fs::path program = write("x/program", "#!/bin/sh\nif [ \"$1\" = --deps ]; then\n" + deps + "\nelse cat '" +
                                                    at("x/expanded.urdf") + "'; fi\n");
    fs::permissions(program, fs::perms::owner_all);
    const robot::Robot read = robot::read_robot(file, {.xacro = program.string(), .xacro_arguments = {"a:=b"}});
    EXPECT_EQ(read.links.size(), 1u);
    return read.included;
  };
  const std::vector<fs::path> files{write("x/a  part.xacro", ""), write("x/b.yaml", ""), write("x/c d/e.xacro", "")};
  const std::string three = "'" + files[2].string() + " " + files[0].string() + " " + files[1].string();
  EXPECT_EQ(included("printf '%s' " + three + "'"), files);
  EXPECT_EQ(included("echo " + three + " " + files[1].string() + "'"), files) << "each once";
  EXPECT_EQ(included("echo " + three + " " + at("x/missing") + " " + at("x") + "'"), files)
      << "neither missing nor folders";
  EXPECT_EQ(included("[ \"$2$3\" = '" + file.string() + "a:=b' ] && echo " + three + "'"), files) << "arguments";
  EXPECT_TRUE(included("echo " + three + "'; exit 2").empty()) << "a program without the option";
  EXPECT_TRUE(included("cat '" + at("x/expanded.urdf") + "'").empty()) << "a program that prints the robot";
  EXPECT_TRUE(included("true").empty());
}

}  // namespace
}  // namespace morula::test
