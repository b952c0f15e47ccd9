// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <morula/update/body.hpp>

#include "geometry/hash.hpp"
#include "parallel/float_environment.hpp"
#include "update/body_state.hpp"
#include "update/fitted_body.hpp"

namespace morula {
using namespace detail;

Body::Body(const MeshView& mesh, const CoveredTree& model, UpdateOptions options, Workers& workers)
    : Body(mesh, std::make_shared<const CoveredTree>(model), std::move(options), workers) {}

Body::Body(const MeshView& mesh, CoveredTree&& model, UpdateOptions options, Workers& workers)
    : Body(mesh, std::make_shared<const CoveredTree>(std::move(model)), std::move(options), workers) {}

Body::Body(const MeshView& mesh, std::shared_ptr<const CoveredTree> model, UpdateOptions options, Workers& workers) {
  const StandardFloats standard;
  state_ = State::made(mesh, std::move(model), std::move(options), workers);
}

// Colliders keep the state for longer: it must not look like a body at rest.
void Body::end() noexcept {
  // mutant body-assigned-to: `if (state_) state_->posed.current = false, state_->posed.ended = true` -> ``
  if (state_) state_->posed.current = false, state_->posed.ended = true;
}

Body::~Body() {
  end();
}
Body::Body(const Body& other) : state_(std::make_shared<State>(*other.state_)) {
  State& s = *state_;
  s.posed.shared = state_;
  s.show();
  const std::vector<Vec3>& others = other.state_->models.moved_positions;
  const bool formed_there = s.posed.positions && !others.empty() &&
                            s.posed.positions->address(0) == reinterpret_cast<const std::byte*>(others.data());
  if (formed_there) s.posed.positions = PositionView(s.models.moved_positions);
}
Body& Body::operator=(const Body& other) {
  return *this = Body(other);
}
Body::Body(Body&&) noexcept = default;
Body& Body::operator=(Body&& other) noexcept {
  if (this == &other) return *this;
  end();
  state_ = std::move(other.state_);
  return *this;
}

UpdateStatus Body::update(const PositionView& positions, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(positions, workers)), &positions);
}

UpdateStatus Body::update(const PositionView& positions, std::span<const VertexRange> changed,
                          Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(positions, changed, workers)), &positions);
}

UpdateStatus Body::update_modal(std::span<const double> coordinates, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(coordinates, workers)));
}

UpdateStatus Body::update_skinned(std::span<const AffineTransform> transforms, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(transforms, std::nullopt, workers)));
}

UpdateStatus Body::update_skinned(std::span<const AffineTransform> transforms, std::span<const double> morphs,
                                  Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(transforms, morphs, workers)));
}

UpdateStatus Body::update_lazily(const PositionView& positions, std::size_t level, Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  if (!s.is_lazy(RuleTraits::Follows::positions)) return update(positions, workers);
  const std::size_t nodes = s.nodes_to_level(level);
  return s.shown(s.counted_lazily(s.follow_lazily(positions, nodes, workers), nodes), &positions);
}

UpdateStatus Body::update_modal_lazily(std::span<const double> coordinates, std::size_t level,
                                       Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  if (!s.is_lazy(RuleTraits::Follows::modes)) return update_modal(coordinates, workers);
  const std::size_t nodes = s.nodes_to_level(level);
  return s.shown(s.counted_lazily(s.follow_lazily(coordinates, nodes), nodes));
}

std::size_t Body::refresh_children(std::uint32_t node) noexcept {
  const StandardFloats standard;
  const std::size_t brought = state_->refresh_children(node);
  state_->show();
  return brought;
}

bool Body::is_fresh(std::uint32_t node) const {
  return state_->lazy.has(node);
}

bool Body::is_complete() const {
  return state_->lazy.is_complete();
}

Sphere Body::modal_sphere(std::uint32_t node, std::span<const double> coordinates) const noexcept {
  const StandardFloats standard;
  const State& s = *state_;
  std::size_t bad = 0;
  if (s.models.follows == RuleTraits::Follows::modes && coordinates.size() == s.models.modal->mode_count() &&
      s.models.modal->accepts(coordinates, bad)) {
    const ModalPose pose = s.models.modal->pose(coordinates);
    for (const auto& engine : s.engines)
      if (const auto sphere = engine->sphere_alone(node, {.origin = pose.origin, .modes = &pose}))
        return {pose.origin + Vec3(sphere->center), static_cast<double>(sphere->radius)};
  }
  return {s.model->tree.spheres[node].center, std::numeric_limits<double>::infinity()};
}

std::span<const Spheref> Body::spheres() const {
  return state_->spheres;
}

Vec3 Body::origin() const {
  return state_->origin;
}

Sphere Body::sphere(std::uint32_t node) const {
  const StandardFloats standard;
  const Spheref& s = state_->spheres[node];
  return {state_->origin + Vec3(s.center), static_cast<double>(s.radius)};
}

void Body::copy_spheres(std::vector<Sphere>& spheres) const {
  spheres.resize(state_->spheres.size());
  const StandardFloats standard;
  const Vec3 origin = state_->origin;
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    const Spheref& s = state_->spheres[i];
    spheres[i] = {origin + Vec3(s.center), static_cast<double>(s.radius)};
  }
}

SphereTree Body::current_tree() const {
  SphereTree tree = state_->model->tree;
  tree.nested = state_->posed.nested;
  copy_spheres(tree.spheres);
  return tree;
}

Certificate Body::certify(const PositionView& positions, Workers& workers) const {
  if (positions.size() != vertex_count())
    throw std::invalid_argument("certify: " + std::to_string(positions.size()) + " positions, but the mesh has " +
                                std::to_string(vertex_count()) + " vertices");
  std::vector<Sphere> now;
  copy_spheres(now);
  return morula::certify(cover(), positions, now, workers);
}

std::uint64_t Body::hash() const {
  Hasher hash;
  hash.add(state_->origin);
  for (const Spheref& s : state_->spheres) hash.add(s);
  return hash.value();
}

const SphereState& Body::sphere_state() const {
  return state_->posed;
}

std::uint64_t Body::frame() const {
  return state_->posed.frame;
}

bool Body::is_current() const {
  return state_->posed.current;
}

std::uint64_t Body::cover_id() const {
  return state_->posed.cover_id;
}

const CoveredTree& Body::model() const {
  return *state_->model;
}

const SphereTree& Body::rest_tree() const {
  return state_->model->tree;
}

const Cover& Body::cover() const {
  return state_->model->cover;
}

const UpdateOptions& Body::options() const {
  return *state_->options;
}

const BindReport& Body::bind_report() const {
  return state_->report;
}

std::size_t Body::vertex_count() const {
  return state_->model->cover.vertex_count;
}

Body detail::FittedBody::make(const MeshView& mesh, std::shared_ptr<const CoveredTree> model, bool fits_leaves,
                              Workers& workers) {
  Body body(mesh, std::move(model), {}, workers);
  if (fits_leaves) body.state_->fit_leaves(workers);
  return body;
}

}  // namespace morula
