// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Interrupt: ends long calls of a thread from within: for Ctrl-C, a cancel button, a deadline of the caller's own.
#pragma once

#include <functional>
#include <memory>

namespace morula {
namespace detail {
struct Interruption;
}

/// While one lives, calls that its thread makes into the library ask now and then whether to go on.
///
///     const morula::Interrupt interrupt([&] { if (is_cancelled()) throw Cancelled(); });
///     query.run(a, b, workers);
///
/// The call ends with what `ask` throws, and leaves behind what a callback that throws leaves
/// (docs/reference/conventions.md): the object is as it was before, or empty, and may be asked again. The same
/// exception ends every later call, until the Interrupt is destroyed.
///
/// ask: called on the thread that made the Interrupt: up to a million times a second, mostly every 10 ms at least, and
/// at times only after some tenths of a second. Look at a clock in it, and do what costs more every 20 ms. A write
/// that ends so leaves no file, or the one that was there. Workers of a pool end with the chunks that they are in.
/// Where an executor of the host keeps the caller's thread out of its loops, nobody asks during a loop. Calls that are
/// noexcept, and SurfaceTree::update and follow, do not ask: they take a frame's time. Nor do tinygltf while it decodes
/// the JSON of a glTF file, tinyxml2 while it reads a robot's, and the system while it brings a file to the disk.
///
/// Of several, the one made last is asked. Destroyed by the thread that made it, the last one first.
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
