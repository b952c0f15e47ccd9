// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What planners' queries share: a world and a query, which several threads of Python may use at once.
#pragma once

#include <morula/robot/configurations.hpp>
#include <mutex>
#include <utility>

#include "holders.hpp"
#include "robots.hpp"

namespace morula::python {

/// A value whose copies share its data. Calls work on a copy, so a change in another thread does not disturb them.
template <class Value>
class Guarded {
 public:
  Guarded() = default;
  explicit Guarded(Value&& value) : value_(std::move(value)) {}
  Value copy() const {
    const std::scoped_lock lock(mutex_);
    return value_;
  }
  /// Runs f on the value without the GIL, which a thread that holds the value does not need.
  template <class F>
  auto change(const F& f) {
    return without_gil([&] {
      const std::scoped_lock lock(mutex_);
      return f(value_);
    });
  }

 private:
  Value value_;
  mutable std::mutex mutex_;
};

using HeldWorld = Guarded<robot::World>;
using HeldQuery = Guarded<robot::ConfigurationQuery>;

void bind_robot_world(nb::module_& m);
void bind_robot_configurations(nb::module_& m);

}  // namespace morula::python
