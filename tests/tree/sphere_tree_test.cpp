// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/tree/sphere_tree.hpp>

namespace morula {
namespace {

// root → {a, b, c}; a is a leaf, b → {d}, c → {e, f}.
SphereTree small_tree() {
  SphereTree tree;
  tree.branching = 3;
  const auto sphere = [](double x, double r) { return Sphere{{x, 0, 0}, r}; };
  tree.append_level({}, std::vector<Sphere>{sphere(0, 4)});
  tree.append_level(std::vector<std::uint32_t>{3}, std::vector<Sphere>{sphere(-2, 1), sphere(0, 1), sphere(2, 1)});
  tree.append_level(std::vector<std::uint32_t>{0, 1, 2},
                    std::vector<Sphere>{sphere(0, 0.5), sphere(2, 0.5), sphere(3, 0.5)});
  return tree;
}

TEST(SphereTree, appended_levels_keep_siblings_adjacent_and_know_their_parents) {
  const SphereTree tree = small_tree();
  EXPECT_TRUE(validate(tree).empty());
  EXPECT_EQ(tree.level_count(), 3u);
  EXPECT_EQ(tree.leaf_count(), 4u);
  EXPECT_EQ(tree.first_child, (std::vector<std::uint32_t>{1, no_node, 4, 5, no_node, no_node, no_node}));
  EXPECT_EQ(tree.parent, (std::vector<std::uint32_t>{no_node, 0, 0, 0, 2, 3, 3}));
  EXPECT_EQ(tree.level_of(0), 0u);
  EXPECT_EQ(tree.level_of(3), 1u);
  EXPECT_EQ(tree.level_of(6), 2u);
}

TEST(SphereTree, level_sets_hold_the_leaves_that_ended_above) {
  const SphereTree tree = small_tree();
  EXPECT_EQ(level_set(tree, 0), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(level_set(tree, 1), (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(level_set(tree, 2), (std::vector<std::uint32_t>{1, 4, 5, 6}));
  EXPECT_EQ(level_set_spheres(tree, 2)[0], tree.spheres[1]);
  EXPECT_THROW(level_set(tree, 3), std::invalid_argument);
  EXPECT_THROW(level_set_spheres(tree, 3), std::invalid_argument);
  EXPECT_THROW(level_set_spheres(tree, std::span(tree.spheres).first(2), 1), std::invalid_argument);
  EXPECT_THROW(level_set(SphereTree{}, 0), std::invalid_argument);
}

TEST(SphereTree, validate_names_each_broken_invariant) {
  const auto faults_of = [](auto spoil) {
    SphereTree tree = small_tree();
    spoil(tree);
    std::string all;
    for (const std::string& f : validate(tree)) all += f + "\n";
    return all;
  };
  const auto mentions = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.branching = 1; }), "branching 1"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.branching = 2; }), "more than the branching"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t = SphereTree{}; }), "no nodes"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.parent.pop_back(); }), "differ in length"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.level_begin.back() = 6; }), "level_begin"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.level_begin[1] = 2; }), "single root"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.level_begin[2] = 1; }), "level 1 is empty"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.parent[0] = 3; }), "the root has a parent"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.spheres[2].radius = -1; }), "node 2 has a negative radius"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.spheres[2].center.y = NAN; }), "node 2 has a number"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.first_child[3] = 4; }), "node 3 are not where"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.first_child[1] = 4; }), "node 1 is a leaf with"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.parent[5] = 2; }), "node 5 does not name node 3"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.child_count[3] = 1; }), "some nodes have no parent"));
  EXPECT_TRUE(mentions(faults_of([](SphereTree& t) { t.level_begin = {0, 1, 5, 7}; }), "not on the next level"));
}

TEST(SphereTree, hash_sees_every_array) {
  const std::uint64_t hash = tree_hash(small_tree());
  EXPECT_EQ(hash, tree_hash(small_tree()));
  SphereTree other = small_tree();
  other.spheres[6].radius += 1e-16;
  EXPECT_NE(hash, tree_hash(other));
  other = small_tree();
  other.parent[6] = 2;
  EXPECT_NE(hash, tree_hash(other));
}

}  // namespace
}  // namespace morula
