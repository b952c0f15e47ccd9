// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace morula::cli {
namespace {

/// A sphere around two, for a root that only holds them together.
Sphere around(const Sphere& a, const Sphere& b) {
  const double apart = distance(a.center, b.center);
  if (apart + b.radius <= a.radius) return a;
  if (apart + a.radius <= b.radius) return b;
  const double radius = 0.5 * (apart + a.radius + b.radius);
  return {a.center + (b.center - a.center) * ((radius - a.radius) / apart), radius};
}

/// The children of a new root are the roots of both trees; on every level a's nodes come first.
SphereTree joined(const SphereTree& a, const SphereTree& b) {
  SphereTree both;
  both.branching = std::max({a.branching, b.branching, 2u});
  const std::array<std::uint32_t, 1> one{1};
  const std::array<std::uint32_t, 1> two{2};
  const std::vector<Sphere> none(2);
  both.append_level(one, std::span(none).first(1));
  both.append_level(two, none);
  for (std::size_t level = 0; level + 1 < std::max(a.level_count(), b.level_count()); ++level) {
    std::vector<std::uint32_t> counts;
    for (const SphereTree* tree : {&a, &b}) {
      if (level >= tree->level_count()) continue;
      counts.insert(counts.end(), tree->child_count.begin() + tree->level_begin[level],
                    tree->child_count.begin() + tree->level_begin[level + 1]);
    }
    std::size_t made = 0;
    for (const std::uint32_t count : counts) made += count;
    both.append_level(counts, std::vector<Sphere>(made));
  }
  return both;
}

std::string stem(const Side& side) {
  return std::filesystem::path(side.name()).stem().string();
}

void add_vertices(const Side& side, std::vector<Vec3>& vertices) {
  const Collider& collider = side.collider();
  const std::size_t count = collider.positions().size();
  for (std::size_t i = 0; i < count; ++i) vertices.push_back(collider.vertex(static_cast<std::uint32_t>(i)));
}

}  // namespace

CollidePage::CollidePage(const Side& a, const Side& b, const std::string& rule) {
  const std::string title = stem(a) + " and " + stem(b);
  PageMotion motion{.body = title, .name = "contacts", .facets = {}, .frame_names = {}, .frames = {}};
  const auto offset = static_cast<std::uint32_t>(a.collider().positions().size());
  const auto facets_a = a.collider().mesh_facets(), facets_b = b.collider().mesh_facets();
  motion.facets.assign(facets_a.begin(), facets_a.end());
  for (const Facet& f : facets_b) motion.facets.push_back({f[0] + offset, f[1] + offset, f[2] + offset});
  PageScene scene{.motion = 0,
                  .tree = title,
                  .rule = rule,
                  .rest = joined(a.collider().tree(), b.collider().tree()),
                  .frames = {},
                  .measured = {},
                  .empty_share = {}};
  content_.title = title;
  content_.motions.push_back(std::move(motion));
  content_.scenes.push_back(std::move(scene));
  content_.scenes.front().rest.spheres = spheres(a, b);
}

std::vector<Sphere> CollidePage::spheres(const Side& a, const Side& b) const {
  const auto placed = [](const Side& side, std::uint32_t node) {
    const Sphere s = side.collider().pose().sphere(node);
    return Sphere{side.collider().placement()(s.center), s.radius};
  };
  std::vector<Sphere> both{around(placed(a, 0), placed(b, 0))};
  const SphereTree& tree_a = a.collider().tree();
  const SphereTree& tree_b = b.collider().tree();
  for (std::size_t level = 0; level < std::max(tree_a.level_count(), tree_b.level_count()); ++level)
    for (const Side* side : {&a, &b}) {
      const SphereTree& tree = side->collider().tree();
      if (level >= tree.level_count()) continue;
      for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node)
        both.push_back(placed(*side, node));
    }
  return both;
}

void CollidePage::add(const Side& a, const Side& b, const CollidedFrame& found) {
  PageMotion& motion = content_.motions.front();
  motion.frame_names.push_back(found.name_a + ", " + found.name_b);
  motion.frames.emplace_back();
  add_vertices(a, motion.frames.back());
  add_vertices(b, motion.frames.back());
  PageScene& scene = content_.scenes.front();
  scene.frames.push_back(spheres(a, b));
  std::vector<PageContact>& marks = scene.contacts.emplace_back();
  for (std::size_t i = 0; i < found.contacts.size(); ++i) {
    const Contact& contact = found.contacts[i];
    if (!contact.finished) continue;
    PageContact mark{contact.point, contact.normal, contact.depth};
    if (i < found.surfaces.size()) {
      mark.normal = found.surfaces[i].normal;
      mark.depth = found.surfaces[i].depth;
      if (mark.depth == 0) continue;  // the spheres overlap, the regions are apart
    }
    marks.push_back(mark);
  }
}

std::string CollidePage::text() const {
  return make_page(content_);
}

}  // namespace morula::cli
