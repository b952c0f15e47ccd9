// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces.hpp"

#include <cmath>
#include <set>

namespace morula::test {
namespace {

struct Long3 {
  long double x, y, z;
};
Long3 operator-(const Long3& a, const Long3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Long3 operator+(const Long3& a, const Long3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Long3 operator*(const Long3& a, long double s) {
  return {a.x * s, a.y * s, a.z * s};
}
long double operator*(const Long3& a, const Long3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Long3 across(const Long3& a, const Long3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
long double norm(const Long3& a) {
  return std::sqrt(a * a);
}

long double point_segment(const Long3& p, const Long3& a, const Long3& b) {
  const Long3 d = b - a;
  const long double dd = d * d;
  const long double s = dd > 0 ? std::fmin(1.0L, std::fmax(0.0L, ((p - a) * d) / dd)) : 0.0L;
  return norm(p - (a + d * s));
}

long double point_triangle(const Long3& p, const Long3& a, const Long3& b, const Long3& c) {
  const long double borders =
      std::fmin(point_segment(p, a, b), std::fmin(point_segment(p, b, c), point_segment(p, c, a)));
  const Long3 n = across(b - a, c - a);
  const long double nn = n * n;
  if (nn <= 0) return borders;
  const bool is_above = across(b - a, p - a) * n >= 0 && across(c - b, p - b) * n >= 0 && across(a - c, p - c) * n >= 0;
  return is_above ? std::fmin(borders, std::fabs((p - a) * n) / std::sqrt(nn)) : borders;
}

long double segment_segment(const Long3& a, const Long3& b, const Long3& c, const Long3& d) {
  const long double ends = std::fmin(std::fmin(point_segment(a, c, d), point_segment(b, c, d)),
                                     std::fmin(point_segment(c, a, b), point_segment(d, a, b)));
  const Long3 u = b - a, v = d - c, w = a - c, n = across(u, v);
  const long double nn = n * n;
  if (nn <= 0) return ends;
  const long double s = across(v, w) * n / nn, t = across(u, w) * n / nn;
  if (s < 0 || s > 1 || t < 0 || t > 1) return ends;
  return std::fmin(ends, norm((a + u * s) - (c + v * t)));
}

}  // namespace

Moving random_soup(std::size_t vertices, std::size_t facets, int reach, Random& random) {
  Moving m;
  const auto whole = [&] {
    return static_cast<double>(static_cast<int>(random.next() % (2 * static_cast<unsigned>(reach) + 1)) - reach);
  };
  for (std::size_t v = 0; v < vertices; ++v) {
    m.from.push_back({whole(), whole(), whole()});
    m.to.push_back({whole(), whole(), whole()});
  }
  m.mesh.positions = m.from;
  for (std::size_t f = 0; f < facets; ++f) {
    Facet facet;
    for (std::uint32_t& v : facet) v = static_cast<std::uint32_t>(random.next() % vertices);
    m.mesh.facets.push_back(facet);
  }
  return m;
}

Moving wavy_sheet(int n, double step, Random& random) {
  Moving m;
  m.mesh = joined(grid_plate(n), translated(grid_plate(n), {0.1, 0.03, 0.02}));
  for (Vec3& p : m.mesh.positions) {
    p.z += 0.1 * std::sin(7 * p.x) * std::cos(5 * p.y);
    m.from.push_back(p);
    m.to.push_back(p + Vec3{random.uniform(-step, step), random.uniform(-step, step), random.uniform(-step, step)});
  }
  return m;
}

PlainPair plain_pair(Vertices a, Vertices b, bool with_itself) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  a.erase(std::unique(a.begin(), a.end()), a.end());
  b.erase(std::unique(b.begin(), b.end()), b.end());
  if (with_itself && b < a) std::swap(a, b);
  return {a, b};
}

std::vector<Vertices> plain_vertices(const Mesh& mesh) {
  std::set<Vertices> all;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) all.insert({v});
  return {all.begin(), all.end()};
}

std::vector<Vertices> plain_edges(const Mesh& mesh) {
  std::set<Vertices> all;
  for (const Facet& f : mesh.facets)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if (f[i] < f[j]) all.insert({f[i], f[j]});
  return {all.begin(), all.end()};
}

std::vector<Vertices> plain_facets(const Mesh& mesh) {
  std::vector<Vertices> all;
  for (const Facet& f : mesh.facets) all.push_back({f[0], f[1], f[2]});
  return all;
}

PlainPair plain_pair(const SurfaceTree& a, const SurfaceTree& b, const FeaturePair& pair) {
  const auto vertices = [&](const SurfaceTree& s, bool is_vertex, bool is_edge, std::uint32_t i) -> Vertices {
    if (is_vertex) return {i};
    if (is_edge) return {s.edges()[i][0], s.edges()[i][1]};
    return {s.facets()[i][0], s.facets()[i][1], s.facets()[i][2]};
  };
  const bool edges = pair.kind == PairKind::edge_edge;
  return plain_pair(vertices(a, pair.kind == PairKind::vertex_facet, edges, pair.a),
                    vertices(b, pair.kind == PairKind::facet_vertex, edges, pair.b), &a == &b);
}

long double plain_distance(const std::vector<Vec3>& points, const Vertices& a, const Vertices& b) {
  const auto at = [&](std::uint32_t v) { return Long3{points[v].x, points[v].y, points[v].z}; };
  if (a.size() == 1) return point_triangle(at(a[0]), at(b[0]), at(b[1]), at(b[2]));
  if (b.size() == 1) return plain_distance(points, b, a);
  return segment_segment(at(a[0]), at(a[1]), at(b[0]), at(b[1]));
}

}  // namespace morula::test
