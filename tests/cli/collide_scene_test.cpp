// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/collide/contacts.hpp>
#include <morula/generators/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <numbers>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// A limb that stands, one that bends, and one that comes and goes.
struct SceneBench : Workbench {
  SceneBench() {
    require("sample limb -o limb.obj --resolution 8");
    require("build limb.obj -o limb.morula --method octree --depth 2");
    require("deform limb.obj -o motion --bend 90 --frames 3");
    write("room.json", R"({"bodies": [
      {"name": "floor", "mesh": "limb.obj", "tree": "limb.morula", "static": true, "rotate": [0, 0, 1, 90],
       "translate": [0.2, 0.6, 0]},
      {"name": "limb", "mesh": "limb.obj", "tree": "limb.morula", "motion": "motion", "groups": [0, 3]},
      {"name": "tool", "mesh": "limb.obj", "tree": "limb.morula", "path": [[0, 3, 0], [0.1, 0.3, 0.2], [0, 3, 0]],
       "meets": [3], "weight": 2}]})");
  }
  void refuse(const std::string& scene, const std::string& reason) const {
    write("bad.json", scene);
    expect_refused("collide --scene bad.json", reason);
  }
};

std::size_t row_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(CollideScene, tells_the_contacts_of_every_two_bodies_frame_by_frame) {
  const SceneBench bench;
  const auto json = bench.require("collide --scene room.json --json -o contacts.csv").json();
  ASSERT_EQ(json["frames"].size(), 3u);
  EXPECT_EQ(json["bodies"], (nlohmann::json{"floor", "limb", "tool"}));
  const Mesh mesh = read_mesh(bench / "limb.obj");
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  const Body rest(mesh, model);
  Collider floor(mesh, rest), limb(mesh, rest);
  floor.set_transform(RigidTransform::from_axis({0, 0, 1}, std::numbers::pi / 2, {0.2, 0.6, 0}));
  const std::size_t expected = collide(floor, limb).contacts.size();
  std::size_t contacts = 0;
  for (const std::size_t frame : {0, 2}) {
    const auto& f = json["frames"][frame];
    EXPECT_TRUE(f["finished"]);
    // The tool is far away.
    ASSERT_EQ(f["pairs"].size(), 1u);
    EXPECT_EQ(f["pairs"][0]["a"], "floor");
    EXPECT_EQ(f["pairs"][0]["b"], "limb");
    EXPECT_EQ(f["pairs"][0]["began"], frame == 0);
    EXPECT_EQ(f["pairs"][0]["contacts"], expected);
  }
  // It meets the limb alone, which is of its group.
  const auto& middle = json["frames"][1];
  ASSERT_EQ(middle["pairs"].size(), 2u);
  EXPECT_EQ(middle["pairs"][1]["a"], "limb");
  EXPECT_EQ(middle["pairs"][1]["b"], "tool");
  EXPECT_TRUE(middle["pairs"][1]["began"]);
  EXPECT_EQ(json["frames"][2]["ended"], nlohmann::json::array({middle["pairs"][1]["touch"]}));
  for (const auto& f : json["frames"])
    for (const auto& pair : f["pairs"]) contacts += pair["contacts"].get<std::size_t>();
  EXPECT_EQ(row_count(bench.read("contacts.csv")), 1 + contacts);
  EXPECT_EQ(bench.read("contacts.csv").rfind("frame,a,b,touch,began,finished,node_a,node_b,x,y,z,", 0), 0u);
}

TEST(CollideScene, shows_bodies_and_contacts_on_a_page) {
  const SceneBench bench;
  if (!has_extra("page")) return bench.expect_refused("collide --scene room.json --page room.html", "--page");
  if (!bench.has_page())
    return bench.expect_refused("collide --scene room.json --page room.html",
                                "this morula was built without its page: ");
  bench.expect_refused("collide --scene room.json --page room.json", "pages are written as .html");
  bench.require("collide --scene room.json --page room.html -o contacts.csv");
  const nlohmann::json content = page_manifest(bench.read("room.html"));
  const Mesh mesh = read_mesh(bench / "limb.obj");
  const nlohmann::json& motion = content["motions"][0];
  EXPECT_EQ(motion["facets"], 3 * mesh.facet_count());
  EXPECT_EQ(motion["frames"].size(), 3u);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  EXPECT_EQ(content["scenes"][0]["child_count"].size(), 3 * model.tree.node_count() + 1)
      << "three trees below one root";
  // Rows of the table whose surfaces touch, by frame.
  std::vector<std::size_t> expected(3);
  std::istringstream rows(bench.read("contacts.csv"));
  std::string row;
  std::getline(rows, row);
  while (std::getline(rows, row))
    if (std::stod(row.substr(row.rfind(',') + 1)) > 0) ++expected[std::stoul(row)];
  EXPECT_EQ(content["scenes"][0]["contacts"], nlohmann::json(expected));
  EXPECT_GT(expected[1], expected[0]) << "the tool has come";
}

TEST(CollideScene, keeps_to_a_budget_and_says_which_facets_cross) {
  const SceneBench bench;
  const auto limited = bench.require("collide --scene room.json --budget 300 --json --threads 1").json();
  EXPECT_FALSE(limited["frames"][1]["finished"]);
  for (const auto& frame : limited["frames"]) EXPECT_LE(frame["pair_tests"], 300);
  const auto again = bench.require("collide --scene room.json --budget 300 --json --threads 2").json();
  for (std::size_t f = 0; f < 3; ++f) EXPECT_EQ(again["frames"][f]["pairs"], limited["frames"][f]["pairs"]);
  const auto exact = bench.require("collide --scene room.json --crossings --json -o facets.csv").json();
  std::size_t crossings = 0;
  for (const auto& frame : exact["frames"])
    for (const auto& pair : frame["pairs"]) crossings += pair["facet_pairs"].get<std::size_t>();
  EXPECT_GT(crossings, 0u);
  EXPECT_EQ(row_count(bench.read("facets.csv")), 1 + crossings);
  const auto two = bench.require(
      "collide limb.obj limb.obj --translate-a 0.2,0.6,0 --rotate-a 0,0,1,90 --motion-b motion --crossings --json");
  for (std::size_t f = 0; f < 3; ++f)
    EXPECT_EQ(exact["frames"][f]["pairs"][0]["facet_pairs"], two.json()["frames"][f]["facet_pairs"].size());
  EXPECT_NE(bench.require("collide --scene room.json --budget 300").out.find("ended 3 frames early"),
            std::string::npos);
}

TEST(CollideScene, names_file_key_and_remedy_of_what_it_refuses) {
  const SceneBench bench;
  bench.expect_refused("collide --scene nothing.json", "nothing.json: there is no such file");
  bench.refuse("{", "bad.json: this cannot be read as JSON");
  bench.refuse("[]", "bad.json: give an object with the key \"bodies\"");
  bench.refuse(R"({"bodies": [], "gravity": 1})", "bad.json: there is no key 'gravity'");
  bench.refuse(R"({"bodies": []})", "bad.json: bodies: give a list of bodies");
  const auto body = [&](const std::string& keys, const std::string& reason) {
    bench.refuse(R"({"bodies": [{"mesh": "limb.obj"}, {"mesh": "limb.obj", )" + keys + "}]}",
                 "bad.json: bodies[1]" + reason);
  };
  bench.refuse(R"({"bodies": [7]})", "bad.json: bodies[0]: give an object");
  bench.refuse(R"({"bodies": [{"tree": "limb.morula"}]})", "bad.json: bodies[0]: there is no mesh");
  body(R"("translat": [0, 0, 0])", ": there is no key 'translat'; did you mean 'translate'?");
  body(R"("translate": [0, 1])", ".translate: give 3 numbers");
  body(R"("translate": [0, 1, "x"])", ".translate[2]: give a number");
  body(R"("rotate": [0, 0, 0, 90])", ".rotate: the axis has no direction");
  body(R"("path": [])", ".path: give a list of points");
  bench.refuse(R"({"bodies": [{"mesh": "limb.obj", "weight": 1e999}]})", "bad.json: this cannot be read as JSON");
  body(R"("static": "yes")", ".static: give true or false");
  body(R"("static": true, "motion": "motion")", ".static: a static body has neither motion nor path");
  body(R"("groups": [])", ".groups: a body without a group forms no pair");
  body(R"("groups": [32])", ".groups[0]: groups are the whole numbers from 0 to 31");
  body(R"("meets": [-1])", ".meets[0]: groups are the whole numbers from 0 to 31");
  body(R"("weight": -1)", ".weight: weights are 0 or more");
  body(R"("name": "body 0")", ": there are two bodies of the name 'body 0'");
  bench.refuse(R"({"bodies": [{"mesh": "no.obj"}]})", "no.obj");
  // Files that a scene names lie in its folder, or where the user says.
  std::filesystem::create_directory(bench / "scenes");
  std::filesystem::create_directory(bench / "scenes/frames");
  const bool has_links = can_make_links();
  if (has_links) {
    std::filesystem::create_symlink(bench / "limb.obj", bench / "scenes/link.obj");
    std::filesystem::create_symlink(bench / "limb.obj", bench / "scenes/frames/0.obj");
  }
  std::filesystem::copy_file(bench / "limb.obj", bench / "scenes/a limb.obj");
  const auto scene = [&](const std::string& first, const std::string& more = "") {
    bench.write("scenes/s.json",
                R"({"bodies": [{"mesh": ")" + first + "\"" + more + R"(}, {"mesh": "a%20limb.obj"}]})");
  };
  const std::string limb = (bench / "limb.obj").generic_string();
  for (const std::string& mesh :
       {std::string("../limb.obj"), std::string("%2e%2e/limb.obj"), std::string("link.obj"), limb, "file://" + limb}) {
    if (mesh == "link.obj" && !has_links) continue;
    scene(mesh);
    bench.expect_refused("collide --scene scenes/s.json", "scenes/s.json: bodies[0].mesh: ");
    bench.expect_refused("collide --scene scenes/s.json", "; allow its folder with --root ");
    bench.require("collide --scene scenes/s.json --root .");
  }
  for (const std::string motion : {"frames", "frames/*.obj", "../limb.obj"}) {
    if (motion.starts_with("frames") && !has_links) continue;
    scene("a limb.obj", R"(, "motion": ")" + motion + "\"");
    bench.expect_refused("collide --scene scenes/s.json", "scenes/s.json: bodies[0].motion: ");
  }
  // The remedy allows what was refused, and no more: the folder that the files lie in.
  std::filesystem::create_directory(bench / "far");
  std::filesystem::create_directory(bench / "far/frames");
  std::filesystem::copy_file(bench / "limb.obj", bench / "far/frames/0.obj");
  if (has_links) std::filesystem::create_directory_symlink(bench / "far/frames", bench / "scenes/far");
  for (const std::string& motion :
       {std::string("../far/frames"), std::string("../far/frames/"), std::string("../far/frames/*.obj"),
        std::string("../far/frames/0.obj"), std::string("far"), (bench / "far/frames").generic_string()}) {
    if (motion == "far" && !has_links) continue;
    scene("a limb.obj", R"(, "motion": ")" + motion + "\"");
    const std::string said = bench.run("collide --scene scenes/s.json").err, remedy = "; allow its folder with ";
    const std::size_t begin = said.find(remedy);
    ASSERT_NE(begin, std::string::npos) << motion << ": " << said;
    const std::string option = said.substr(begin + remedy.size(), said.find('\n') - begin - remedy.size());
    EXPECT_EQ(option, "--root " + std::filesystem::canonical(bench / "far/frames").string()) << motion;
    bench.require("collide --scene scenes/s.json " + option);
  }
  bench.expect_refused("collide --scene room.json limb.obj", "bodies, motions and places are named in it");
  bench.expect_refused("collide --scene room.json --carry", "--carry is for two bodies");
  bench.expect_refused("collide --scene room.json --self", "--self and --within are for one or two bodies");
  bench.expect_refused("collide --scene room.json --margin -1", "--margin -1");
  bench.expect_refused("collide --scene room.json -o room.json", "written as .csv");
}

TEST(CollideFeatures, tells_what_crosses_itself_and_what_is_near) {
  const Workbench bench;
  const std::string floor = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", facets = "f 1 2 3\nf 1 3 4\nf 5 6 7\n";
  bench.write("above.obj", floor + "v 0.6 0.2 0.5\nv 0.7 0.2 1.5\nv 0.6 0.3 1.5\n" + facets);
  bench.write("below.obj", floor + "v 0.6 0.2 -0.5\nv 0.7 0.2 0.5\nv 0.6 0.3 0.5\n" + facets);
  bench.write("one.obj", "v 0.6 0.2 -0.5\nv 0.7 0.2 0.5\nv 0.6 0.3 0.5\nf 1 2 3\n");
  const auto self = bench.require("collide above.obj --self --json").json();
  EXPECT_EQ(self["frames"][0]["facet_pairs"], 0);
  bench.require("collide below.obj --self -o self.csv");
  EXPECT_EQ(bench.read("self.csv"),
            "frame,surface_a,surface_b,kind,a0,a1,a2,b0,b1,b2,distance\n0,a,a,ff,0,1,2,4,5,6,\n");
  // The single facet goes through the floor of the first alone; with --self the first crosses itself as well.
  const std::string moved = "collide below.obj one.obj --translate-b 0.05,0.1,0 --json";
  EXPECT_EQ(bench.require(moved + " --self").json()["frames"][0]["facet_pairs"], 2);
  const auto near =
      bench.require("collide above.obj one.obj --translate-b 0,0,1 --within 0.55 --json -o near.csv").json();
  EXPECT_DOUBLE_EQ(near["frames"][0]["least_distance"], 0);
  EXPECT_GT(near["frames"][0]["vertex_facet"], 0);
  EXPECT_NE(bench.read("near.csv").find("0,a,b,"), std::string::npos);
  EXPECT_EQ(bench.require("collide above.obj one.obj --translate-b 0,0,9 --within 0.5 --json")
                .json()["frames"][0]["least_distance"],
            nullptr);
  bench.expect_refused("collide above.obj", "name another one, or add --self");
  bench.expect_refused("collide above.obj --within 1", "add --self, or name the other body");
  bench.expect_refused("collide above.obj --self --within -1", "--within -1 is not a length of 0 or more");
  bench.expect_refused("collide above.obj --self --budget 5", "--budget is for contacts of spheres");
  bench.expect_refused("collide above.obj --self --translate-b 1,0,0", "there is no body B");
  bench.expect_refused("collide", "name two meshes, or give --scene FILE");
}

}  // namespace
}  // namespace morula::test
