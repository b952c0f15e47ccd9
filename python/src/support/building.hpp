// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What all functions take that build trees: a generator, a quality, and somebody to tell how far they are.
#pragma once

#include <morula/generators/build.hpp>
#include <string_view>

#include "holders.hpp"

namespace morula::python {

/// Throws ValueError with the names there are.
inline Method method_of(std::string_view text) {
  return choice<Method>(text, "method", method_from_name, all_methods());
}
inline Quality quality_of(std::string_view text, const char* argument = "quality") {
  return choice<Quality>(text, argument, quality_from_name, all_qualities());
}

/// Looks for Ctrl-C, then calls `callback`, which is None or outlives what is returned, with whatever it is told. To be
/// called without the interpreter's lock. What these raise ends the work.
inline auto progress_of(const nb::object& callback) {
  return [&callback, check = SignalCheck()](const auto&... told) mutable {
    check();
    if (callback.is_none()) return;
    const nb::gil_scoped_acquire gil;
    callback(told...);
  };
}

}  // namespace morula::python
