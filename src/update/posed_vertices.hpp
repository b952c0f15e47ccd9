// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Posed vertices: the positions of a body that modes or bones move, each computed when it is first read in a frame.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <morula/geometry/positions.hpp>
#include <morula/update/rules.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Several threads may call const members at once. Each position has the bits of move_by_modes() and move_by_skin(), so
/// it does not matter which thread computes it. The first read allocates 32 bytes per vertex.
class PosedVertices {
 public:
  /// rest: one per vertex.
  PosedVertices(std::vector<Vec3> rest, const UpdateOptions& options);
  /// In the frame of the other, with no vertex computed yet; it shares the rest positions. bind() has to follow.
  PosedVertices(const PosedVertices& other);
  PosedVertices& operator=(const PosedVertices&) = delete;
  ~PosedVertices() { delete store_.load(std::memory_order_acquire); }

  /// Reads skin and modes there from now on.
  void bind(const UpdateOptions& options) noexcept { options_ = &options; }
  /// Begins a frame: vertices move by these modes first, then by these bones. None: by no mode, or by no bone.
  /// Allocates nothing.
  void begin(std::span<const AffineTransform> transforms, std::span<const double> coordinates) noexcept;

  /// Position of a vertex in this frame. Cost: linear in its modes and influences for the first call in a frame, then
  /// constant.
  Vec3 operator[](std::uint32_t vertex) const;
  /// All positions; the view keeps its address. Cost: that of all vertices for the first call in a frame, then
  /// constant.
  const PositionView& all() const;

 private:
  // x, y, z belong to frame n if stamp is 2 n. One thread writes them while it is 2 n - 1.
  struct alignas(32) Slot {
    double x = 0, y = 0, z = 0;
    std::atomic<std::uint64_t> stamp{0};
  };
  struct Store {
    explicit Store(std::size_t count)
        : slots(std::make_unique<Slot[]>(count)), view(PositionView::strided(&slots[0].x, count, sizeof(Slot))) {}
    std::unique_ptr<Slot[]> slots;  // one per vertex
    PositionView view;
  };
  const Store& store() const;
  Vec3 pose(std::uint32_t vertex) const noexcept;

  std::shared_ptr<const std::vector<Vec3>> rest_;
  const UpdateOptions* options_;
  std::vector<AffineTransform> transforms_;
  std::vector<double> coordinates_;
  std::uint64_t frame_ = 0;
  mutable std::atomic<const Store*> store_{nullptr};
  mutable std::atomic<std::uint64_t> complete_{0};  // the last frame in which all slots were written
};

}  // namespace morula::detail
