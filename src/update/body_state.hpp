// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Body state: a body's parts, and how they follow its frames.
#pragma once

#include <morula/update/body.hpp>
#include <optional>

#include "update/points/local_points.hpp"
#include "update/rules/corner_walk.hpp"
#include "update/rules/engine.hpp"
#include "update/rules/modal.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
namespace detail {
struct BodyPlan;
}

struct Body::State {
  std::shared_ptr<const CoveredTree> model;
  UpdateOptions options;
  detail::LocalPoints local;
  std::vector<Spheref> spheres{};
  Vec3 origin{};
  BindReport report{};
  UpdateStatus work{};  // of a good update: the same every time
  detail::EngineList engines{};
  std::optional<detail::CornerWalk> raised{};  // conservative: the nodes of rules that do not cover by themselves
  std::vector<std::uint8_t> wraps{};           // of such a body: one flag per node of the rule `wrapped`
  std::optional<detail::ModalPoser> modal{};   // of a body with modes
  std::optional<detail::SkinPoser> skin{};     // of a body with a skin
  RuleTraits::Follows follows{};               // what some level asks for; positions where none asks for anything else
  std::vector<Vec3> rest_positions{}, moved_positions{};  // of a body with modes or a skin that also needs vertices
  std::uint64_t cover_id = 0;
  SphereState posed{};       // what queries read; show() brings it up to date
  std::uint64_t frames = 0;  // good updates
  bool current = true;       // the last update was good
  bool followed = true;      // all spheres are those of the points: the last update was good, and not lazy
  // After a lazy update, until all is reached: one flag per node that belongs to its frame, how many do not, and the
  // coordinates if it was by modes.
  bool lazy = false;
  std::size_t unreached = 0;
  std::vector<std::uint8_t> reached{};
  std::vector<double> coordinates_reached{};

  // At rest; throws like Body's constructors.
  static std::shared_ptr<State> made(const MeshView& mesh, std::shared_ptr<const CoveredTree> model,
                                     UpdateOptions options, Workers& workers);

  // Each moves the spheres, or says why not; what they return is to be counted.
  UpdateStatus follow(const PositionView& positions, Workers& workers) noexcept;
  UpdateStatus follow(const PositionView& positions, std::span<const VertexRange> changed, Workers& workers) noexcept;
  UpdateStatus follow(std::span<const double> coordinates, Workers& workers) noexcept;
  UpdateStatus follow(std::span<const AffineTransform> transforms, Workers& workers) noexcept;
  UpdateStatus counted(const UpdateStatus& status) noexcept;

  // Of a body that follows `exact` on all levels, at the pose that it was made for.
  void fit_leaves(Workers& workers);

  // After every change: what queries see. positions: of an update that was given some.
  UpdateStatus shown(const UpdateStatus& status, const PositionView* positions = nullptr) noexcept;
  void show() noexcept;

  // The same for the first `nodes` nodes, whole levels, of bodies that can be lazy with these.
  bool is_lazy(RuleTraits::Follows wanted) const noexcept;
  UpdateStatus follow_lazily(const PositionView& positions, std::size_t nodes, Workers& workers) noexcept;
  UpdateStatus follow_lazily(std::span<const double> coordinates, std::size_t nodes) noexcept;
  UpdateStatus counted_lazily(UpdateStatus status, std::size_t nodes) noexcept;
  std::size_t nodes_to_level(std::size_t level) const noexcept;
  std::size_t refresh_children(std::uint32_t node) noexcept;

  // Takes the largest of a rule's own radius and what the node owns.
  void raise(const detail::Rounding& rounding, Workers& workers) noexcept;

 private:
  // Of a new one, in this order.
  void bind(const detail::BodyPlan& plan, const detail::LocalPoints::Frame& rest, Workers& workers);
  void raise_at_rest(const detail::BodyPlan& plan, const detail::Rounding& rounding, Workers& workers);
  void note_promises(const detail::BodyPlan& plan);

  UpdateStatus refused_positions(const PositionView& positions) const noexcept;
  UpdateStatus refused_coordinates(std::span<const double> coordinates) const noexcept;
  UpdateStatus refused_transforms(std::span<const AffineTransform> transforms) const noexcept;
  // To positions, which move_positions has to form where some level needs them.
  template <class MovePositions>
  UpdateStatus follow_model(detail::RuleFrame frame, const MovePositions& move_positions, Workers& workers) noexcept;
  void write_spheres(const detail::RuleFrame& frame, Workers& workers) noexcept;
  void write_levels(const detail::RuleFrame& frame, Workers& workers) noexcept;
};

}  // namespace morula
