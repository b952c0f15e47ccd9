// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The command that writes the page; what the page does is tested in tests/viewer.
#include <gtest/gtest.h>

#include <algorithm>

#include "workbench.hpp"

namespace morula::test {
namespace {

constexpr std::size_t megabyte = 1'000'000;

/// A build without its page has none to test; that it says why, and what to do, is tested then.
struct ViewCommand : ::testing::Test {
  void SetUp() override {
    if (!bench.has_page()) {
      const std::string command = "view no.obj no.morula -o no.html";
      bench.expect_refused(command, "this morula was built without its page: ");
      GTEST_SKIP() << bench.run(command).err;
    }
    bench.require("sample torus -o probe.obj --resolution 12");
    bench.require("build probe.obj -o probe.morula --method octree --depth 1");
  }
  const Workbench bench{};
};

TEST_F(ViewCommand, writes_one_page_with_everything_in_it) {
  bench.require("sample limb -o limb.obj --resolution 16");
  bench.require("build limb.obj -o limb.morula --method grid --depth 2");
  bench.require("deform limb.obj -o bend --bend 90 --frames 5");
  const nlohmann::json report =
      bench.require("view limb.obj limb.morula bend -o limb.html --rule exact --rule approach2 --json").json();
  const std::string page = bench.read("limb.html");
  EXPECT_EQ(report["bytes"], page.size());
  EXPECT_EQ(report["frames"], 5);
  EXPECT_EQ(report["rules"], (std::vector<std::string>{"exact", "approach2"}));

  const nlohmann::json content = page_manifest(page);
  EXPECT_EQ(content["motions"].size(), 1u) << "two rules share one motion";
  ASSERT_EQ(content["scenes"].size(), 2u);
  const nlohmann::json& exact = content["scenes"][0]["measured"]["uncovered_area"];
  const nlohmann::json& approach2 = content["scenes"][1]["measured"]["uncovered_area"];
  ASSERT_EQ(exact.size(), 3u) << "levels";
  double bare = 0;
  for (std::size_t level = 0; level < 3; ++level) {
    ASSERT_EQ(exact[level].size(), 5u) << "frames";
    for (std::size_t frame = 0; frame < 5; ++frame) {
      EXPECT_EQ(exact[level][frame], 0.0);
      bare = std::max(bare, approach2[level][frame].get<double>());
    }
  }
  EXPECT_GT(bare, 0);
  // Nothing is fetched: no address but those that name an XML language or stand in a comment of what is bundled.
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("<link rel=\"stylesheet\""), std::string::npos);
  EXPECT_EQ(page.find("@import"), std::string::npos);
}

TEST_F(ViewCommand, same_bytes_for_any_number_of_threads) {
  bench.require("sample torus -o torus.obj --resolution 16");
  bench.require("build torus.obj -o torus.morula --method grid --depth 2");
  bench.require("deform torus.obj -o twist.npy --twist 60 --frames 4");
  bench.require("view torus.obj torus.morula twist.npy -o one.html --threads 1");
  bench.require("view torus.obj torus.morula twist.npy -o three.html --threads 3");
  EXPECT_EQ(bench.read("one.html"), bench.read("three.html"));
}

TEST_F(ViewCommand, takes_bare_trees_open_meshes_and_bodies_at_rest) {
  bench.require("convert probe.morula probe.sph");
  bench.require("view probe.obj probe.sph -o sph.html");
  bench.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 2 4 3\n");
  bench.require("build open.obj -o open.morula --method grid --depth 1");
  bench.require("view open.obj open.morula -o open.html");
  const nlohmann::json scene = page_manifest(bench.read("open.html"))["scenes"][0];
  EXPECT_EQ(scene["empty_share"], false) << "an open mesh has no inside";
  EXPECT_TRUE(scene["measured"]["looseness"][0][0].is_null());
  EXPECT_EQ(scene["measured"]["uncovered_area"][0][0], 0.0);
}

/// 86,490 facets, 25 frames, up to 585 spheres: what a page has to hold in 25 MB.
TEST_F(ViewCommand, a_large_body_in_25_frames_stays_under_25_megabytes) {
  bench.require("sample limb -o limb.obj --resolution 186");
  bench.require("build limb.obj -o limb.morula --method octree --depth 3");
  bench.require("deform limb.obj -o bend.npy --bend 90 --frames 25");
  const nlohmann::json report =
      bench.require("view limb.obj limb.morula bend.npy -o limb.html --no-measure --json").json();
  EXPECT_GE(report["facets"], 86'000);
  EXPECT_LT(report["bytes"], 25 * megabyte);
}

TEST_F(ViewCommand, text_from_outside_stays_text) {
  bench.write("study.json",
              R"({"claims": [{"id": "a", "claim": "</script><script>alert(1)</script>"}], "figures": []})");
  bench.require("view probe.obj probe.morula -o study.html --study study.json --title '</title><b>'");
  const std::string page = bench.read("study.html");
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("</title><b>"), std::string::npos);
  EXPECT_EQ(page_manifest(page)["study"]["claims"][0]["claim"], "</script><script>alert(1)</script>");
}

TEST_F(ViewCommand, refuses_bad_input_and_writes_nothing) {
  bench.require("sample limb -o other.obj --resolution 8");
  bench.write("broken.json", "{");
  const std::vector<std::string> before = bench.listing();
  const std::vector<std::pair<std::string, std::string>> cases{
      {"view probe.obj probe.morula -o page.pdf", ".html"},
      {"view probe.obj probe.morula -o nowhere/page.html", "no folder"},
      {"view other.obj probe.morula -o page.html", "probe.morula"},
      {"view probe.obj probe.morula other.obj -o page.html", "other.obj"},
      {"view probe.obj probe.morula missing -o page.html", "missing"},
      {"view probe.obj probe.morula -o page.html --rule exakt", "did you mean"},
      {"view probe.obj probe.morula -o page.html --rule modal", "modal"},
      {"view probe.obj probe.morula -o page.html --rule 0:exact,5:approach2", "levels 0 to 1"},
      {"view probe.obj probe.morula -o page.html --study broken.json", "broken.json"},
  };
  for (const auto& [arguments, reason] : cases) {
    const CommandResult result = bench.run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << '\n' << result.err;
    EXPECT_NE(result.err.find(reason), std::string::npos) << arguments << '\n' << result.err;
    EXPECT_EQ(bench.listing(), before) << arguments;
  }
}

TEST_F(ViewCommand, shows_a_modal_model) {
  bench.require("sample limb -o limb.obj --resolution 12");
  bench.require("build limb.obj -o limb.morula --method octree --depth 1");
  bench.require("sample limb-modes -o modes.npy --resolution 12");
  bench.require("sample limb-coords -o coords.npy");
  const auto json =
      bench.require("view limb.obj limb.morula --modes modes.npy --coords coords.npy -o limb.html --no-measure --json")
          .json();
  const auto page = page_manifest(bench.read("limb.html"));
  EXPECT_EQ(page["motions"][0]["name"], "coords.npy");
  EXPECT_EQ(page["motions"][0]["frames"].size(), json["frames"].get<std::size_t>());
  EXPECT_GT(json["frames"].get<std::size_t>(), 1U);
  // The box of all frames is larger than that of the body at rest: it moves.
  bench.require("view limb.obj limb.morula -o rest.html --no-measure");
  EXPECT_NE(page["motions"][0]["step"], page_manifest(bench.read("rest.html"))["motions"][0]["step"]);
  for (const char* wrong :
       {"--modes modes.npy", "--coords coords.npy", "limb.obj --modes modes.npy --coords coords.npy"})
    EXPECT_EQ(bench.run(std::string("view limb.obj limb.morula ") + wrong + " -o x.html").exit_code, 2) << wrong;
}

}  // namespace
}  // namespace morula::test
