// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/page/collide_page.hpp>

namespace morula {
namespace {

/// A sphere around two, for a root that only joins them.
Sphere around(const Sphere& a, const Sphere& b) {
  const double apart = distance(a.center, b.center);
  if (apart + b.radius <= a.radius) return a;
  if (apart + a.radius <= b.radius) return b;
  const double radius = 0.5 * (apart + a.radius + b.radius);
  return {a.center + (b.center - a.center) * ((radius - a.radius) / apart), radius};
}

std::size_t level_count(const std::vector<const Collider*>& bodies) {
  std::size_t count = 0;
  for (const Collider* body : bodies) count = std::max(count, body->tree().level_count());
  return count;
}

/// The children of a new root are the roots of all trees; on every level nodes come in the order of their bodies.
SphereTree joined(const std::vector<const Collider*>& bodies) {
  SphereTree all;
  const auto count = static_cast<std::uint32_t>(bodies.size());
  all.branching = std::max(2u, count);
  for (const Collider* body : bodies) all.branching = std::max(all.branching, body->tree().branching);
  const std::vector<Sphere> roots(bodies.size());
  all.append_level(std::array<std::uint32_t, 1>{1}, std::span(roots).first(1));
  all.append_level(std::array<std::uint32_t, 1>{count}, roots);
  for (std::size_t level = 0; level + 1 < level_count(bodies); ++level) {
    std::vector<std::uint32_t> counts;
    for (const Collider* body : bodies) {
      const SphereTree& tree = body->tree();
      if (level >= tree.level_count()) continue;
      counts.insert(counts.end(), tree.child_count.begin() + tree.level_begin[level],
                    tree.child_count.begin() + tree.level_begin[level + 1]);
    }
    std::size_t made = 0;
    for (const std::uint32_t children : counts) made += children;
    all.append_level(counts, std::vector<Sphere>(made));
  }
  return all;
}

Sphere placed_sphere(const Collider& body, std::uint32_t node) {
  const Sphere s = body.sphere_state().sphere(node);
  return {body.transform()(s.center), s.radius};
}

double area_of(const Collider& body, std::uint32_t facet) {
  const Facet& f = body.mesh_facets()[facet];
  const Vec3 corner = body.vertex(f[0]);
  return 0.5 * length(cross(body.vertex(f[1]) - corner, body.vertex(f[2]) - corner));
}

/// first: index of the body's first facet among those of the page.
void add_region(std::span<const PatchFacet> region, const Collider& body, std::size_t first, PagePatches::Patch& to) {
  for (const PatchFacet& part : region) {
    const double whole = area_of(body, part.facet);
    const double share = whole > 0 ? std::min(length(part.area_vector) / whole, 1.0) : 1.0;
    to.facets.push_back({static_cast<std::uint32_t>(first + part.facet), share});
  }
}

}  // namespace

void add_marks(std::span<const Contact> contacts, std::span<const ContactSurface> surfaces,
               std::vector<PageContact>& marks) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& contact = contacts[i];
    if (!contact.finished) continue;
    PageContact mark{contact.point, contact.normal, contact.depth};
    if (i < surfaces.size()) {
      mark.normal = surfaces[i].normal;
      mark.depth = surfaces[i].depth;
      if (mark.depth == 0) continue;  // the spheres overlap, the regions are apart
    }
    marks.push_back(mark);
  }
}

CollidePage::CollidePage(const std::string& title, std::vector<const Collider*> bodies, const std::string& rule)
    : bodies_(std::move(bodies)) {
  PageMotion motion{.body = title, .name = "contacts", .facets = {}, .frame_names = {}, .frames = {}};
  std::uint32_t offset = 0;
  for (const Collider* body : bodies_) {
    for (const Facet& f : body->mesh_facets()) motion.facets.push_back({f[0] + offset, f[1] + offset, f[2] + offset});
    offset += static_cast<std::uint32_t>(body->positions().size());
  }
  PageScene scene{.motion = 0,
                  .tree = title,
                  .rule = rule,
                  .rest = joined(bodies_),
                  .frames = {},
                  .measured = {},
                  .empty_share = {}};
  scene.rest.spheres = spheres();
  content_.title = title;
  content_.motions.push_back(std::move(motion));
  content_.scenes.push_back(std::move(scene));
}

std::vector<Sphere> CollidePage::spheres() const {
  Sphere root = placed_sphere(*bodies_.front(), 0);
  for (const Collider* body : bodies_) root = around(root, placed_sphere(*body, 0));
  std::vector<Sphere> all{root};
  for (std::size_t level = 0; level < level_count(bodies_); ++level)
    for (const Collider* body : bodies_) {
      const SphereTree& tree = body->tree();
      if (level >= tree.level_count()) continue;
      for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node)
        all.push_back(placed_sphere(*body, node));
    }
  return all;
}

void CollidePage::add(const std::string& frame_name, std::vector<PageContact> marks) {
  add_frame(frame_name, std::move(marks));
  PageScene& scene = content_.scenes.front();
  if (!scene.patches.empty()) scene.patches.emplace_back();
}

void CollidePage::add(const std::string& frame_name, std::span<const ContactPatch> patches,
                      std::span<const Crossing> crossings) {
  const Collider &a = *bodies_[0], &b = *bodies_[std::min<std::size_t>(1, bodies_.size() - 1)];
  const std::size_t first_of_b = bodies_.size() > 1 ? a.mesh_facets().size() : 0;
  std::vector<PageContact> marks;
  PagePatches shown;
  for (const ContactPatch& patch : patches) {
    PagePatches::Patch& to = shown.patches.emplace_back();
    to.volume = patch.volume, to.depth = patch.depth;
    add_region(patch.a.facets, a, 0, to);
    add_region(patch.b.facets, b, first_of_b, to);
    for (const PatchPoint& point : patch.points) {
      const double size = length(point.force);
      marks.push_back({point.point, size > 0 ? point.force / size : patch.normal, point.depth});
    }
  }
  for (const Crossing& crossing : crossings) shown.curves.push_back({crossing.segment.from, crossing.segment.to});
  add_frame(frame_name, std::move(marks));
  PageScene& scene = content_.scenes.front();
  scene.patches.resize(scene.frames.size() - 1);
  scene.patches.push_back(std::move(shown));
}

void CollidePage::add_frame(const std::string& name, std::vector<PageContact> marks) {
  PageMotion& motion = content_.motions.front();
  motion.frame_names.push_back(name);
  std::vector<Vec3>& vertices = motion.frames.emplace_back();
  for (const Collider* body : bodies_)
    for (std::size_t i = 0; i < body->positions().size(); ++i)
      vertices.push_back(body->vertex(static_cast<std::uint32_t>(i)));
  PageScene& scene = content_.scenes.front();
  scene.frames.push_back(spheres());
  scene.contacts.push_back(std::move(marks));
}

std::string CollidePage::text() const {
  return make_page(content_);
}

}  // namespace morula
