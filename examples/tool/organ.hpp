// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The organ and its thread: springs in a lattice, 25 frames a second, under the newest forces of the tool.
#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <morula/morula.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "../response/soft_body.hpp"

using morula::Vec3;
using response::SoftBody;

/// A state of the organ for the haptic thread: it owns all that the query reads.
struct OrganState {
  OrganState(const morula::Mesh& surface, const morula::Body& first, const morula::Collider& tool)
      : positions(surface.positions), body(first), collider(surface, body), query(tool, collider) {
    if (!body.update(positions)) throw std::runtime_error("bad positions");  // until here it reads those of `first`
  }
  int frame = 0;
  std::vector<Vec3> positions;
  morula::Body body;
  morula::Collider collider;
  morula::ContactPatchQuery query;
};

/// Forces on the vertices of the organ, for the solver's thread.
struct Reaction {
  explicit Reaction(std::size_t vertices) : force(vertices) {}
  std::vector<Vec3> force;
};

/// 1.2 × 1.2 × 0.4, its top at z = 0, its bottom held.
class Organ {
 public:
  explicit Organ(const morula::Collider& tool)
      : body_({12, 12, 4}, mass,
              [](double i, double j, double k) {
                return Vec3{0.1 * i - 0.6, 0.1 * j - 0.6, 0.1 * k - 0.4};
              }),
        states(body_.surface.mesh, body_.body, tool),
        reactions(body_.surface.mesh.vertex_count()) {
    for (std::size_t p = 0; p < body_.x.size(); ++p)
      if (body_.x[p].z < -0.39) body_.mass[p] = std::numeric_limits<double>::infinity();
  }

  void start() {
    thread_ = std::thread([this] { run(); });
  }
  /// Ends the thread. Returns the force that holds the bottom.
  Vec3 stop() {
    is_done_ = true;
    thread_.join();
    return held_;
  }
  std::size_t facet_count() const { return body_.surface.mesh.facet_count(); }

 private:
  static constexpr double stiffness = 2000, damping = 0.3, drag = 5, mass = 20;

  void run() {
    const auto begin = std::chrono::steady_clock::now();
    for (int frame = 1; !is_done_; ++frame) {
      reactions.refresh();
      advance(reactions.front().force);
      OrganState& next = states.back();
      next.frame = frame;
      for (std::uint32_t i = 0; i < next.positions.size(); ++i) next.positions[i] = body_.x[body_.point(i)];
      if (next.body.update(next.positions)) states.publish();
      std::this_thread::sleep_until(begin + frame * std::chrono::milliseconds(40));
    }
  }

  /// A frame of explicit steps. pushed: forces on the vertices of the surface.
  void advance(const std::vector<Vec3>& pushed) {
    constexpr int substeps = 80;
    constexpr double h = 0.04 / substeps;
    for (int k = 0; k < substeps; ++k) {
      std::vector<Vec3> forces(body_.x.size());
      for (std::uint32_t i = 0; i < pushed.size(); ++i) forces[body_.point(i)] += pushed[i];
      body_.add_spring_forces(stiffness, damping, forces);
      held_ = {};
      for (std::size_t p = 0; p < body_.x.size(); ++p) {
        if (std::isinf(body_.mass[p])) held_ -= forces[p];
        body_.v[p] += h * (forces[p] / body_.mass[p] - drag * body_.v[p]);
        body_.x[p] += h * body_.v[p];
      }
    }
  }

  SoftBody body_;
  Vec3 held_;
  std::atomic<bool> is_done_ = false;
  std::thread thread_;

 public:
  morula::Snapshots<OrganState> states;   // the haptic thread reads them
  morula::Snapshots<Reaction> reactions;  // the haptic thread writes them
};
