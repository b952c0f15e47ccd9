// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What planners' queries share: a world and a query, which several threads of Python may use at once.
#pragma once

#include <memory>
#include <morula/robot/configurations.hpp>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

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
    std::unique_lock lock(mutex_, std::try_to_lock);
    if (lock) return value_;
    // A change that takes long acquires the GIL to check for signals, so nobody may wait for it with the GIL.
    const nb::gil_scoped_release released;
    const std::scoped_lock waited(mutex_);
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

/// copy.copy() and copy.deepcopy(): both give an independent object.
template <class Value>
void bind_copies(nb::class_<Guarded<Value>>& type, const char* name) {
  const auto copied = [](const Guarded<Value>& self) { return std::make_unique<Guarded<Value>>(self.copy()); };
  type.def("__copy__", copied);
  type.def(
      "__deepcopy__", [copied](const Guarded<Value>& self, nb::handle) { return copied(self); }, nb::arg("memo"),
      nb::sig((std::string("def __deepcopy__(self, memo: object) -> ") + name).c_str()));
}

using GuardedWorld = Guarded<robot::World>;
using GuardedQuery = Guarded<robot::ConfigurationQuery>;

/// (n, coordinates) numbers, and their n.
inline std::vector<double> configurations_of(const ArrayGiven& given, const char* name,
                                             const robot::ConfigurationQuery& query, std::size_t& count) {
  std::vector<std::size_t> shape;
  std::vector<double> values =
      numbers_of(given.object, name, {-1, static_cast<std::int64_t>(query.coordinates())}, shape);
  count = shape[0];
  return values;
}

/// An array of one number of each result.
template <class Number, class Result, class F>
Copy<Number, -1> column_of(const std::vector<Result>& results, const F& number) {
  // std::vector<bool> has no array.
  auto* values = new Number[results.size()];
  const nb::capsule owner(values, [](void* p) noexcept { delete[] static_cast<Number*>(p); });
  for (std::size_t i = 0; i < results.size(); ++i) values[i] = number(results[i]);
  return Copy<Number, -1>(values, {results.size()}, owner);
}

/// -1 for none.
inline std::int64_t number_or_less(std::uint32_t number) {
  return number == robot::ConfigurationVerdict::free_link ? -1 : static_cast<std::int64_t>(number);
}

void bind_robot_clearance(nb::module_& m, nb::class_<GuardedQuery>& query);
void bind_robot_motions(nb::module_& m, nb::class_<GuardedQuery>& query);
void bind_robot_world(nb::module_& m);
void bind_robot_configurations(nb::module_& m);

}  // namespace morula::python
