// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Common arguments of functions that build trees: a generator, a quality, and a callback for progress.
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

/// Returns a function that checks for Ctrl-C and then passes its arguments to `callback`, which is None or outlives the
/// function. It must be called without the GIL. An exception of either ends the work.
inline auto progress_of(const nb::object& callback) {
  return [&callback, check = SignalCheck()](const auto&... reported) mutable {
    check();
    if (callback.is_none()) return;
    const nb::gil_scoped_acquire gil;
    callback(reported...);
  };
}

}  // namespace morula::python
