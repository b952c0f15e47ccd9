// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Snapshots: passes the newest state from one thread to another; neither thread ever waits.
//
//   struct Organ {                                                      // what the reader needs, and nothing shared
//     explicit Organ(const morula::Mesh& mesh, const morula::Body& first)
//         : positions(mesh.positions), body(first), collider(mesh, body) {
//       if (!body.update(positions)) throw std::runtime_error("bad positions");  // before, it reads those of `first`
//     }
//     std::vector<morula::Vec3> positions;                              // the body's view is of this array
//     morula::Body body;                                                // a copy: it shares tree and cover
//     morula::Collider collider;                                        // of this slot's body
//   };
//   morula::Snapshots<Organ> organs(mesh, first);
//   // thread of the solver, 25 times a second
//   Organ& next = organs.back();
//   solver.copy_positions(next.positions);
//   if (next.body.update(next.positions)) organs.publish();
//   // thread of the device, 1,000 times a second
//   organs.refresh();
//   const morula::HapticStep step = probe.step(organs.front().collider, device_point());
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace morula {

/// Three slots of a Value: one that the writer fills, one that the reader uses, and the newest published one between
/// them. One thread may call back() and publish(), one other thread front() and refresh(). All calls are wait-free:
/// they take an exchange of one byte, whatever the other thread does. The reader sees whole snapshots in the
/// order of publication; refresh() returns each at most once, and skips those that a newer one has replaced.
///
/// A slot belongs to its thread until that thread's next publish() or refresh(). So a Value owns all it reads: a Body,
/// the positions that the body was updated with, and a Collider of this body. Slots never move. A slot that comes back
/// to the writer holds an older state, of two or more publications ago; the writer replaces all of it.
template <class Value>
class Snapshots {
 public:
  /// Makes each slot as Value(arguments...). The reader's first slot is one of these.
  template <class... Arguments>
  explicit Snapshots(const Arguments&... arguments)
      : slots_{Slot{Value(arguments...)}, Slot{Value(arguments...)}, Slot{Value(arguments...)}} {}
  Snapshots(const Snapshots&) = delete;
  Snapshots& operator=(const Snapshots&) = delete;

  /// The slot that the writer fills. Only for the writer.
  Value& back() { return slots_[back_].value; }
  /// Publishes the writer's slot, and gives the writer another one. Only for the writer.
  void publish() noexcept {
    // The release publishes what was written to the slot; the acquire orders the reader's use of the slot that comes
    // back before the next writes to it.
    back_ = between_.exchange(static_cast<std::uint8_t>(back_ | is_new), std::memory_order_acq_rel) & number;
  }

  /// Takes the newest published snapshot, if there is one that the reader has not had. Returns true if the slot has
  /// changed. Only for the reader.
  bool refresh() noexcept {
    if ((between_.load(std::memory_order_relaxed) & is_new) == 0) return false;
    front_ = between_.exchange(front_, std::memory_order_acq_rel) & number;
    return true;
  }
  /// The slot that the reader uses. Only for the reader.
  Value& front() { return slots_[front_].value; }
  const Value& front() const { return slots_[front_].value; }

 private:
  static constexpr std::uint8_t number = 3, is_new = 4;
  struct alignas(64) Slot {
    Value value;
  };

  std::array<Slot, 3> slots_;
  // On cache lines of their own, so that the threads do not slow each other.
  alignas(64) std::uint8_t front_ = 0;                // the reader's
  alignas(64) std::atomic<std::uint8_t> between_{1};  // number of a slot, with is_new if the reader has not had it
  alignas(64) std::uint8_t back_ = 2;                 // the writer's
};

}  // namespace morula
