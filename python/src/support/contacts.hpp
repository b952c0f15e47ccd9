// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lists of contacts and crossings as columns: of two bodies, and of a scene.
#pragma once

#include <morula/collide/contacts.hpp>
#include <span>
#include <type_traits>
#include <vector>

#include "records.hpp"

namespace morula::python {

/// Pairs of facets that intersect.
struct Crossings {
  std::vector<Crossing> pairs;
};

/// Surfaces of contacts, with both points in columns.
struct ContactSurfaces {
  std::vector<ContactSurface> rows;
};

// A member of the rows of a holder as a column, for Record::property.
#define MORULA_COLUMN(Holder, rows, member)                                                      \
  [](nb::handle self) {                                                                          \
    const auto& all = nb::cast<const Holder&>(self).rows;                                        \
    using Row = std::remove_cvref_t<decltype(all[0])>;                                           \
    return column<Row>(std::span<const Row>(all), all.empty() ? nullptr : &all[0].member, self); \
  }
#define MORULA_COLUMN3(Holder, rows, member)                                                      \
  [](nb::handle self) {                                                                           \
    const auto& all = nb::cast<const Holder&>(self).rows;                                         \
    using Row = std::remove_cvref_t<decltype(all[0])>;                                            \
    return column3<Row>(std::span<const Row>(all), all.empty() ? nullptr : &all[0].member, self); \
  }

}  // namespace morula::python
