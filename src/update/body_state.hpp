// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Body state: a body's parts, and how they follow its frames.
#pragma once

#include <algorithm>
#include <morula/update/body.hpp>
#include <optional>
#include <span>
#include <vector>

#include "update/points/local_points.hpp"
#include "update/posed_vertices.hpp"
#include "update/rules/corner_walk.hpp"
#include "update/rules/engine.hpp"
#include "update/rules/modal.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
namespace detail {

struct BodyPlan;

/// The frame of the last lazy update, which nodes reach one by one: Body::update_lazily begins it, refresh_children
/// adds to it, and it is complete when all nodes are reached or a good update has moved all at once.
class LazyFrame {
 public:
  LazyFrame() = default;
  LazyFrame(std::size_t node_count, std::size_t mode_count) : reached_(node_count), coordinates_(mode_count) {}

  bool is_complete() const noexcept { return unreached_ == 0; }
  bool has(std::uint32_t node) const noexcept { return is_complete() || reached_[node] != 0; }
  /// Begins with the first `nodes` nodes.
  void begin(std::size_t nodes) noexcept {
    unreached_ = reached_.size() - nodes;
    std::fill(reached_.begin(), reached_.end(), std::uint8_t{0});
    std::fill_n(reached_.begin(), nodes, std::uint8_t{1});
  }
  /// Adds a node that is not reached yet.
  void add(std::uint32_t node) noexcept {
    reached_[node] = 1;
    --unreached_;
  }
  void complete() noexcept { unreached_ = 0; }

  /// Keeps the coordinates of a lazy update by modes, one for each mode.
  void keep(std::span<const double> coordinates) noexcept {
    std::copy(coordinates.begin(), coordinates.end(), coordinates_.begin());
  }
  std::span<const double> coordinates() const noexcept { return coordinates_; }

 private:
  std::vector<std::uint8_t> reached_;  // flags of an incomplete frame, one per node
  std::size_t unreached_ = 0;
  std::vector<double> coordinates_;
};

}  // namespace detail

// made() fills the members from the first to the last; `work` and `posed` gather the additions of each of its steps.
struct Body::State {
  // Inputs that move the body besides positions: made() decides which the body follows, bind() makes the rest.
  struct Models {
    RuleTraits::Follows follows{};  // the input that the levels follow; positions if no level follows another one
    std::optional<detail::ModalPoser> modal{};  // poser of a body with modes
    std::optional<detail::SkinPoser> skin{};    // poser of a body with a skin
    // Empty unless a level needs vertices as well; each update by modes or bones writes the moved ones.
    std::vector<Vec3> rest_positions{}, moved_positions{};
    std::optional<detail::PosedVertices> vertices{};  // of a body that follows modes or bones and writes no positions
  };
  // The nodes of a conservative body whose rules do not cover by themselves: raise_at_rest() makes it.
  struct Raising {
    detail::CornerWalk walk;
    std::vector<std::uint8_t> wraps;  // flag of each node of the tree, 1 if it has the rule `wrapped`
  };

  std::shared_ptr<const CoveredTree> model;
  std::shared_ptr<const UpdateOptions> options;  // copies of a body share them: modes, skin and training are large
  detail::LocalPoints local;                     // each update by positions moves them
  Vec3 origin{};                                 // origin of the spheres; each good update writes origin and rounding
  Models models{};
  std::vector<Spheref> spheres{};  // spheres of the tree until bind()
  detail::EngineList engines{};    // bind() makes them from all of the above, and lets them write spheres and report
  BindReport report{};
  std::optional<Raising> raising{};
  detail::LazyFrame lazy{};
  bool followed = true;  // all spheres are those of the points: the last update was good, and not lazy
  UpdateStatus work{};   // work of a good update: the same every time
  SphereState posed{};   // state that queries read; counted() writes frame and current, show() the spheres

  // Makes the state at rest; throws like Body's constructors.
  static std::shared_ptr<State> made(const MeshView& mesh, std::shared_ptr<const CoveredTree> model,
                                     UpdateOptions options, Workers& workers);

  // Each follow() moves the spheres, or returns the reason why it did not; counted() must count the result.
  UpdateStatus follow(const PositionView& positions, Workers& workers) noexcept;
  UpdateStatus follow(const PositionView& positions, std::span<const VertexRange> changed, Workers& workers) noexcept;
  UpdateStatus follow(std::span<const double> coordinates, Workers& workers) noexcept;
  // morphs: none for a body that may lack modes, all of them 0.
  UpdateStatus follow(std::span<const AffineTransform> transforms, std::optional<std::span<const double>> morphs,
                      Workers& workers) noexcept;
  UpdateStatus counted(const UpdateStatus& status) noexcept;

  // Fits the leaves of a body that follows `exact` on all levels, at the pose that it was made for.
  void fit_leaves(Workers& workers);

  // Updates the sphere state that queries read, after every change. positions: of an update by positions.
  UpdateStatus shown(const UpdateStatus& status, const PositionView* positions = nullptr) noexcept;
  void show() noexcept;

  // Counterparts of lazy updates: the first `nodes` nodes, whole levels, of bodies that can be lazy with `wanted`.
  bool is_lazy(RuleTraits::Follows wanted) const noexcept;
  UpdateStatus follow_lazily(const PositionView& positions, std::size_t nodes, Workers& workers) noexcept;
  UpdateStatus follow_lazily(std::span<const double> coordinates, std::size_t nodes) noexcept;
  UpdateStatus counted_lazily(UpdateStatus status, std::size_t nodes) noexcept;
  std::size_t nodes_to_level(std::size_t level) const noexcept;
  std::size_t refresh_children(std::uint32_t node) noexcept;

  // Raises each radius to the larger of the rule's own and the one that the node's region needs.
  void raise(const detail::Rounding& rounding, Workers& workers) noexcept;

 private:
  // Steps of made(), in this order.
  void bind(const detail::BodyPlan& plan, const detail::LocalPoints::Frame& rest, Workers& workers);
  void raise_at_rest(const detail::BodyPlan& plan, const detail::Rounding& rounding, Workers& workers);
  void note_promises(const detail::BodyPlan& plan);

  UpdateStatus check_positions(const PositionView& positions) const noexcept;
  UpdateStatus check_coordinates(std::span<const double> coordinates) const noexcept;
  // morphed: written if the transforms and morphs are good.
  UpdateStatus check_transforms(std::span<const AffineTransform> transforms,
                                std::optional<std::span<const double>> morphs,
                                detail::MorphedRest& morphed) const noexcept;
  // Moves the spheres to positions, which move_positions has to compute if a level needs them.
  template <class MovePositions>
  UpdateStatus follow_model(detail::RuleFrame frame, const MovePositions& move_positions, Workers& workers) noexcept;
  void write_spheres(const detail::RuleFrame& frame, Workers& workers) noexcept;
  void write_levels(const detail::RuleFrame& frame, Workers& workers) noexcept;
};

}  // namespace morula
