// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies of the C interface for tests of pairs, and the pairs of a list by their vertices.
#pragma once

#include <gtest/gtest.h>
#include <morula/morula.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <tuple>
#include <vector>

namespace morula::test {

inline constexpr double no_rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

struct PairBody {
  morula_mesh* mesh = nullptr;
  morula_body* body = nullptr;
  Vec3 offset{};

  explicit PairBody(const char* sample, int resolution = 6, const Vec3& place = {}) {
    morula_model* model = nullptr;
    morula_build_options options;
    morula_build_options_init(&options);
    options.method = "octree";
    EXPECT_EQ(morula_mesh_sample(sample, resolution, &mesh), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_build(mesh, &options, &model), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_body_create(mesh, model, nullptr, &body), MORULA_OK) << morula_message();
    morula_model_destroy(model);
    move(place);
  }
  ~PairBody() {
    morula_mesh_destroy(mesh);
    morula_body_destroy(body);
  }
  PairBody(const PairBody&) = delete;
  PairBody& operator=(const PairBody&) = delete;

  void move(const Vec3& to) {
    offset = to;
    const double translation[3] = {to.x, to.y, to.z};
    EXPECT_EQ(morula_body_set_transform(body, no_rotation, translation), MORULA_OK);
  }
  Vec3 corner(std::uint32_t vertex) const {
    const double* p = morula_mesh_positions(mesh) + 3 * std::size_t{vertex};
    return Vec3{p[0], p[1], p[2]} + offset;
  }
  std::size_t vertex_count() const { return morula_mesh_vertex_count(mesh); }
  std::vector<std::vector<std::uint32_t>> facets() const {
    const std::uint32_t* list = morula_mesh_facets(mesh);
    std::vector<std::vector<std::uint32_t>> all;
    for (std::size_t f = 0; f < morula_mesh_facet_count(mesh); ++f, list += 3)
      all.push_back({list[0], list[1], list[2]});
    return all;
  }
  std::vector<std::vector<std::uint32_t>> edges() const {
    std::vector<std::vector<std::uint32_t>> all;
    for (const auto& facet : facets())
      for (std::size_t i = 0; i < 3; ++i)
        all.push_back({std::min(facet[i], facet[(i + 1) % 3]), std::max(facet[i], facet[(i + 1) % 3])});
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

using Key = std::tuple<int, std::vector<std::uint32_t>, std::vector<std::uint32_t>>;

inline std::vector<std::uint32_t> vertices_of(const std::uint32_t* vertices) {
  std::vector<std::uint32_t> list;
  for (int i = 0; i < 3 && vertices[i] != UINT32_MAX; ++i) list.push_back(vertices[i]);
  std::sort(list.begin(), list.end());
  return list;
}

inline std::vector<Key> keys_of(const morula_pairs* pairs) {
  std::vector<Key> keys;
  for (std::size_t i = 0; i < morula_pairs_count(pairs); ++i) {
    const morula_pair& pair = morula_pairs_data(pairs)[i];
    keys.push_back({pair.kind, vertices_of(pair.vertices_a), vertices_of(pair.vertices_b)});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

}  // namespace morula::test
