// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Interrupt: ends long calls of a thread from within, for Ctrl-C, a cancel button or the caller's own deadline.
#pragma once

#include <functional>
#include <memory>

namespace morula {
namespace detail {
struct Interruption;
}

/// While an Interrupt lives, calls of its thread into the library call a function at intervals; an exception of the
/// function ends the call.
///
///     const morula::Interrupt interrupt([&] { if (is_cancelled()) throw Cancelled(); });
///     query.run(a, b, workers);
///
/// The call passes the exception of `ask` on. The object stays as after an exception of a callback
/// (docs/reference/conventions.md): as it was, or empty, and ready for the next call. Every later call ends the same
/// way until the Interrupt is destroyed.
///
/// ask: runs on the thread that made the Interrupt, up to a million times a second, usually at least every 10 ms, and
/// at times only after a few tenths of a second. It should read a clock and do expensive work every 20 ms at most. An
/// interrupted write leaves no file, or the existing one. Workers of a pool finish their current chunks.
/// `ask` does not run during a loop if an executor of the host keeps the caller's thread out of its loops. It does not
/// run in noexcept calls, nor in SurfaceTree::update and follow: they take a frame's time. It does not run while
/// tinygltf decodes the JSON of a glTF file, while tinyxml2 reads a robot's file, and while the system writes a file to
/// disk.
///
/// If several exist, the last one made is used. The thread that made them destroys them, the last one first.
class Interrupt {
 public:
  /// Throws std::invalid_argument for an empty function.
  explicit Interrupt(std::function<void()> ask);
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

 private:
  std::unique_ptr<detail::Interruption> state_;
};

}  // namespace morula
