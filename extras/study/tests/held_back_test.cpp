// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body and motions that the study has never seen, by command, without a change of code.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#ifdef MORULA_HAS_GLTF
#include "../../../tests/io/gltf_files.hpp"
#endif
#include "workbench.hpp"

namespace morula::test {
namespace {

constexpr std::size_t rings = 30, sides = 6;

/// Vertex k of a tube along a trefoil knot, which drifts apart along z with t.
Vec3 knot_vertex(std::size_t k, double t) {
  const double u = 2 * std::numbers::pi * static_cast<double>(k / sides) / rings;
  const double v = 2 * std::numbers::pi * static_cast<double>(k % sides) / sides;
  const double out = 2 + std::cos(3 * u) + 0.35 * std::cos(v);
  return {out * std::cos(2 * u), out * std::sin(2 * u),
          (1 + t) * std::sin(3 * u) + 0.35 * std::sin(v) + t * std::cos(u)};
}

std::vector<Vec3> knot_at(double t) {
  std::vector<Vec3> positions;
  for (std::size_t k = 0; k < rings * sides; ++k) positions.push_back(knot_vertex(k, t));
  return positions;
}

/// Two facets for each side of each ring, facing out.
std::vector<std::array<std::size_t, 3>> knot_facets() {
  std::vector<std::array<std::size_t, 3>> facets;
  for (std::size_t i = 0; i < rings; ++i) {
    for (std::size_t j = 0; j < sides; ++j) {
      const std::size_t next = (i + 1) % rings * sides, beside = (j + 1) % sides;
      const std::size_t a = i * sides + j, b = next + j, c = next + beside, d = i * sides + beside;
      facets.push_back({a, b, c});
      facets.push_back({a, c, d});
    }
  }
  return facets;
}

std::string knot_obj(double t) {
  std::string text;
  for (const Vec3& p : knot_at(t))
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (const auto& [a, b, c] : knot_facets())
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " + std::to_string(c + 1) + "\n";
  return text;
}

#ifdef MORULA_HAS_GLTF
/// The knot with one morph target, whose weight rises from 0 to 1 within a second.
std::string knot_gltf() {
  std::vector<float> positions, target;
  const std::vector<Vec3> rest = knot_at(0), moved = knot_at(1);
  for (std::size_t k = 0; k < rest.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      positions.push_back(static_cast<float>(rest[k][axis]));
      target.push_back(static_cast<float>(moved[k][axis] - rest[k][axis]));
    }
  }
  std::vector<std::uint16_t> indices;
  for (const auto& facet : knot_facets())
    for (const std::size_t k : facet) indices.push_back(static_cast<std::uint16_t>(k));
  GltfMaker file;
  const int p = file.floats(positions, "VEC3"), m = file.floats(target, "VEC3"), f = file.shorts(indices, "SCALAR");
  const int times = file.floats({0, 1}, "SCALAR"), weights = file.floats({0, 1}, "SCALAR");
  file.push("meshes",
            {{"primitives", {{{"attributes", {{"POSITION", p}}}, {"indices", f}, {"targets", {{{"POSITION", m}}}}}}}});
  file.push("nodes", {{"mesh", 0}});
  file.push("scenes", {{"nodes", {0}}});
  file.push("animations", {{"samplers", {{{"input", times}, {"output", weights}}}},
                           {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}});
  return file.text();
}
#endif

/// The knot, and its motion as a folder of frames and, where glTF is read, as an animation.
std::string motions_of_knot(const Workbench& bench) {
  bench.write("knot.obj", knot_obj(0));
  std::filesystem::create_directory(bench / "solver");
  for (int i = 0; i <= 6; ++i) bench.write("solver/000" + std::to_string(i) + ".obj", knot_obj(i / 6.0));
#ifdef MORULA_HAS_GLTF
  bench.write("animated.gltf", knot_gltf());
  return "solver,animated.gltf";
#else
  return "solver";
#endif
}

TEST(LongHeldBack, a_body_and_its_own_motions_are_in_every_claim_figure_and_table) {
  const Workbench bench;
  const std::string motions = motions_of_knot(bench);
  const std::string out = bench
                              .require("study --quick --seeds 1 --mesh knot.obj --motion " + motions +
                                       " --depth 2 --branching 4 --frames 4 --resolution 32 -o study")
                              .out;
  const nlohmann::json data = nlohmann::json::parse(bench.read("study/study.json"));
  std::vector<std::string> expected{"stretch 2", "twist 180", "bend 90", "solver"};
  if (motions != "solver") expected.emplace_back("animated");
  EXPECT_EQ(data["settings"]["motions"], expected);
  std::size_t of_paper = 0;
  for (const nlohmann::json& claim : data["claims"]) {
    if (claim["source"] != "paper") continue;
    ++of_paper;
    EXPECT_NE(claim["verdict"], "not decided") << claim["id"];
    EXPECT_NE(claim["place"].get<std::string>().rfind("results, ", 0), std::string::npos) << claim["id"];
    EXPECT_NE(in_one_line(out).find(claim["claim"].get<std::string>() +
                                    " In the paper: " + claim["place"].get<std::string>() + ". "),
              std::string::npos)
        << claim["id"];
  }
  EXPECT_EQ(of_paper, 10u);
  std::map<std::string, std::size_t> cells;
  for (const nlohmann::json& cell : data["cells"]) ++cells[cell["motion"].get<std::string>()];
  for (const std::string& motion : expected) {
    EXPECT_EQ(cells[motion], 4u * 6) << motion << ": trees and rules";
    const std::string word = motion.substr(0, motion.find(' '));
    EXPECT_TRUE(std::filesystem::is_regular_file(bench / ("study/fig2d-" + word + ".svg"))) << motion;
    EXPECT_NE(bench.read("study/rules.csv").find(motion), std::string::npos) << motion;
    for (const nlohmann::json& claim : data["claims"]) {
      if (claim["id"] != "level3-grid") continue;
      EXPECT_NE(claim["numbers"].get<std::string>().find(motion), std::string::npos) << motion;
    }
  }
}

#ifdef MORULA_HAS_GLTF
// Both are the same motion, once as doubles in text and once as floats: frames at equal steps of both are alike.
TEST(LongHeldBack, an_animation_of_gltf_is_measured_as_its_frames_are) {
  const Workbench bench;
  const std::string motions = motions_of_knot(bench);
  bench.require("study --quick --seeds 1 --mesh knot.obj --motion " + motions +
                " --depth 2 --methods grid --rules exact --frames 3 --resolution 32 -o study");
  const nlohmann::json data = nlohmann::json::parse(bench.read("study/study.json"));
  std::map<std::string, std::vector<double>> looseness;
  for (const nlohmann::json& cell : data["cells"])
    for (const nlohmann::json& sample : cell["samples"])
      looseness[cell["motion"].get<std::string>()].push_back(sample["levels"].back()["looseness"].get<double>());
  ASSERT_EQ(looseness["solver"].size(), 3u);
  ASSERT_EQ(looseness["animated"].size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(looseness["animated"][i], looseness["solver"][i], 0.05 * looseness["solver"][i]) << i;
  EXPECT_GT(looseness["solver"][2], 1.05 * looseness["solver"][0]) << "it moves";
}
#endif

}  // namespace
}  // namespace morula::test
