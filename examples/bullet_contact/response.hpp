// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What is done about contacts: penalty forces, or positions that are moved apart (PBD). docs/how-to/responses.md has
// the formulas.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soft_bodies.hpp"

// Positive: how far two regions have to move apart until there is the skin between them.
inline double shortfall(const morula::ContactSurface& s) {
  return skin + (s.depth > 0 ? s.depth : -distance(s.on_a.point, s.on_b.point));
}

// One end of a contact as the solver sees it: three nodes and their weights.
struct End {
  std::array<btSoftBody::Node*, 3> nodes;
  std::array<double, 3> weights;

  End(Soft& body, const morula::SurfacePoint& p) : weights(p.barycentric) {
    for (int k = 0; k < 3; ++k) nodes[k] = &body.node(body.collider().mesh_facets()[p.facet][k]);
  }
  Vec3 velocity() const {
    Vec3 sum;
    for (int k = 0; k < 3; ++k) sum += weights[k] * to_vec3(nodes[k]->m_v);
    return sum;
  }
  // Every contact has a share of a node's mass, as large as its wish, so that all of them together do not push it too
  // far.
  double inverse_mass(const Soft& body, const std::vector<double>& wishes, double wish) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += weights[k] * weights[k] * nodes[k]->m_im * wishes[body.number(*nodes[k])] / wish;
    return sum;
  }
  double inverse_mass() const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += weights[k] * weights[k] * nodes[k]->m_im;
    return sum;
  }
  Vec3 point() const {
    Vec3 sum;
    for (int k = 0; k < 3; ++k) sum += weights[k] * to_vec3(nodes[k]->m_x);
    return sum;
  }
  void move(const Vec3& impulse) const {
    for (int k = 0; k < 3; ++k) nodes[k]->m_x += to_bullet(nodes[k]->m_im * weights[k] * impulse);
  }
  void push(const Vec3& force) const {
    for (int k = 0; k < 3; ++k) nodes[k]->m_f += to_bullet(weights[k] * force);
  }
};

// Pushes the nodes of both bodies apart. Returns |sum of forces| / sum of |forces|.
inline double push_apart(Soft& a, Soft& b, const morula::Contacts& found) {
  constexpr double stiffness = 0.5, damping = 1.0;  // of what would do it within one step; above 1 it would swing
  struct Push {
    End a, b;
    Vec3 normal;
    double wish;  // by how much the speed along the normal ought to change
  };
  std::vector<Push> pushes;
  std::vector<double> wishes_a(a.node_count()), wishes_b(b.node_count());  // of all contacts that push at a node
  for (const morula::ContactSurface& s : found.surfaces) {
    const End end_a(a, s.on_a), end_b(b, s.on_b);
    const double speed = dot(end_a.velocity() - end_b.velocity(), s.normal);
    const double wish = stiffness * shortfall(s) / step_seconds - damping * speed;
    if (shortfall(s) <= 0 || wish <= 0) continue;
    pushes.push_back({end_a, end_b, s.normal, wish});
    for (const btSoftBody::Node* n : end_a.nodes) wishes_a[a.number(*n)] += wish;
    for (const btSoftBody::Node* n : end_b.nodes) wishes_b[b.number(*n)] += wish;
  }
  for (const Push& p : pushes) {
    const double mass = 1 / (p.a.inverse_mass(a, wishes_a, p.wish) + p.b.inverse_mass(b, wishes_b, p.wish));
    const Vec3 force = mass * p.wish / step_seconds * p.normal;
    p.a.push(force);
    p.b.push(-force);
  }
  Vec3 sum;
  double total = 0;
  for (Soft* body : {&a, &b})
    for (std::size_t n = 0; n < body->node_count(); ++n) {
      const Vec3 force = to_vec3(body->node(n).m_f);
      sum += force, total += length(force);
    }
  return total > 0 ? length(sum) / total : 0;
}

// Moves the nodes of both bodies apart, and gives them the speed of that. Returns |sum of impulses| / sum of
// |impulses|, less what rounding positions to float explains: a half ulp of each coordinate for every move of a node.
inline double move_apart(Soft& a, Soft& b, const morula::Contacts& found) {
  constexpr double share = 0.3;  // of the shortfall: depths are upper bounds, and all of it would throw bodies apart
  constexpr int rounds = 4;
  struct Constraint {
    End a, b;
    Vec3 normal;
    double target;  // of dot(a - b, normal)
  };
  std::vector<Constraint> constraints;
  for (const morula::ContactSurface& s : found.surfaces) {
    if (shortfall(s) <= 0) continue;
    const End end_a(a, s.on_a), end_b(b, s.on_b);
    constraints.push_back(
        {end_a, end_b, s.normal, dot(end_a.point() - end_b.point(), s.normal) + share * shortfall(s)});
  }
  std::vector<btVector3> before;
  for (Soft* body : {&a, &b})
    for (std::size_t n = 0; n < body->node_count(); ++n) before.push_back(body->node(n).m_x);
  std::size_t moves = 0;
  for (int round = 0; round < rounds; ++round)
    for (const Constraint& c : constraints) {
      const double missing = c.target - dot(c.a.point() - c.b.point(), c.normal);
      if (missing <= 0) continue;
      const Vec3 impulse = missing / (c.a.inverse_mass() + c.b.inverse_mass()) * c.normal;
      c.a.move(impulse);
      c.b.move(-impulse);
      moves += 2 * 3;  // three nodes of each body
    }
  Vec3 sum;
  double total = 0, reach = 0, heaviest = 0;
  auto from = before.begin();
  for (Soft* body : {&a, &b})
    for (std::size_t n = 0; n < body->node_count(); ++n, ++from) {
      btSoftBody::Node& node = body->node(n);
      const btVector3 moved = node.m_x - *from;
      node.m_v += moved / btScalar(step_seconds);
      sum += to_vec3(moved) / node.m_im, total += length(to_vec3(moved)) / node.m_im;
      reach = std::max({reach, length(to_vec3(*from)), length(to_vec3(node.m_x))});
      heaviest = std::max(heaviest, 1.0 / node.m_im);
    }
  constexpr double half_ulp = 0x1p-24;
  const double rounding = std::sqrt(3.0) * half_ulp * reach * heaviest * static_cast<double>(moves);
  return total > 0 ? std::max(0.0, length(sum) - rounding) / total : 0;
}
