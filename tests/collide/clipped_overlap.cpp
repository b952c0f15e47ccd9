// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "clipped_overlap.hpp"

#include <array>
#include <vector>

namespace morula::test {
namespace {

using Wide = Vector3<long double>;
using Tetrahedron = std::array<Wide, 4>;

long double signed_volume(const Tetrahedron& t) {
  return dot(t[1] - t[0], cross(t[2] - t[0], t[3] - t[0])) / 6;
}

struct Plane {
  Wide point, normal;  // the kept side is behind
  long double height(const Wide& x) const { return dot(normal, x - point); }
};

Wide between(const Wide& p, const Wide& q, const Plane& plane) {
  const long double h = plane.height(p), k = plane.height(q);
  return p + (q - p) * (h / (h - k));
}

// Splits what is behind the plane into tetrahedra.
void clip(const Tetrahedron& t, const Plane& plane, std::vector<Tetrahedron>& kept) {
  std::vector<Wide> in, out;
  for (const Wide& x : t) (plane.height(x) <= 0 ? in : out).push_back(x);
  const auto cut = [&](std::size_t i, std::size_t j) { return between(in[i], out[j], plane); };
  const auto prism = [&](const Wide& p, const Wide& q, const Wide& r, const Wide& u, const Wide& v, const Wide& w) {
    kept.push_back({p, q, r, u});
    kept.push_back({q, r, u, v});
    kept.push_back({r, u, v, w});
  };
  if (in.size() == 4) kept.push_back(t);
  if (in.size() == 1) kept.push_back({in[0], cut(0, 0), cut(0, 1), cut(0, 2)});
  if (in.size() == 3) prism(in[0], in[1], in[2], cut(0, 0), cut(1, 0), cut(2, 0));
  if (in.size() == 2) prism(in[0], cut(0, 0), cut(0, 1), in[1], cut(1, 0), cut(1, 1));
}

struct Cone {
  Tetrahedron corners;
  std::array<Plane, 4> planes;
  int sign;
};

std::vector<Cone> cones_of(const Collider& body, const Wide& apex) {
  std::vector<Cone> cones;
  for (std::uint32_t f = 0; f < body.mesh_facets().size(); ++f) {
    const Triangle t = body.triangle(f);
    Cone cone{{apex, Wide(t[0]), Wide(t[1]), Wide(t[2])}, {}, 1};
    const long double volume = signed_volume(cone.corners);
    if (volume == 0) continue;
    cone.sign = volume > 0 ? 1 : -1;
    for (std::size_t k = 0; k < 4; ++k) {
      const Wide &p = cone.corners[(k + 1) % 4], &q = cone.corners[(k + 2) % 4], &r = cone.corners[(k + 3) % 4];
      Wide normal = cross(q - p, r - p);
      if (dot(normal, cone.corners[k] - p) > 0) normal = -normal;
      cone.planes[k] = {p, normal};
    }
    cones.push_back(cone);
  }
  return cones;
}

Wide clipped_area(const Triangle& t, const Cone& cone) {
  std::vector<Wide> polygon{Wide(t[0]), Wide(t[1]), Wide(t[2])}, next;
  for (const Plane& plane : cone.planes) {
    next.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Wide &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      const bool p_in = plane.height(p) <= 0, q_in = plane.height(q) <= 0;
      if (p_in) next.push_back(p);
      if (p_in != q_in) next.push_back(between(p, q, plane));
    }
    polygon = next;
  }
  Wide area;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    area += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]) * 0.5L;
  return area;
}

Wide area_inside(const Collider& surface, const std::vector<Cone>& cones) {
  Wide sum;
  for (std::uint32_t f = 0; f < surface.mesh_facets().size(); ++f)
    for (const Cone& cone : cones) sum += clipped_area(surface.triangle(f), cone) * static_cast<long double>(cone.sign);
  return sum;
}

}  // namespace

ClippedOverlap clipped_overlap(const Collider& a, const Collider& b) {
  // The apexes are in general position.
  const Wide first = Wide(a.vertex(0)) + Wide{0.0123L, 0.0317L, -0.0271L};
  const Wide second = Wide(b.vertex(0)) + Wide{-0.0219L, 0.0113L, 0.0379L};
  const std::vector<Cone> cones_a = cones_of(a, first), cones_b = cones_of(b, second);
  long double volume = 0;
  Wide moment;
  std::vector<Tetrahedron> pieces, next;
  for (const Cone& p : cones_a)
    for (const Cone& q : cones_b) {
      pieces.assign(1, p.corners);
      for (const Plane& plane : q.planes) {
        next.clear();
        for (const Tetrahedron& t : pieces) clip(t, plane, next);
        pieces.swap(next);
      }
      for (const Tetrahedron& t : pieces) {
        const long double part = std::abs(signed_volume(t)) * static_cast<long double>(p.sign * q.sign);
        volume += part;
        moment += (t[0] + t[1] + t[2] + t[3] - first * 4.0L) * (part / 4);
      }
    }
  ClippedOverlap overlap;
  overlap.volume = static_cast<double>(volume);
  overlap.centroid = Vec3(volume != 0 ? first + moment / volume : first);
  overlap.area_vector_a = Vec3(area_inside(a, cones_b));
  overlap.area_vector_b = Vec3(area_inside(b, cones_a));
  return overlap;
}

}  // namespace morula::test
