// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bytes, rays and points of the C interface: what files and the C++ interface give.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <morula/collide/containment.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <string>
#include <support/scratch_folder.hpp>
#include <vector>

namespace morula {
namespace {

struct Limb {
  morula_mesh* mesh = nullptr;
  morula_model* model = nullptr;
  morula_body* body = nullptr;
  Limb() {
    EXPECT_EQ(morula_mesh_sample("limb", 10, &mesh), MORULA_OK) << morula_message();
    morula_build_options options;
    morula_build_options_init(&options);
    options.method = "octree";
    EXPECT_EQ(morula_build(mesh, &options, &model), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_body_create(mesh, model, nullptr, &body), MORULA_OK) << morula_message();
  }
  ~Limb() {
    morula_mesh_destroy(mesh);
    morula_model_destroy(model);
    morula_body_destroy(body);
  }
  Limb(const Limb&) = delete;
  Limb& operator=(const Limb&) = delete;
};

std::string bytes_of(const morula_model* model) {
  std::size_t size = 0;
  EXPECT_EQ(morula_model_to_bytes(model, nullptr, 0, &size), MORULA_OK) << morula_message();
  std::string bytes(size, '?');
  EXPECT_EQ(morula_model_to_bytes(model, bytes.data(), size - 1, &size), MORULA_OK);
  EXPECT_EQ(bytes, std::string(size, '?')) << "a part was written";
  EXPECT_EQ(morula_model_to_bytes(model, bytes.data(), size, &size), MORULA_OK);
  return bytes;
}

TEST(CBytes, are_those_of_files) {
  const Limb limb;
  const test::ScratchFolder folder;
  const std::string tree = (folder.path() / "limb.morula").string(), off = (folder.path() / "limb.off").string();
  ASSERT_EQ(morula_model_write(limb.model, tree.c_str()), MORULA_OK) << morula_message();
  const std::string bytes = bytes_of(limb.model);
  EXPECT_EQ(bytes, test::bytes_of(tree));
  morula_model* read = nullptr;
  ASSERT_EQ(morula_model_from_bytes(bytes.data(), bytes.size(), limb.mesh, &read), MORULA_OK) << morula_message();
  EXPECT_EQ(bytes_of(read), bytes);
  morula_model_destroy(read);

  ASSERT_EQ(morula_mesh_write(limb.mesh, off.c_str()), MORULA_OK) << morula_message();
  const std::string text = test::bytes_of(off);
  morula_mesh* mesh = nullptr;
  ASSERT_EQ(morula_mesh_from_bytes("limb.off", text.data(), text.size(), &mesh), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_mesh_vertex_count(mesh), morula_mesh_vertex_count(limb.mesh));
  EXPECT_EQ(std::memcmp(morula_mesh_positions(mesh), morula_mesh_positions(limb.mesh),
                        3 * sizeof(double) * morula_mesh_vertex_count(mesh)),
            0);
  morula_mesh_destroy(mesh);
}

TEST(CBytes, that_are_no_file_are_rejected_at_every_length) {
  const Limb limb;
  const std::string bytes = bytes_of(limb.model);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 3) {
    morula_model* model = nullptr;
    EXPECT_EQ(morula_model_from_bytes(bytes.data(), size, limb.mesh, &model), MORULA_BAD_FILE) << size;
    EXPECT_EQ(model, nullptr);
  }
  morula_model* model = nullptr;
  EXPECT_EQ(morula_model_from_bytes(nullptr, 8, limb.mesh, &model), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_model_from_bytes(bytes.data(), bytes.size(), nullptr, &model), MORULA_BAD_ARGUMENT);
  morula_mesh* mesh = nullptr;
  EXPECT_EQ(morula_mesh_from_bytes("a.off", "OFF 3", 5, &mesh), MORULA_BAD_FILE);
  EXPECT_EQ(morula_mesh_from_bytes("a.off", nullptr, 0, &mesh), MORULA_BAD_FILE);
  EXPECT_EQ(morula_mesh_from_bytes("a.off", nullptr, 1, &mesh), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_mesh_from_bytes("a.txt", "OFF 3", 5, &mesh), MORULA_BAD_FILE);
  EXPECT_EQ(morula_mesh_from_bytes("a", "OFF 3", 5, &mesh), MORULA_BAD_FILE);
  EXPECT_EQ(mesh, nullptr);
}

TEST(CPoints, rays_and_locations_are_those_of_the_other_interface) {
  const Limb limb;
  const Mesh mesh = sample_body("limb", 10);
  Body body(mesh, build(mesh, {.method = Method::octree}));
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p.z += 0.2 * p.x * p.x;
  ASSERT_TRUE(body.update(positions));
  ASSERT_EQ(morula_body_update_double(limb.body, &positions[0].x, positions.size(), 0), MORULA_OK);
  const Collider collider(mesh, body);
  InsideQuery inside(collider);
  std::vector<morula_ray> rays;
  std::vector<double> points;
  for (int i = 0; i < 60; ++i) {
    const double x = 2 * std::sin(i), y = 0.4 * std::cos(3.0 * i), z = 0.4 * std::sin(7.0 * i);
    rays.push_back({{x, y, 2}, {0.1 * y, 0.1 * x, -1}, i % 3 == 0 ? 1.7 : std::numeric_limits<double>::infinity()});
    points.insert(points.end(), {x, y, z});
  }
  std::vector<morula_ray_hit> hits(rays.size());
  std::vector<morula_location> places(rays.size());
  ASSERT_EQ(morula_first_hits(limb.body, rays.data(), rays.size(), hits.data()), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_locate(limb.body, points.data(), places.size(), places.data()), MORULA_OK) << morula_message();
  std::size_t hit_count = 0, inside_count = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto vector = [](const double* v) { return Vec3{v[0], v[1], v[2]}; };
    const RayHit expected = first_hit(collider, {vector(rays[i].origin), vector(rays[i].direction), rays[i].t_end});
    EXPECT_EQ(hits[i].certified, 1);
    ASSERT_EQ(hits[i].facet != UINT32_MAX, expected.first.has_value());
    if (expected.first) {
      ++hit_count;
      EXPECT_EQ(hits[i].facet, expected.first->point.facet);
      EXPECT_EQ(hits[i].t, expected.first->t);
      EXPECT_EQ(vector(hits[i].point), expected.first->point.point);
      EXPECT_EQ(vector(hits[i].normal), expected.first->normal);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(hits[i].barycentric[k], expected.first->point.barycentric[k]);
    } else {
      EXPECT_TRUE(std::isinf(hits[i].t));
    }
    const PointLocation at = inside.locate(vector(&points[3 * i]));
    EXPECT_EQ(places[i].inside == 1, at.inside);
    EXPECT_EQ(places[i].winding, at.winding);
    EXPECT_EQ(places[i].certified, 1);
    inside_count += at.inside ? 1 : 0;
  }
  EXPECT_GT(hit_count, 10u);
  EXPECT_GT(inside_count, 5u);
  EXPECT_LT(inside_count, 55u);
}

TEST(CPoints, bad_input_writes_nothing) {
  const Limb limb;
  std::vector<morula_ray> rays{{{0, 0, 2}, {0, 0, -1}, 9}, {{0, 0, NAN}, {0, 0, -1}, 9}};
  morula_ray_hit hits[2]{};
  EXPECT_EQ(morula_first_hits(limb.body, rays.data(), 2, hits), MORULA_REFUSED);
  EXPECT_EQ(hits[0].t, 0);
  EXPECT_EQ(morula_first_hits(limb.body, nullptr, 0, nullptr), MORULA_OK);
  EXPECT_EQ(morula_first_hits(limb.body, nullptr, 1, hits), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_first_hits(nullptr, rays.data(), 1, hits), MORULA_BAD_ARGUMENT);
  const double points[6]{0, 0, 0, NAN, 0, 0};
  morula_location places[2]{{7, 7, 7, 7}, {}};
  EXPECT_EQ(morula_locate(limb.body, points, 2, places), MORULA_REFUSED);
  EXPECT_EQ(places[0].inside, 7);
  EXPECT_EQ(morula_locate(limb.body, nullptr, 0, nullptr), MORULA_OK);

  // No machine has room for these.
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  EXPECT_EQ(morula_first_hits(limb.body, rays.data(), most, hits), MORULA_OUT_OF_MEMORY);
  EXPECT_EQ(morula_locate(limb.body, points, most, places), MORULA_OUT_OF_MEMORY);

  morula_mesh* open = nullptr;
  morula_model* model = nullptr;
  morula_body* body = nullptr;
  const double corners[9]{0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t facet[3]{0, 1, 2};
  ASSERT_EQ(morula_mesh_create(corners, 3, facet, 1, &open), MORULA_OK);
  ASSERT_EQ(morula_build(open, nullptr, &model), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_body_create(open, model, nullptr, &body), MORULA_OK);
  EXPECT_EQ(morula_locate(body, points, 1, places), MORULA_BAD_ARGUMENT);
  EXPECT_NE(std::strstr(morula_message(), "edge"), nullptr) << morula_message();
  morula_mesh_destroy(open);
  morula_model_destroy(model);
  morula_body_destroy(body);
}

}  // namespace
}  // namespace morula
