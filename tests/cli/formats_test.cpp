// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The table of formats, and what goes from one of them to another.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "../io/solid_files.hpp"
#include "workbench.hpp"

namespace morula::test {
namespace {

std::string page(const std::string& name) {
  std::ifstream file(std::filesystem::path(MORULA_PAGES) / name);
  return {std::istreambuf_iterator<char>(file), {}};
}

using Row = std::tuple<std::string, bool, bool, std::string>;

TEST(FormatsCommand, prints_the_table_of_the_page) {
  const Workbench bench;
  const nlohmann::json printed = bench.require("formats --json").json();
  std::set<Row> rows, documented;
  for (const nlohmann::json& row : printed["formats"]) {
    rows.emplace(row["extension"], row["read"].get<bool>(), row["written"].get<bool>(), row["for"]);
  }
  std::istringstream lines(page("docs/reference/formats.md"));
  const std::regex line_of_table("^\\| (`\\..*?) \\| (yes|no) \\| (yes|no) \\| (.*) \\|$"),
      extension("`(\\.[a-z0-9]+)`");
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, line_of_table)) continue;
    const std::string names = match[1];
    for (std::sregex_iterator at(names.begin(), names.end(), extension), end; at != end; ++at) {
      documented.emplace((*at)[1], match[2] == "yes", match[3] == "yes", match[4]);
    }
  }
  EXPECT_EQ(rows, documented);
  EXPECT_GT(rows.size(), 25u);
  if (has_extra("grains")) {
    EXPECT_EQ(printed["commands"]["clump"].size(), 5u);
  }
  const std::string text = bench.require("formats").out;
  for (const Row& row : rows) EXPECT_NE(text.find(std::get<0>(row) + " "), std::string::npos) << std::get<0>(row);
}

TEST(FormatsCommand, what_it_calls_written_meshes_is_written_and_read_back) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  const nlohmann::json printed = bench.require("formats --json").json();
  for (const nlohmann::json& row : printed["formats"]) {
    if (row["for"] != "meshes") continue;
    const std::string name = "out" + row["extension"].get<std::string>();
    if (row["written"].get<bool>()) {
      bench.require("convert bar.obj " + name);
      EXPECT_EQ(bench.require("info " + name + " --json").json()["facets"],
                bench.require("info bar.obj --json").json()["facets"]);
    } else {
      bench.expect_refused("convert bar.obj " + name, "meshes are written as");
    }
  }
}

TEST(ConvertSolids, surface_of_a_solid_with_a_map_of_its_points) {
  const Workbench bench;
  const Solid solid = tetrahedral_cube(3);
  bench.write("cube.msh", gmsh_4(solid, true));
  bench.require("convert cube.msh skin.obj --used-only --index-map map.csv");
  std::istringstream skin(bench.read("skin.obj")), map(bench.read("map.csv"));
  std::string line;
  std::getline(map, line);
  EXPECT_EQ(line, "vertex,index");
  std::size_t count = 0;
  while (std::getline(map, line)) {
    std::size_t vertex = 0, index = 0;
    char comma = 0;
    std::istringstream(line) >> vertex >> comma >> index;
    EXPECT_EQ(vertex, count++);
    char v = 0;
    Vec3 p;
    std::string text;
    std::getline(skin, text);
    std::istringstream(text) >> v >> p.x >> p.y >> p.z;
    EXPECT_EQ(v, 'v');
    EXPECT_EQ(p, solid.points.at(index));
  }
  EXPECT_EQ(count, 56u);
  bench.require("build skin.obj -o skin.morula --method octree --depth 1");
  bench.expect_refused("convert cube.msh b.obj --index-map b.csv", "--index-map belongs to --used-only");
  bench.expect_refused("convert skin.morula b.sph --used-only", "--used-only belongs to meshes");
}

TEST(ConvertMotions, from_one_kind_to_another) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("deform bar.obj -o motion.npy --bend 40 --frames 3");
  bench.require("convert motion.npy a.pc2 --mesh bar.obj");
  bench.require("convert a.pc2 b.mdd --mesh bar.obj");
  bench.require("convert b.mdd c.pc2 --mesh bar.obj");
  EXPECT_EQ(bench.read("a.pc2"), bench.read("c.pc2"));
  bench.require("convert b.mdd frames --mesh bar.obj");
  bench.require("convert frames d.pc2 --mesh bar.obj");
  EXPECT_EQ(bench.read("a.pc2"), bench.read("d.pc2"));
  bench.require("deform bar.obj -o e.pc2 --bend 40 --frames 3");
  EXPECT_EQ(bench.read("a.pc2"), bench.read("e.pc2"));
  bench.expect_refused("convert a.pc2 x.npy", "add --mesh MESH");
  bench.expect_refused("convert a.pc2 x.obj --mesh bar.obj", "motions are written as");
}

TEST(SofaFiles, spheres_of_a_level_and_a_scene_that_names_what_there_is) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --method octree --depth 2");
  bench.require("convert limb.morula limb.sph --sofa");
  bench.require("convert limb.morula one.sph --sofa --level 0");
  EXPECT_EQ(bench.read("one.sph").rfind("sph 1.0\nnums 1\nsphe 0 ", 0), 0u);
  bench.expect_refused("convert limb.morula x.sph --sofa --level 9", "has levels 0 to");
  bench.expect_refused("convert limb.morula x.json --sofa", "SOFA loads spheres from .sph");
  bench.expect_refused("convert limb.obj x.sph --sofa", "--sofa writes the spheres of a tree");
  bench.expect_refused("convert limb.morula x.sph --level 1", "--level belongs to --sofa");

  // The scene, by the rules of XML: tags are closed in order, and links lead to what has that name and that data.
  std::string scene = page("examples/sofa/limb.scn");
  scene = std::regex_replace(scene, std::regex("<!--[\\s\\S]*?-->|<\\?[\\s\\S]*?\\?>"), "");
  const std::regex tag("<(/?)([A-Za-z]+)((?:\\s+[A-Za-z]+=\"[^\"]*\")*)\\s*(/?)>"),
      attribute("([A-Za-z]+)=\"([^\"]*)\"");
  std::vector<std::string> open;
  std::map<std::string, std::string> type_of_name;
  std::vector<std::pair<std::string, std::string>> links;
  for (std::sregex_iterator at(scene.begin(), scene.end(), tag), end; at != end; ++at) {
    const std::string name = (*at)[2], attributes = (*at)[3];
    if ((*at)[1] == "/") {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(open.back(), name);
      open.pop_back();
      continue;
    }
    if ((*at)[4] != "/") open.push_back(name);
    for (std::sregex_iterator a(attributes.begin(), attributes.end(), attribute); a != std::sregex_iterator(); ++a) {
      if ((*a)[1] == "name") type_of_name[(*a)[2]] = name;
      const std::string value = (*a)[2];
      if (value[0] == '@') links.emplace_back(value.substr(value.find_last_of("@/") + 1), name + " " + (*a)[1].str());
    }
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(std::regex_replace(scene, tag, "").find_first_not_of(" \n"), std::string::npos);
  const std::map<std::string, std::string> expected{{"cover.position", "MechanicalObject position"},
                                                    {"cover.listRadius", "SphereCollisionModel listRadius"},
                                                    {"nodes", "BarycentricMapping input"},
                                                    {"centers", "BarycentricMapping output"}};
  for (const auto& [target, user] : links) {
    EXPECT_TRUE(type_of_name.count(target.substr(0, target.find('.')))) << target;
    if (expected.count(target) != 0) {
      EXPECT_EQ(expected.at(target), user);
    }
  }
  EXPECT_EQ(type_of_name["cover"], "SphereLoader");
  EXPECT_EQ(links.size(), 6u);
}

TEST(ConvertToScene, spheres_of_all_frames_as_gltf) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  bench.require("deform bar.obj -o motion --bend 40 --frames 3");
  bench.require("update bar.obj bar.morula motion -o spheres.npz");
  const std::string said = bench.require("convert spheres.npz spheres.glb --level 1 --fps 5").out;
  EXPECT_NE(said.find("spheres in 3 frames"), std::string::npos) << said;
  const std::string file = bench.read("spheres.glb");
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_NE(file.find("\"max\":[0.4]"), std::string::npos);  // two steps of a fifth of a second
  bench.require("convert spheres.npz one.glb --frame 1");
  EXPECT_EQ(bench.read("one.glb").find("animations"), std::string::npos);
  bench.require("convert bar.morula rest.glb");
  bench.expect_refused("convert spheres.npz x.glb --level 7", "has levels 0 to 1");
  bench.expect_refused("convert bar.obj x.glb", "meshes are written as");
}

TEST(ParaviewCommand, writes_surface_spheres_and_contacts_of_every_frame) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.require("build bar.obj -o bar.morula --method octree --depth 2");
  bench.require("deform bar.obj -o motion --bend 60 --frames 3");
  const nlohmann::json report =
      bench.require("paraview bar.obj bar.morula motion -o out --level 1 --fps 10 --json").json();
  EXPECT_EQ(report["frames"], 3);
  EXPECT_EQ(report["uncovered_facets"], 0);
  EXPECT_EQ(report["files"], nlohmann::json({"surface.pvd", "spheres.pvd"}));
  const std::string pvd = bench.read("out/surface.pvd");
  for (const char* words : {"timestep=\"0\"", "timestep=\"0.1\"", "timestep=\"0.2\"", "file=\"surface_0002.vtp\""})
    EXPECT_NE(pvd.find(words), std::string::npos) << pvd;
  // The surface of a frame is the mesh of that frame: it reads back.
  bench.require("convert out/surface_0001.vtp frame.obj");
  EXPECT_EQ(bench.read("frame.obj"), bench.read("motion/0001.obj"));
  bench.require(
      "collide bar.obj bar.obj --tree-a bar.morula --tree-b bar.morula --translate-b 0,0.5,0 -o contacts.csv");
  const nlohmann::json with = bench.require("paraview bar.obj -o out --contacts contacts.csv --json").json();
  EXPECT_EQ(with["files"], nlohmann::json({"surface.pvd", "contacts.pvd"}));
  EXPECT_TRUE(with["spheres"].is_null());
  EXPECT_NE(bench.read("out/contacts_0000.vtp").find("Name=\"depth\""), std::string::npos);
  // Spheres that do not cover leave facets bare.
  bench.write("small.json", R"({"format":"morula spheres","version":1,"branching":8,"levels":1,"nodes":[)"
                            R"({"center":[0,0,0],"radius":0.6,"children":[]}]})");
  EXPECT_GT(bench.require("paraview bar.obj small.json -o bare --json").json()["uncovered_facets"], 0);
  bench.expect_refused("paraview bar.obj bar.morula -o out --level 7", "the tree has levels 0 to 2");
  bench.expect_refused("paraview bar.obj -o out --level 1", "--level belongs to a tree");
  bench.expect_refused("paraview bar.obj -o out --contacts bar.obj", "has no column x");
  bench.expect_refused("paraview bar.obj -o bar.obj", "is a file; name a folder");
}

}  // namespace
}  // namespace morula::test
