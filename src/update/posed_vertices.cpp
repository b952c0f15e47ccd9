// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/posed_vertices.hpp"

#include <morula/parallel/threads.hpp>
#include <thread>
#include <utility>

#include "parallel/float_environment.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula::detail {

PosedVertices::PosedVertices(std::vector<Vec3> rest, const UpdateOptions& options)
    : rest_(std::make_shared<const std::vector<Vec3>>(std::move(rest))), options_(&options) {
  transforms_.reserve(options.skin.bone_count);
  coordinates_.reserve(options.modes.mode_count);
}

PosedVertices::PosedVertices(const PosedVertices& other) : rest_(other.rest_), options_(nullptr), frame_(other.frame_) {
  transforms_.reserve(other.transforms_.capacity());
  transforms_.assign(other.transforms_.begin(), other.transforms_.end());
  coordinates_.reserve(other.coordinates_.capacity());
  coordinates_.assign(other.coordinates_.begin(), other.coordinates_.end());
}

void PosedVertices::begin(std::span<const AffineTransform> transforms, std::span<const double> coordinates) noexcept {
  transforms_.assign(transforms.begin(), transforms.end());
  coordinates_.assign(coordinates.begin(), coordinates.end());
  // mutant posed-one-frame: `++frame_;` -> `frame_ = 1;`
  ++frame_;
}

// Of threads that come first at once, one keeps what it has made.
const PosedVertices::Store& PosedVertices::store() const {
  const Store* known = store_.load(std::memory_order_acquire);
  if (known != nullptr) return *known;
  auto made = std::make_unique<const Store>(rest_->size());
  if (store_.compare_exchange_strong(known, made.get(), std::memory_order_acq_rel, std::memory_order_acquire))
    return *made.release();
  return *known;
}

// The operations of move_by_modes() and move_by_skin() in their order.
Vec3 PosedVertices::pose(std::uint32_t vertex) const noexcept {
  const StandardFloats standard;
  const Vec3 position = morphed_vertex(options_->modes, vertex, (*rest_)[vertex], coordinates_);
  return transforms_.empty() ? position : skinned_vertex(options_->skin, vertex, position, transforms_);
}

// A thread that finds a slot unwritten computes the position for itself, and writes the slot if no other thread does.
Vec3 PosedVertices::operator[](std::uint32_t vertex) const {
  Slot& slot = store().slots[vertex];
  const std::uint64_t written = 2 * frame_;
  std::uint64_t stamp = slot.stamp.load(std::memory_order_acquire);
  if (stamp == written) return {slot.x, slot.y, slot.z};
  const Vec3 position = pose(vertex);
  if (stamp != written - 1 && slot.stamp.compare_exchange_strong(stamp, written - 1, std::memory_order_relaxed)) {
    slot.x = position.x, slot.y = position.y, slot.z = position.z;
    slot.stamp.store(written, std::memory_order_release);
  }
  return position;
}

const PositionView& PosedVertices::all() const {
  const Store& all = store();
  if (complete_.load(std::memory_order_acquire) == frame_) return all.view;
  const auto count = static_cast<std::uint32_t>(rest_->size());
  for (std::uint32_t v = 0; v < count; ++v) static_cast<void>((*this)[v]);
#if MORULA_STANDARD_THREADS
  // Another thread may be writing the last of its slots.
  for (std::uint32_t v = 0; v < count; ++v)
    while (all.slots[v].stamp.load(std::memory_order_acquire) != 2 * frame_) std::this_thread::yield();
#endif
  complete_.store(frame_, std::memory_order_release);
  return all.view;
}

}  // namespace morula::detail
