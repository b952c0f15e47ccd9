// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/generators/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>
#include <numbers>
#include <set>
#include <tuple>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// Two limbs with trees, one of them with a motion that brings it to the other.
struct CollideBench : Workbench {
  CollideBench() {
    require("sample limb -o limb.obj --resolution 8");
    require("build limb.obj -o limb.morula --method octree --depth 2");
    require("deform limb.obj -o motion --bend 90 --frames 3");
  }
};
const std::string pair = "limb.obj limb.obj --tree-a limb.morula --tree-b limb.morula ";
const std::string beside = "--translate-b 0.2,0.9,0.1 --rotate-b 0,0,1,80 ";

std::size_t line_count(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(CollideCommand, finds_the_contacts_and_facet_pairs_of_the_library) {
  const CollideBench bench;
  const auto json = bench.require("collide " + pair + beside + "--motion-a motion --crossings --json").json();
  const Mesh mesh = read_mesh(bench / "limb.obj");
  const CoveredTree model = read_covered_tree(bench / "limb.morula", mesh);
  Body body_a(mesh, model), body_b(mesh, model);
  Collider a(mesh, body_a), b(mesh, body_b);
  b.set_transform(RigidTransform::from_axis({0, 0, 1}, 80 * std::numbers::pi / 180, {0.2, 0.9, 0.1}));
  const Motion motion(bench / "motion", mesh);
  ASSERT_EQ(json["frames"].size(), motion.frame_count());
  std::size_t contact_count = 0, pair_count = 0;
  for (std::size_t f = 0; f < motion.frame_count(); ++f) {
    const std::vector<Vec3> positions = motion.frame(f);
    ASSERT_TRUE(body_a.update(positions));
    a.set_positions(positions);
    const auto& frame = json["frames"][f];
    const Contacts contacts = collide(a, b);
    ASSERT_EQ(frame["contacts"].size(), contacts.contacts.size());
    using Key = std::tuple<std::uint32_t, std::uint32_t, double>;  // the command asks a query, which has another order
    std::set<Key> expected_contacts, found_contacts;
    for (const Contact& c : contacts.contacts) expected_contacts.emplace(c.node_a, c.node_b, c.depth);
    for (const auto& c : frame["contacts"]) found_contacts.emplace(c["node_a"], c["node_b"], c["depth"]);
    EXPECT_EQ(found_contacts, expected_contacts);
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected, found;
    for (const Crossing& c : brute_force::crossings(a, b)) expected.emplace(c.facet_a, c.facet_b);
    for (const auto& c : frame["facet_pairs"]) found.emplace(c["facet_a"], c["facet_b"]);
    EXPECT_EQ(found, expected);
    EXPECT_TRUE(frame["finished"]);
    contact_count += contacts.contacts.size();
    pair_count += expected.size();
  }
  EXPECT_GT(contact_count, 0u);
  EXPECT_GT(pair_count, 0u);
}

TEST(CollideCommand, stops_where_the_budget_ends_and_says_so) {
  const CollideBench bench;
  const auto all = bench.require("collide " + pair + beside + "--json").json()["frames"][0];
  const auto few = bench.require("collide " + pair + beside + "--budget 100 --json").json()["frames"][0];
  EXPECT_TRUE(all["finished"]);
  EXPECT_FALSE(few["finished"]);
  EXPECT_LE(few["pair_tests"], 100);
  EXPECT_GT(all["pair_tests"], 100);
  const CommandResult text = bench.require("collide " + pair + beside + "--budget 100");
  EXPECT_NE(text.out.find("no crossing is missed"), std::string::npos) << text.out;
  EXPECT_TRUE(bench.require("collide " + pair + beside + "--budget 10s --json").json()["frames"][0]["finished"]);
}

TEST(CollideCommand, carries_fronts_from_frame_to_frame_with_the_same_contacts) {
  const CollideBench bench;
  const auto fresh = bench.require("collide " + pair + beside + "--motion-a motion --json").json();
  const auto carried = bench.require("collide " + pair + beside + "--motion-a motion --carry --json").json();
  for (std::size_t f = 0; f < fresh["frames"].size(); ++f) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected, found;
    for (const auto& c : fresh["frames"][f]["contacts"]) expected.emplace(c["node_a"], c["node_b"]);
    for (const auto& c : carried["frames"][f]["contacts"]) found.emplace(c["node_a"], c["node_b"]);
    EXPECT_EQ(found, expected);
  }
}

TEST(CollideCommand, holds_a_body_in_the_last_frame_of_its_motion) {
  const CollideBench bench;
  bench.require("deform limb.obj -o longer --twist 90 --frames 5");
  const auto json = bench.require("collide " + pair + beside + "--motion-a motion --motion-b longer --json").json();
  ASSERT_EQ(json["frames"].size(), 5u);
  EXPECT_EQ(json["frames"][4]["a"], json["frames"][2]["a"]);
  EXPECT_NE(json["frames"][4]["b"], json["frames"][2]["b"]);
}

TEST(CollideCommand, writes_every_contact_or_facet_pair_as_a_row) {
  const CollideBench bench;
  const auto json = bench.require("collide " + pair + beside + "--crossings --json").json()["frames"][0];
  bench.require("collide " + pair + beside + "-o contacts.csv");
  bench.require("collide " + pair + beside + "--crossings -o pairs.csv");
  EXPECT_EQ(line_count(bench.read("contacts.csv")), 1 + json["contacts"].size());
  EXPECT_EQ(line_count(bench.read("pairs.csv")), 1 + json["facet_pairs"].size());
  const std::string csv = bench.read("contacts.csv");
  const std::string header = csv.substr(0, csv.find('\n')), row = csv.substr(csv.find('\n') + 1);
  EXPECT_EQ(std::count(header.begin(), header.end(), ','),
            std::count(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(row.find('\n')), ','));
}

TEST(CollideCommand, builds_a_tree_where_none_is_given) {
  const CollideBench bench;
  const CommandResult result = bench.require("collide limb.obj limb.obj --translate-b 9,0,0");
  EXPECT_NE(result.out.find("apart"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("no tree given for A and B"), std::string::npos) << result.out;
}

TEST(CollideCommand, names_what_it_refuses_and_writes_nothing) {
  const CollideBench bench;
  const std::vector<std::string> before = bench.listing();
  const std::vector<std::pair<std::string, std::string>> cases{
      {"--budget -5", "--budget '-5'"},
      {"--budget 5parsecs", "--budget '5parsecs'"},
      {"--budget 1.5", "--budget '1.5'"},
      {"--level 7", "levels 0 to 2"},
      {"--margin -1", "--margin -1"},
      {"--margin nan", "--margin"},
      {"--priority depth", "priority"},
      {"--translate-b 1,2", "--translate-b '1,2'"},
      {"--rotate-b 0,0,0,90", "has no direction"},
      {"--rotate-b 5", "0,0,1,90"},
      {"--rule modal", "modal"},
      {"--motion-a none", "none"},
      {"-o contacts.txt", ".csv"},
  };
  for (const auto& [option, words] : cases) {
    const CommandResult result = bench.run("collide " + pair + beside + option + (option[1] == 'o' ? "" : " -o c.csv"));
    EXPECT_EQ(result.exit_code, 2) << option;
    EXPECT_NE(result.err.find(words), std::string::npos) << option << ": " << result.err;
    EXPECT_EQ(bench.listing(), before) << option;
  }
}

}  // namespace
}  // namespace morula::test
