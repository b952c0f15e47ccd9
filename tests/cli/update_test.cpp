// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/update/body.hpp>
#include <support/npy.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// A .npy of doubles.
void write_npy(const Workbench& bench, const std::string& name, const std::string& shape,
               const std::vector<double>& values) {
  bench.write(name, npy("<f8", shape, values));
}

/// limb.obj, limb.morula, modes.npy with two modes, coords.npy with three frames, the first and last at rest.
struct ModalBench : Workbench {
  ModalBench() {
    require("sample limb -o limb.obj --resolution 8");
    require("build limb.obj -o limb.morula --method octree --depth 2");
    mesh = read_mesh(*this / "limb.obj");
    std::vector<double> modes;
    for (const Vec3& p : mesh.positions) modes.insert(modes.end(), {0.0, std::sin(p.x), 0.0});
    for (const Vec3& p : mesh.positions) modes.insert(modes.end(), {p.x, -0.5 * p.y, -0.5 * p.z});
    write_npy(*this, "modes.npy", "(2, " + std::to_string(mesh.vertex_count()) + ", 3)", modes);
    write_npy(*this, "coords.npy", "(3, 2)", {0, 0, 0.7, 0.4, 0, 0});
  }
  Mesh mesh;
};
const std::string modal_model = "--modes modes.npy --coords coords.npy ";

TEST(UpdateCommand, writes_the_spheres_that_the_library_computes) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --depth 2");
  bench.require("deform limb.obj -o motion --stretch 2 --frames 3");
  const Mesh mesh = read_mesh(bench / "limb.obj");
  const CoveredTree model = read_covered_tree(bench / "limb.morula", mesh);
  const Motion motion(bench / "motion", mesh);
  for (const Rule rule : position_rules()) {
    const std::string rule_name(name(rule));
    bench.require("update limb.obj limb.morula motion -o " + rule_name + " --rule " + rule_name);
    Body body(mesh, model, {.rules = {rule}, .details = {}});
    ASSERT_TRUE(body.update(motion.frame(1)));
    const SphereTree read = read_tree(bench / (rule_name + "/0001.sph")).tree;
    EXPECT_EQ(tree_hash(read), tree_hash(body.current_tree())) << rule_name;
    EXPECT_EQ(bench.read(rule_name + "/0000.sph"), bench.read(rule_name + "/0002.sph")) << rule_name;
  }
}

TEST(UpdateCommand, conservative_makes_any_rule_cover_and_is_certified) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --depth 2");
  bench.require("deform limb.obj -o motion.npy --stretch 2 --frames 3");
  const std::string command = "update limb.obj limb.morula motion.npy --rule approach2 --measure --json -o ";
  const auto plain = bench.require(command + "plain").json();
  const auto covering = bench.require(command + "covering --conservative").json();
  EXPECT_TRUE(plain["certificate"].is_null());
  EXPECT_TRUE(covering["certificate"]["covered"].get<bool>());
}

TEST(UpdateCommand, rules_can_be_mixed_by_level_and_the_certificate_follows_the_exact_ones) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --depth 3");
  bench.require("deform limb.obj -o motion.npy --stretch 2 --twist 90 --frames 5");
  const auto mixed =
      bench.require("update limb.obj limb.morula motion.npy -o mixed --rule 0:exact,2:approach2 --json").json();
  EXPECT_EQ(mixed["rule"], "exact on levels 0-1, approach2 on levels 2-3");
  EXPECT_TRUE(mixed["certificate"]["covered"].get<bool>());
  bench.require("update limb.obj limb.morula motion.npy -o exact");
  bench.require("update limb.obj limb.morula motion.npy -o two --rule approach2");
  const SphereTree a = read_tree(bench / "mixed/0002.sph").tree;
  const SphereTree exact = read_tree(bench / "exact/0002.sph").tree;
  const SphereTree two = read_tree(bench / "two/0002.sph").tree;
  ASSERT_EQ(a.level_count(), 4u);
  for (std::uint32_t node = 0; node < a.node_count(); ++node) {
    EXPECT_EQ(a.spheres[node], (a.level_of(node) < 2 ? exact : two).spheres[node]) << node;
  }
  const auto without = bench.require("update limb.obj limb.morula motion.npy -o two --rule approach2 --json").json();
  EXPECT_TRUE(without["certificate"].is_null());
  const auto unchecked = bench.require("update limb.obj limb.morula motion.npy -o exact --no-check --json").json();
  EXPECT_TRUE(unchecked["certificate"].is_null());
}

TEST(UpdateCommand, certifies_that_spheres_of_the_rule_wrapped_contain_their_childrens) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 8");
  bench.require("build limb.obj -o limb.morula --method octree --depth 2 --nested");
  bench.require("deform limb.obj -o motion.npy --stretch 2 --twist 90 --frames 3");
  const std::string command = "update limb.obj limb.morula motion.npy --json -o ";
  const auto wrapped = bench.require(command + "wrapped.npz --rule wrapped --wrapped-center smallest").json();
  EXPECT_TRUE(wrapped["nesting"]["nested"].get<bool>());
  EXPECT_EQ(wrapped["nesting"]["frames_not_nested"], 0);
  EXPECT_TRUE(wrapped["certificate"]["covered"].get<bool>());
  EXPECT_TRUE(SphereFrames(bench / "wrapped.npz").frame(1).nested);
  const auto exact = bench.require(command + "exact.npz").json();
  EXPECT_FALSE(exact.contains("nesting"));
  EXPECT_FALSE(SphereFrames(bench / "exact.npz").frame(1).nested);
  const auto mixed = bench.require(command + "mixed.npz --rule 0:wrapped,1:exact").json();
  EXPECT_TRUE(mixed["nesting"]["nested"].get<bool>());
  EXPECT_FALSE(SphereFrames(bench / "mixed.npz").frame(1).nested) << "not on every level";
  bench.expect_refused("update limb.obj limb.morula motion.npy -o x.npz --rule wrapped --wrapped-center middle",
                       "children, smallest");
}

TEST(UpdateCommand, refuses_rule_lists_that_do_not_fit) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  const auto before = bench.listing();
  for (const char* rule :
       {"1:exact", "0:exact,0:approach2", "0:exact,5:approach2", "exact,approach2", "0:", "x:exact", ""}) {
    const CommandResult result = bench.run(std::string("update bar.obj bar.morula bar.obj -o s --rule '") + rule + "'");
    EXPECT_EQ(result.exit_code, 2) << rule << result.err;
    EXPECT_EQ(result.err.rfind("morula: error: ", 0), 0u) << rule << result.err;
  }
  EXPECT_EQ(bench.listing(), before);
}

TEST(UpdateCommand, details_of_rules_change_the_spheres) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 12");
  bench.require("build limb.obj -o limb.morula --method octree --depth 3");
  bench.require("deform limb.obj -o motion.npy --stretch 2 --twist 90 --frames 2 --one-way");
  const auto spheres = [&](const std::string& options) {
    bench.require("update limb.obj limb.morula motion.npy -o s --rule " + options);
    return bench.read("s/0001.sph");
  };
  const std::string plain1 = spheres("approach1");
  EXPECT_TRUE(spheres("approach1 --approach1-weights uniform --distance-floor 0") == plain1);
  EXPECT_TRUE(spheres("approach1 --approach1-weights area") != plain1);
  EXPECT_TRUE(spheres("approach1 --approach1-weights inverse-distance") != plain1);
  EXPECT_TRUE(spheres("approach1 --approach1-inner-center linked-vertices") != plain1);
  EXPECT_TRUE(spheres("approach1 --distance-floor 0.25") != plain1);
  EXPECT_TRUE(spheres("approach2 --approach2-inner-boxes child-centers") != spheres("approach2"));
  EXPECT_EQ(bench.run("update limb.obj limb.morula motion.npy -o t --approach1-weights heavy").exit_code, 2);
}

TEST(UpdateCommand, bare_trees_are_covered_first_and_the_growth_is_printed) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 6");
  bench.write("bar.sph", "2 2\n0 0 0 3 0\n-1 0 0 1.1 0\n1 0 0 1.1 0\n");
  bench.require("deform bar.obj -o motion --bend 90 --frames 3");
  const CommandResult text = bench.require("update bar.obj bar.sph motion -o spheres");
  EXPECT_NE(text.out.find("Grown so that every level covers the mesh:"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("certificate  holds in every frame"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("over the frames\n    1                      1.06  ███\n"), std::string::npos) << text.out;
  const auto json = bench.require("update bar.obj bar.sph motion -o spheres --json").json();
  EXPECT_EQ(json["growth"]["levels"][0]["grown"], 0);
  EXPECT_EQ(json["growth"]["levels"][1]["grown"], 2);
}

TEST(UpdateCommand, follows_a_modal_model) {
  const ModalBench bench;
  const Modes modes = read_modes(bench / "modes.npy", bench.mesh);
  const std::vector<double> q{0.7, 0.4};
  const std::vector<std::pair<std::string, std::string>> rules{{"", "modal"},
                                                               {"--rule 0:exact,1:modal", "exact on level"},
                                                               {"--rule exact", "exact"},
                                                               {"--modal-bound shift", "modal"}};
  for (const auto& [option, rule] : rules) {
    const auto json = bench.require("update limb.obj limb.morula " + modal_model + "-o s --json " + option).json();
    EXPECT_EQ(json["rule"].get<std::string>().rfind(rule, 0), 0u) << json;
    EXPECT_EQ(json["frames"], 3) << option;
    EXPECT_EQ(json["modes"]["count"], 2) << option;
    EXPECT_TRUE(json["certificate"]["covered"].get<bool>()) << option;
    EXPECT_EQ(bench.read("s/0000.sph"), bench.read("s/0002.sph")) << option;
  }
  bench.require("update limb.obj limb.morula " + modal_model + "-o s");
  Body body(bench.mesh, read_covered_tree(bench / "limb.morula", bench.mesh), {.rules = {Rule::modal}, .modes = modes});
  ASSERT_TRUE(body.update_modal(q));
  EXPECT_EQ(tree_hash(read_tree(bench / "s/0001.sph").tree), tree_hash(body.current_tree()));
}

TEST(UpdateCommand, modal_models_that_do_not_fit_are_refused) {
  const ModalBench bench;
  write_npy(bench, "three.npy", "(1, 3)", {1, 2, 3});
  write_npy(bench, "huge.npy", "(2, 2)", {0, 0, 0, 1e300});
  write_npy(bench, "flat.npy", "(2, 3)", {0, 0, 0, 0, 0, 0});
  const auto before = bench.listing();
  const auto refuse = [&](const std::string& arguments, const std::string& fragment) {
    const CommandResult result = bench.run("update limb.obj limb.morula " + arguments + " -o s");
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_NE(result.err.find(fragment), std::string::npos) << result.err;
    EXPECT_EQ(bench.listing(), before) << arguments;
  };
  refuse("", "MOTION is missing: name positions, or a modal model with --modes and --coords");
  refuse("--modes modes.npy", "add --coords FILE");
  refuse("--coords coords.npy", "add --modes FILE");
  refuse("limb.obj " + modal_model, "both positions (limb.obj) and --modes");
  refuse("limb.obj --rule modal", "--rule modal needs a modal model");
  refuse("--modes modes.npy --coords three.npy", "three.npy: the array's shape is '(1, 3)', but (frames, 2)");
  refuse("--modes modes.npy --coords missing.npy", "missing.npy");
  refuse("--modes flat.npy --coords coords.npy", "flat.npy: the array's shape is '(2, 3)', but (modes, vertices, 3)");
  refuse("--modes modes.npy --coords huge.npy", "huge.npy frame 1: coordinate 1 is not finite, or");
  refuse(modal_model + "--modal-bound exact", "known: gradient, shift");
}

// Two bones that share the vertices of a limb by their place along x; the second turns.
struct SkinBench : ModalBench {
  SkinBench() {
    std::vector<double> weights, transforms;
    skin = {.bone_count = 2, .begin = {0}};
    for (const Vec3& p : mesh.positions) {
      const double share = std::clamp(0.5 + p.x, 0.0, 1.0);
      for (const double weight : {1 - share, share}) weights.push_back(weight);
      for (const std::uint32_t bone : {0u, 1u}) {
        if (weights[weights.size() - 2 + bone] == 0) continue;
        skin.bones.push_back(bone);
        skin.weights.push_back(weights[weights.size() - 2 + bone]);
      }
      skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
    }
    turned.columns = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
    turned.translation = {0.5, 0, 0};
    for (int frame = 0; frame < 2; ++frame)
      for (const double number : {1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.}) transforms.push_back(number);
    for (const double number : {1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.}) transforms.push_back(number);
    for (const double number : {0., -1., 0., 0.5, 1., 0., 0., 0., 0., 0., 1., 0.}) transforms.push_back(number);
    write_npy(*this, "weights.npy", "(" + std::to_string(mesh.vertex_count()) + ", 2)", weights);
    write_npy(*this, "bones.npy", "(2, 2, 3, 4)", transforms);
  }
  Skin skin;
  AffineTransform turned;
};
const std::string skin_model = "--skin weights.npy --transforms bones.npy ";

TEST(UpdateCommand, follows_a_skin_by_any_rule_and_certifies_those_that_cover) {
  const SkinBench bench;
  const auto exact = bench.require("update limb.obj limb.morula " + skin_model + "-o e --json").json();
  EXPECT_EQ(exact["rule"], "exact");
  EXPECT_TRUE(exact["certificate"]["covered"].get<bool>());
  EXPECT_EQ(exact["skin"]["bones"], 2);
  const auto skinned = bench.require("update limb.obj limb.morula " + skin_model + "-o s --rule skinned --json").json();
  EXPECT_EQ(skinned["rule"], "skinned");
  EXPECT_TRUE(skinned["certificate"]["covered"].get<bool>());
  for (const auto& [rule, folder] : {std::pair{Rule::exact, "e"}, std::pair{Rule::skinned, "s"}}) {
    Body body(bench.mesh, read_covered_tree(bench / "limb.morula", bench.mesh), {.rules = {rule}, .skin = bench.skin});
    ASSERT_TRUE(body.update_skinned(std::vector{AffineTransform{}, bench.turned}));
    EXPECT_EQ(tree_hash(read_tree(bench / (std::string(folder) + "/0001.sph")).tree), tree_hash(body.current_tree()));
  }
  const CommandResult text = bench.require("update limb.obj limb.morula " + skin_model + "-o s --rule skinned");
  EXPECT_NE(text.out.find("certificate  holds in every frame"), std::string::npos) << text.out;
}

TEST(UpdateCommand, nodes_of_a_skin_are_measured_within_a_share) {
  const SkinBench bench;
  const std::string call = "update limb.obj limb.morula " + skin_model + "--rule skinned -o s --json";
  const auto alone = bench.require(call).json();
  EXPECT_FALSE(alone["skin"].contains("nodes_measured"));
  EXPECT_EQ(alone["points_tested"], 0);
  const auto measured = bench.require(call + " --measured 0.3").json();
  EXPECT_GT(measured["skin"]["nodes_measured"], 0);
  EXPECT_GT(measured["points_tested"], 0);
  EXPECT_TRUE(measured["certificate"]["covered"].get<bool>());
  UpdateOptions options{.rules = {Rule::skinned}, .skin = bench.skin};
  options.details.skinned_measured = 0.3;
  options.training = {AffineTransform{}, AffineTransform{}, AffineTransform{}, bench.turned};
  Body body(bench.mesh, read_covered_tree(bench / "limb.morula", bench.mesh), options);
  ASSERT_TRUE(body.update_skinned(std::vector{AffineTransform{}, bench.turned}));
  EXPECT_EQ(tree_hash(read_tree(bench / "s/0001.sph").tree), tree_hash(body.current_tree()));
  const CommandResult text =
      bench.require("update limb.obj limb.morula " + skin_model + "-o s --rule skinned --measured 0.3");
  EXPECT_NE(text.out.find("measured     "), std::string::npos) << text.out;
  for (const std::string arguments : {"--measured 0.3", "--rule skinned --measured 1.5", "--rule skinned --measured x"})
    EXPECT_EQ(bench.run("update limb.obj limb.morula " + skin_model + "-o t " + arguments).exit_code, 2) << arguments;
}

TEST(UpdateCommand, skins_that_do_not_fit_are_refused) {
  const SkinBench bench;
  const auto before = bench.listing();
  const auto refuse = [&](const std::string& arguments, const std::string& fragment) {
    const CommandResult result = bench.run("update limb.obj limb.morula " + arguments + " -o s");
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_NE(result.err.find(fragment), std::string::npos) << result.err;
    EXPECT_EQ(bench.listing(), before) << arguments;
  };
  refuse("--skin weights.npy", "add --transforms FILE");
  refuse("--transforms bones.npy", "add --skin FILE");
  refuse("limb.obj " + skin_model, "both positions (limb.obj) and --skin");
  refuse(skin_model + modal_model, "both --modes and --skin");
  refuse("limb.obj --rule skinned", "--rule skinned needs a skin");
  refuse(modal_model + "--rule skinned", "--rule skinned needs a skin");
  refuse(skin_model + "--rule modal", "--rule modal needs a modal model");
  refuse("--skin bones.npy --transforms bones.npy", "(vertices, bones)");
  refuse("--skin weights.npy --transforms coords.npy", "(frames, bones, 3, 4)");
}

TEST(UpdateCommand, all_frames_go_into_one_archive) {
  const ModalBench bench;
  const CommandResult text = bench.require("update limb.obj limb.morula " + modal_model + "-o all.npz");
  EXPECT_NE(text.out.find("written      all.npz\n"), std::string::npos) << text.out;
  const std::string archive = bench.read("all.npz");
  EXPECT_EQ(archive.substr(0, 4), "PK\3\4");
  for (const char* name : {"spheres.npy", "level_begin.npy", "parent.npy", "first_child.npy", "child_count.npy"})
    EXPECT_NE(archive.find(name), std::string::npos) << name;
  bench.require("update limb.obj limb.morula " + modal_model + "-o again.npz --format npz --threads 1");
  EXPECT_TRUE(bench.read("again.npz") == archive);
  const SphereTree tree = read_tree(bench / "limb.morula").tree;
  EXPECT_NE(archive.find("'shape': (3, " + std::to_string(tree.node_count()) + ", 4)"), std::string::npos);

  const auto before = bench.listing();
  for (const std::string output : {"all.npz --format sph", "folder --format npz", "nowhere/all.npz", "s --format xyz"})
    EXPECT_EQ(bench.run("update limb.obj limb.morula limb.obj -o " + output).exit_code, 2) << output;
  EXPECT_EQ(bench.listing(), before);
}

TEST(UpdateCommand, frames_are_measured_as_the_measure_command_does) {
  const ModalBench bench;
  bench.require("deform limb.obj -o motion --stretch 1.5 --frames 3");
  const auto json = bench.require("update limb.obj limb.morula motion -o s --rule approach2 --measure --json").json();
  const auto separate =
      bench.require("measure limb.obj s --motion motion --grid fixed --no-protrusion --json").json()["frames"];
  ASSERT_EQ(json["measured"].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(json["measured"][i]["frame"], separate[i]["frame"]);
    EXPECT_EQ(json["measured"][i]["levels"], separate[i]["levels"]) << i;
  }
  const CommandResult text = bench.require("update limb.obj limb.morula " + modal_model + "-o t --measure");
  EXPECT_NE(text.out.find("coords.npy frame 1"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("Covers: every level covers the whole surface."), std::string::npos) << text.out;
  EXPECT_TRUE(bench.require("update limb.obj limb.morula motion -o s --json").json().count("measured") == 0);
}

TEST(UpdateCommand, a_bad_frame_is_named_and_nothing_is_written) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  bench.require("deform bar.obj -o motion --bend 90 --frames 5");
  std::string text = bench.read("motion/0003.obj");
  text.replace(text.find("v ") + 2, 1, "nan ");
  bench.write("motion/0003.obj", text);
  const auto before = bench.listing();
  const CommandResult result = bench.run("update bar.obj bar.morula motion -o spheres");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("0003.obj"), std::string::npos) << result.err;
  EXPECT_EQ(bench.listing(), before);
}

TEST(UpdateCommand, refuses_a_tree_of_another_mesh) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("sample plate -o other.obj --resolution 4");
  bench.require("build bar.obj -o bar.morula --method octree --depth 1");
  const auto before = bench.listing();
  EXPECT_EQ(bench.run("update other.obj bar.morula other.obj -o spheres").exit_code, 2);
  EXPECT_EQ(bench.listing(), before);
}

}  // namespace
}  // namespace morula::test
