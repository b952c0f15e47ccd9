// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `modal`: spheres that follow the coordinates of a modal model and read no vertex [james2004].
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "update/rules/engine.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula::detail {

/// Throws std::invalid_argument unless the modes have the mesh's vertices, one displacement each, all finite.
void require_modes(const Modes& modes, const MeshView& mesh);

/// Values that all nodes share at some coordinates.
struct ModalPose {
  std::span<const double> coordinates;
  Vec3 origin;     ///< origin of the spheres, as LocalPoints computes it for the moved positions, bit for bit
  double pad = 0;  ///< length that radii are rounded up by (modal.cpp)
};

class ModalPoser {
 public:
  /// used_vertices: vertices of facets; the lowest guides the origin. rest_origin, size: as in LocalPoints.
  ModalPoser(const MeshView& mesh, const CoveredTree& model, const Modes& modes,
             std::span<const std::uint32_t> used_vertices, const Vec3& rest_origin, double size);

  std::size_t mode_count() const { return reach_.size(); }
  /// Whether the coordinates are finite and move nothing farther than spheres in single precision can follow. If not,
  /// first_bad is the lowest that is not finite or, when all are, the one that moves the body most.
  bool accepts(std::span<const double> coordinates, std::size_t& first_bad) const noexcept;
  /// coordinates must be accepted; they are not copied.
  ModalPose pose(std::span<const double> coordinates) const noexcept;
  /// The coordinates as those of morph targets, ahead of bones; accepted and not copied, as above.
  MorphedRest morphed(std::span<const double> coordinates) const noexcept;

  /// Rows of nodes, unlike those of vertices, may be longer than the displacements that they bound; they enter pads
  /// alone.
  void add_row(std::size_t j, double largest) { largest_row_[j] = std::max(largest_row_[j], largest); }

 private:
  // Largest |component| per mode: of a vertex' displacement, and of any factor of its coordinate.
  std::vector<double> reach_, largest_row_;
  std::vector<Vec3> guide_;  // displacement per mode of the vertex that the origin moves with
  Vec3 guide_rest_, rest_origin_;
  double size_;
  double rest_reach_ = 0;  // largest |coordinate| at rest, of vertices and centers
  double weight_slack_ = 0;
};

class ModalRule final : public RuleEngine {
 public:
  /// Binds every node on a level with this rule: reads the rows of its owned corners, for each such level again.
  explicit ModalRule(const Binding& binding);
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<ModalRule>(*this); }

  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
              Workers& workers) noexcept override;
  bool is_lazy() const override { return true; }
  void update_one(std::uint32_t node, const RuleFrame& frame, std::span<Spheref> spheres) noexcept override {
    spheres[node] = sphere_of(slot_[node], *frame.modes);
  }
  std::optional<Spheref> sphere_alone(std::uint32_t node, const RuleFrame& frame) const noexcept override {
    if (slot_[node] == no_node) return std::nullopt;
    return sphere_of(slot_[node], *frame.modes);
  }

 private:
  struct Node {
    std::uint32_t node;  // ascending
    Sphere rest{};       // the tree's center, and the radius that contains the owned corners
  };
  void bind(std::size_t slot, const MeshView& mesh, const Cover& cover, const Modes& modes,
            std::span<const std::uint32_t> corners);
  Spheref sphere_of(std::size_t slot, const ModalPose& pose) const noexcept;
  Sphere by_shifts(std::size_t slot, std::span<const double> coordinates) const noexcept;
  Sphere by_gradients(std::size_t slot, std::span<const double> coordinates) const noexcept;

  std::size_t mode_count_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> slot_;         // slot of a node in nodes_; no_node if another rule serves
  std::vector<ModeRow> rows_;               // slot after slot, mode_count_ each
  std::vector<LinearModeRow> linear_rows_;  // rows in the layout of rows_; empty with ModalBound::shift
};

}  // namespace morula::detail
