// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The C interface: the answers of the C++ one, bit for bit; faults come back as codes with words.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <cstddef>
#include <cstring>
#include <limits>
#include <morula/collide/contacts.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/scene/scene.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/update/body.hpp>
#include <support/scratch_folder.hpp>
#include <thread>
#include <vector>

namespace morula {
namespace {

struct Handles {
  morula_mesh* mesh = nullptr;
  morula_model* model = nullptr;
  morula_body *a = nullptr, *b = nullptr;

  Handles() {
    EXPECT_EQ(morula_mesh_sample("limb", 12, &mesh), MORULA_OK) << morula_message();
    morula_build_options options;
    morula_build_options_init(&options);
    options.method = "octree";
    EXPECT_EQ(morula_build(mesh, &options, &model), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_body_create(mesh, model, nullptr, &a), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_body_create(mesh, model, nullptr, &b), MORULA_OK) << morula_message();
  }
  ~Handles() {
    // Bodies keep what they need, so the order does not matter.
    morula_mesh_destroy(mesh);
    morula_model_destroy(model);
    morula_body_destroy(a);
    morula_body_destroy(b);
  }
  Handles(const Handles&) = delete;
  Handles& operator=(const Handles&) = delete;
};

std::vector<Vec3> bent(const Mesh& mesh) {
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p.z += 0.1 * p.x * p.x;
  return positions;
}

constexpr double upright[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

TEST(CInterface, gives_the_bits_of_the_other_one) {
  const Handles c;
  const Mesh mesh = sample_body("limb", 12);
  ASSERT_EQ(morula_mesh_vertex_count(c.mesh), mesh.vertex_count());
  ASSERT_EQ(morula_mesh_facet_count(c.mesh), mesh.facet_count());
  EXPECT_EQ(std::memcmp(morula_mesh_positions(c.mesh), mesh.positions.data(), mesh.vertex_count() * sizeof(Vec3)), 0);
  EXPECT_EQ(std::memcmp(morula_mesh_facets(c.mesh), mesh.facets.data(), mesh.facet_count() * sizeof(Facet)), 0);

  const CoveredTree model = build(mesh, {.method = Method::octree});
  const std::size_t nodes = model.tree.node_count();
  ASSERT_EQ(morula_model_node_count(c.model), nodes);
  EXPECT_EQ(morula_model_level_count(c.model), model.tree.level_count());
  EXPECT_EQ(morula_model_leaf_count(c.model), model.tree.leaf_count());
  EXPECT_EQ(std::memcmp(morula_model_spheres(c.model), model.tree.spheres.data(), nodes * sizeof(Sphere)), 0);
  for (std::size_t n = 0; n < nodes; ++n) {
    EXPECT_EQ(morula_model_first_child(c.model)[n], model.tree.first_child[n]);
    EXPECT_EQ(morula_model_child_count(c.model)[n], model.tree.child_count[n]);
    EXPECT_EQ(morula_model_parent(c.model)[n], model.tree.parent[n]);
  }
  for (std::size_t level = 0; level < model.tree.level_count(); ++level) {
    const std::vector<std::uint32_t> set = level_set(model.tree, level);
    std::size_t count = 0;
    ASSERT_EQ(morula_model_level_set(c.model, level, nullptr, 0, &count), MORULA_OK);
    ASSERT_EQ(count, set.size());
    std::vector<std::uint32_t> got(count);
    ASSERT_EQ(morula_model_level_set(c.model, level, got.data(), count, &count), MORULA_OK);
    EXPECT_EQ(got, set);
  }

  Body a(mesh, model), b(mesh, model);
  const std::vector<Vec3> positions = bent(mesh);
  ASSERT_TRUE(a.update(positions));
  ASSERT_EQ(morula_body_update_double(c.a, &positions[0].x, positions.size(), 0), MORULA_OK) << morula_message();
  std::vector<Sphere> spheres(nodes);
  ASSERT_EQ(morula_body_spheres(c.a, reinterpret_cast<morula_sphere*>(spheres.data())), MORULA_OK);
  for (std::uint32_t n = 0; n < nodes; ++n) EXPECT_EQ(spheres[n], a.sphere(n)) << n;
  int covered = 0;
  ASSERT_EQ(morula_body_certify(c.a, &positions[0].x, positions.size(), &covered), MORULA_OK);
  EXPECT_EQ(covered, 1);

  Collider first(mesh, a), second(mesh, b);
  for (const double height : {0.0, 0.6, 1.4, 3.0}) {
    const double translation[3] = {0, 0, height};
    ASSERT_EQ(morula_body_set_transform(c.b, upright, translation), MORULA_OK);
    second.set_transform({.translation = {0, 0, height}});
    int overlaps = -1;
    ASSERT_EQ(morula_overlap(c.a, c.b, &overlaps), MORULA_OK) << morula_message();
    EXPECT_EQ(overlaps == 1, overlap(first, second));

    morula_contacts* contacts = nullptr;
    ASSERT_EQ(morula_contacts_create(&contacts), MORULA_OK);
    for (const std::int64_t budget : {-1, 0, 50}) {
      morula_contact_options options;
      morula_contact_options_init(&options);
      options.pair_tests = budget;
      options.margin = 0.01;
      ASSERT_EQ(morula_collide(c.a, c.b, &options, contacts), MORULA_OK) << morula_message();
      CollideOptions same{.margin = 0.01};
      if (budget >= 0) same.budget = budget;
      const Contacts expected = collide(first, second, same);
      ASSERT_EQ(morula_contacts_count(contacts), expected.contacts.size());
      EXPECT_EQ(morula_contacts_finished(contacts) != 0, expected.finished);
      for (std::size_t i = 0; i < expected.contacts.size(); ++i) {
        const morula_contact& got = morula_contacts_data(contacts)[i];
        const Contact& want = expected.contacts[i];
        EXPECT_EQ(got.node_a, want.node_a);
        EXPECT_EQ(got.node_b, want.node_b);
        EXPECT_EQ(got.finished != 0, want.finished);
        EXPECT_EQ((Vec3{got.point[0], got.point[1], got.point[2]}), want.point);
        EXPECT_EQ((Vec3{got.normal[0], got.normal[1], got.normal[2]}), want.normal);
        EXPECT_EQ(got.depth, want.depth);
        EXPECT_EQ(got.error_bound, want.error_bound);
      }
    }
    morula_contacts_destroy(contacts);

    CrossingQuery crossings;
    ASSERT_TRUE(crossings.run(first, second));
    std::size_t count = 0;
    ASSERT_EQ(morula_crossings(c.a, c.b, nullptr, 0, &count), MORULA_OK);
    ASSERT_EQ(count, crossings.pairs().size());
    std::vector<std::uint32_t> pairs(2 * count + 2, 77);
    ASSERT_EQ(morula_crossings(c.a, c.b, pairs.data(), count, &count), MORULA_OK);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(pairs[2 * i], crossings.pairs()[i].facet_a);
      EXPECT_EQ(pairs[2 * i + 1], crossings.pairs()[i].facet_b);
    }
    EXPECT_EQ(pairs[2 * count], 77u) << "written beyond the capacity";

    const DistanceBounds expected = distance(first, second);
    morula_distance got;
    ASSERT_EQ(morula_distance_of(c.a, c.b, &got), MORULA_OK);
    EXPECT_EQ(got.lower, expected.lower);
    EXPECT_EQ(got.upper, expected.upper);
    EXPECT_EQ(got.crossing != 0, expected.crossing);
    EXPECT_EQ(got.facet_a, expected.a.facet);
    EXPECT_EQ(got.point_b[2], expected.b.point.z);
    EXPECT_EQ(got.certified, 1);
  }
}

TEST(CInterface, finds_crossings_of_a_body_with_itself) {
  const Handles c;
  const Mesh mesh = sample_body("limb", 12);
  std::size_t count = 77;
  ASSERT_EQ(morula_self_crossings(c.a, nullptr, 0, &count), MORULA_OK) << morula_message();
  EXPECT_EQ(count, 0u) << "at rest";

  // One half over the other: in two frames, of which the second moves it aside.
  std::vector<Vec3> folded = mesh.positions;
  for (Vec3& p : folded) p.x = p.x < 0 ? -0.875 * p.x : p.x;
  ASSERT_EQ(morula_body_update_double(c.a, &folded[0].x, folded.size(), 0), MORULA_OK);
  SurfaceTree surface(mesh);
  SurfaceCrossingQuery query;
  ASSERT_TRUE(surface.update(folded));
  ASSERT_TRUE(query.run(surface));
  ASSERT_EQ(morula_self_crossings(c.a, nullptr, 0, &count), MORULA_OK) << morula_message();
  ASSERT_EQ(count, query.pairs().size());
  ASSERT_GT(count, 2u);
  std::vector<std::uint32_t> pairs(2 * count, 77);
  ASSERT_EQ(morula_self_crossings(c.a, pairs.data(), count - 1, &count), MORULA_OK);
  for (std::size_t i = 0; i + 1 < count; ++i) {
    EXPECT_EQ(pairs[2 * i], query.pairs()[i].a);
    EXPECT_EQ(pairs[2 * i + 1], query.pairs()[i].b);
  }
  EXPECT_EQ(pairs.back(), 77u) << "written beyond the capacity";
  ASSERT_EQ(morula_body_update_double(c.a, &mesh.positions[0].x, mesh.vertex_count(), 0), MORULA_OK);
  ASSERT_EQ(morula_self_crossings(c.a, nullptr, 0, &count), MORULA_OK);
  EXPECT_EQ(count, 0u);

  folded[3].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(morula_body_update_double(c.a, &folded[0].x, folded.size(), 0), MORULA_REFUSED);
  EXPECT_EQ(morula_self_crossings(c.a, nullptr, 0, &count), MORULA_REFUSED);
  EXPECT_EQ(morula_self_crossings(nullptr, nullptr, 0, &count), MORULA_BAD_ARGUMENT);
}

TEST(CInterface, scenes_have_the_pairs_and_contacts_of_the_other_one) {
  const Handles c;
  const Mesh mesh = sample_body("limb", 12);
  const Body body(mesh, build(mesh, {.method = Method::octree}));
  Collider first(mesh, body), second(mesh, body);
  for (const std::int64_t budget : {-1, 0, 50}) {
    morula_contact_options options;
    morula_contact_options_init(&options);
    options.pair_tests = budget;
    options.margin = 0.01;
    SceneOptions same{.margin = 0.01};
    if (budget >= 0) same.budget = budget;
    Scene expected(same);
    static_cast<void>(expected.add(first));
    static_cast<void>(expected.add(second));
    morula_scene* scene = nullptr;
    ASSERT_EQ(morula_scene_create(&options, 2, &scene), MORULA_OK) << morula_message();
    ASSERT_EQ(morula_scene_add(scene, c.a, 0), MORULA_OK) << morula_message();
    ASSERT_EQ(morula_scene_add(scene, c.b, 0), MORULA_OK) << morula_message();
    for (const double height : {0.3, 0.6, 9.0, 0.6}) {
      const double translation[3] = {0, height, 0};
      ASSERT_EQ(morula_body_set_transform(c.b, upright, translation), MORULA_OK);
      second.set_transform({.translation = {0, height, 0}});
      ASSERT_TRUE(expected.update());
      ASSERT_EQ(morula_scene_update(scene), MORULA_OK) << morula_message();
      ASSERT_EQ(morula_scene_pair_count(scene), expected.pairs().size());
      EXPECT_EQ(expected.pairs().empty(), height == 9.0);
      for (std::size_t i = 0; i < expected.pairs().size(); ++i) {
        const ScenePair& want = expected.pairs()[i];
        const morula_scene_pair& got = morula_scene_pairs(scene)[i];
        EXPECT_EQ(got.a, c.a);
        EXPECT_EQ(got.b, c.b);
        EXPECT_EQ(got.touches != 0, want.touches);
        EXPECT_EQ(got.confirmed != 0, want.confirmed);
        EXPECT_EQ(got.began != 0, want.began);
        EXPECT_EQ(got.finished != 0, want.finished);
        ASSERT_EQ(got.contact_count, want.contacts.size());
        for (std::size_t k = 0; k < want.contacts.size(); ++k) {
          EXPECT_EQ(got.contacts[k].node_a, want.contacts[k].node_a);
          EXPECT_EQ(got.contacts[k].node_b, want.contacts[k].node_b);
          EXPECT_EQ(got.contacts[k].depth, want.contacts[k].depth);
          EXPECT_EQ(got.contacts[k].point[1], want.contacts[k].point.y);
        }
      }
    }
    morula_scene_destroy(scene);
  }
}

TEST(CInterface, scenes_keep_bodies_until_they_are_removed) {
  Handles c;
  morula_scene* scene = nullptr;
  ASSERT_EQ(morula_scene_create(nullptr, 1, &scene), MORULA_OK);
  ASSERT_EQ(morula_scene_add(scene, c.a, 1), MORULA_OK);
  ASSERT_EQ(morula_scene_add(scene, c.b, 0), MORULA_OK);
  EXPECT_EQ(morula_scene_add(scene, c.b, 0), MORULA_BAD_ARGUMENT) << "twice";
  morula_body_destroy(c.b);
  ASSERT_EQ(morula_scene_update(scene), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_scene_pair_count(scene), 1u);
  EXPECT_EQ(morula_scene_pairs(scene)[0].b, c.b);
  ASSERT_EQ(morula_scene_remove(scene, c.b), MORULA_OK);
  EXPECT_EQ(morula_scene_pair_count(scene), 0u);
  EXPECT_EQ(morula_scene_remove(scene, c.b), MORULA_BAD_ARGUMENT);
  ASSERT_EQ(morula_scene_update(scene), MORULA_OK);
  EXPECT_EQ(morula_scene_pair_count(scene), 0u);
  c.b = nullptr;

  std::vector<Vec3> positions = sample_body("limb", 12).positions;
  positions[3].y = std::numeric_limits<double>::quiet_NaN();
  morula_body* next = nullptr;
  ASSERT_EQ(morula_body_create(c.mesh, c.model, nullptr, &next), MORULA_OK);
  EXPECT_EQ(morula_body_update_double(next, &positions[0].x, positions.size(), 0), MORULA_REFUSED);
  EXPECT_EQ(morula_scene_add(scene, next, 0), MORULA_BAD_ARGUMENT);
  positions[3].y = 0;
  ASSERT_EQ(morula_body_update_double(next, &positions[0].x, positions.size(), 0), MORULA_OK);
  ASSERT_EQ(morula_scene_add(scene, next, 0), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_body_update_double(next, &positions[0].x, positions.size() - 1, 0), MORULA_REFUSED);
  EXPECT_EQ(morula_scene_update(scene), MORULA_REFUSED);
  EXPECT_STRNE(morula_message(), "");
  morula_body_destroy(next);
  morula_scene_destroy(scene);
  EXPECT_EQ(morula_scene_create(nullptr, 0, &scene), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(scene, nullptr);
  EXPECT_EQ(morula_scene_update(nullptr), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_scene_pair_count(nullptr), 0u);
}

TEST(CInterface, takes_floats_and_strides) {
  const Handles c;
  const Mesh mesh = sample_body("limb", 12);
  struct Node {
    float position[3], other[5];
  };
  std::vector<Node> nodes(mesh.vertex_count());
  std::vector<Vec3f> packed(mesh.vertex_count());
  for (std::size_t v = 0; v < nodes.size(); ++v) {
    packed[v] = Vec3f(static_cast<float>(mesh.positions[v].x), static_cast<float>(mesh.positions[v].y),
                      static_cast<float>(2 * mesh.positions[v].z));
    for (int k = 0; k < 3; ++k) nodes[v].position[k] = packed[v][k];
  }
  ASSERT_EQ(morula_body_update_float(c.a, nodes[0].position, nodes.size(), sizeof(Node)), MORULA_OK);
  ASSERT_EQ(morula_body_update_float(c.b, &packed[0].x, packed.size(), 0), MORULA_OK);
  Body body(mesh, build(mesh, {.method = Method::octree}));
  ASSERT_TRUE(body.update(packed));
  std::vector<morula_sphere> a(morula_body_node_count(c.a)), b(a.size());
  ASSERT_EQ(morula_body_spheres(c.a, a.data()), MORULA_OK);
  ASSERT_EQ(morula_body_spheres(c.b, b.data()), MORULA_OK);
  for (std::uint32_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(a[n].radius, body.sphere(n).radius);
    EXPECT_EQ(b[n].x, body.sphere(n).center.x);
  }
}

TEST(CInterface, writes_and_reads_files) {
  const test::ScratchFolder scratch;
  const Handles c;
  const std::string tree = (scratch.path() / "limb.morula").string(), obj = (scratch.path() / "limb.obj").string();
  ASSERT_EQ(morula_mesh_write(c.mesh, obj.c_str()), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_model_write(c.model, tree.c_str()), MORULA_OK) << morula_message();
  morula_mesh* mesh = nullptr;
  morula_model* model = nullptr;
  ASSERT_EQ(morula_mesh_read(obj.c_str(), &mesh), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_model_read(tree.c_str(), mesh, &model), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_model_node_count(model), morula_model_node_count(c.model));
  EXPECT_EQ(std::memcmp(morula_model_spheres(model), morula_model_spheres(c.model),
                        morula_model_node_count(model) * sizeof(morula_sphere)),
            0);
  morula_model_destroy(model);
  EXPECT_EQ(morula_model_read((scratch.path() / "none.morula").string().c_str(), mesh, &model), MORULA_BAD_FILE);
  EXPECT_EQ(model, nullptr);
  EXPECT_NE(std::string(morula_message()).find("none.morula"), std::string::npos) << morula_message();
  morula_mesh_destroy(mesh);
}

TEST(CInterface, tells_faults_by_codes_and_words) {
  const Handles c;
  const auto words = [] { return std::string(morula_message()); };
  morula_mesh* mesh = nullptr;
  const double nowhere[9] = {0, 0, 0, 1, 0, 0, 0, std::numeric_limits<double>::quiet_NaN(), 0};
  const std::uint32_t facet[3] = {0, 1, 2}, beyond[3] = {0, 1, 3};
  EXPECT_EQ(morula_mesh_create(nowhere, 3, facet, 1, &mesh), MORULA_BAD_ARGUMENT);
  EXPECT_NE(words().find("vertex 2"), std::string::npos) << words();
  EXPECT_EQ(morula_mesh_create(upright, 3, beyond, 1, &mesh), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_mesh_create(nullptr, 3, facet, 1, &mesh), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(words(), "positions is NULL");
  EXPECT_EQ(morula_mesh_create(upright, 3, facet, 1, nullptr), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_mesh_sample("cow", 12, &mesh), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(mesh, nullptr);

  morula_model* model = nullptr;
  morula_build_options options;
  morula_build_options_init(&options);
  options.method = "oktree";
  EXPECT_EQ(morula_build(c.mesh, &options, &model), MORULA_BAD_ARGUMENT);
  EXPECT_NE(words().find("oktree"), std::string::npos);
  morula_build_options_init(&options);
  options.branching = 1;
  EXPECT_EQ(morula_build(c.mesh, &options, &model), MORULA_BAD_ARGUMENT);
  options = {};
  EXPECT_EQ(morula_build(c.mesh, &options, &model), MORULA_BAD_ARGUMENT);
  EXPECT_NE(words().find("_init"), std::string::npos) << words();
  morula_build_options_init(&options);
  options.threads = -1;
  EXPECT_EQ(morula_build(c.mesh, &options, &model), MORULA_BAD_ARGUMENT);
  morula_build_options_init(&options);
  int calls = 0;
  options.progress = [](double, void* user) { return ++*static_cast<int*>(user) > 1 ? 1 : 0; };
  options.user = &calls;
  EXPECT_EQ(morula_build(c.mesh, &options, &model), MORULA_STOPPED) << words();
  EXPECT_EQ(model, nullptr);

  morula_body* body = nullptr;
  morula_body_options rules;
  morula_body_options_init(&rules);
  rules.rules = "approach2,modal";
  EXPECT_EQ(morula_body_create(c.mesh, c.model, &rules, &body), MORULA_BAD_ARGUMENT);
  EXPECT_NE(words().find("modal"), std::string::npos) << words();
  rules.rules = "approach2,exact";
  ASSERT_EQ(morula_body_create(c.mesh, c.model, &rules, &body), MORULA_OK) << words();
  morula_body_destroy(body);

  std::vector<Vec3> positions = sample_body("limb", 12).positions;
  std::vector<morula_sphere> before(morula_body_node_count(c.a)), after(before.size());
  ASSERT_EQ(morula_body_spheres(c.a, before.data()), MORULA_OK);
  EXPECT_EQ(morula_body_update_double(c.a, &positions[0].x, positions.size() - 1, 0), MORULA_REFUSED);
  positions[3].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(morula_body_update_double(c.a, &positions[0].x, positions.size(), 0), MORULA_REFUSED);
  EXPECT_NE(words().find('3'), std::string::npos) << words();
  EXPECT_EQ(morula_body_update_double(c.a, &positions[0].x, positions.size(), 8), MORULA_BAD_ARGUMENT);
  ASSERT_EQ(morula_body_spheres(c.a, after.data()), MORULA_OK);
  EXPECT_EQ(std::memcmp(before.data(), after.data(), before.size() * sizeof before[0]), 0);
  int overlaps = 0;
  EXPECT_EQ(morula_overlap(c.a, c.b, &overlaps), MORULA_BAD_ARGUMENT) << "of a body that is not current";
  const double mirrored[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(morula_body_set_transform(c.a, mirrored, upright), MORULA_BAD_ARGUMENT);

  morula_contacts* contacts = nullptr;
  ASSERT_EQ(morula_contacts_create(&contacts), MORULA_OK);
  morula_contact_options both;
  morula_contact_options_init(&both);
  both.pair_tests = 1, both.nanoseconds = 1;
  EXPECT_EQ(morula_collide(c.b, c.b, &both, contacts), MORULA_BAD_ARGUMENT);
  morula_contacts_destroy(contacts);
  morula_mesh_destroy(nullptr);
  EXPECT_EQ(morula_mesh_vertex_count(nullptr), 0u);
}

TEST(CInterface, keeps_options_of_older_headers) {
  const Handles c;
  morula_build_options options;
  morula_build_options_init(&options);
  options.method = "octree";
  options.threads = -3;  // behind the end that this size tells: not looked at
  options.size = offsetof(morula_build_options, threads);
  morula_model* model = nullptr;
  ASSERT_EQ(morula_build(c.mesh, &options, &model), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_model_node_count(model), morula_model_node_count(c.model));
  morula_model_destroy(model);
}

// Programs of other versions: defaults fill no more than the caller's struct, and nothing in it stays as it was.
template <class Options>
void expect_defaults_in_size(void (*write)(Options*, std::size_t), void (*init)(Options*)) {
  Options whole;
  init(&whole);
  EXPECT_EQ(whole.size, sizeof(Options));
  std::vector<std::byte> expected(2 * sizeof(Options));
  std::memcpy(expected.data(), &whole, sizeof whole);
  for (std::size_t size = 0; size <= 2 * sizeof(Options); size += alignof(Options)) {
    std::vector<Options> structs(3);
    std::memset(structs.data(), 0x55, 3 * sizeof(Options));
    write(structs.data(), size);
    std::vector<std::byte> written(3 * sizeof(Options));
    std::memcpy(written.data(), structs.data(), written.size());
    for (std::size_t i = size; i < written.size(); ++i) ASSERT_EQ(written[i], std::byte{0x55}) << size << ' ' << i;
    if (size == 0) continue;
    std::memcpy(expected.data(), &size, sizeof size);
    EXPECT_EQ(std::memcmp(written.data(), expected.data(), size), 0) << size;
  }
  write(nullptr, sizeof(Options));
}

TEST(CInterface, defaults_fill_the_struct_of_the_caller) {
  expect_defaults_in_size(&morula_build_options_defaults, &morula_build_options_init);
  expect_defaults_in_size(&morula_body_options_defaults, &morula_body_options_init);
  expect_defaults_in_size(&morula_contact_options_defaults, &morula_contact_options_init);
  expect_defaults_in_size(&morula_patch_options_defaults, &morula_patch_options_init);
  expect_defaults_in_size(&morula_haptic_options_defaults, &morula_haptic_options_init);
  expect_defaults_in_size(&morula_haptic_tool_options_defaults, &morula_haptic_tool_options_init);
}

TEST(CInterface, has_a_message_for_each_thread) {
  morula_mesh* mesh = nullptr;
  EXPECT_EQ(morula_mesh_sample("first", 12, &mesh), MORULA_BAD_ARGUMENT);
  std::thread([] {
    EXPECT_STREQ(morula_message(), "");
    morula_mesh* other = nullptr;
    EXPECT_EQ(morula_mesh_sample("second", 12, &other), MORULA_BAD_ARGUMENT);
  }).join();
  EXPECT_NE(std::string(morula_message()).find("first"), std::string::npos) << morula_message();
}

}  // namespace
}  // namespace morula
