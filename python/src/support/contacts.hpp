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

/// The columns of the `contacts` of a holder.
template <class Holder>
Record<Holder>& contact_columns(Record<Holder>& record) {
  record.property("node_a", MORULA_COLUMN(Holder, contacts, node_a), "(n,) uint32.")
      .property("node_b", MORULA_COLUMN(Holder, contacts, node_b), "(n,) uint32.")
      .property("finished", MORULA_COLUMN(Holder, contacts, finished), doc::Contact_finished)
      .property("point", MORULA_COLUMN3(Holder, contacts, point), doc::Contact_point)
      .property("normal", MORULA_COLUMN3(Holder, contacts, normal), doc::Contact_normal)
      .property("depth", MORULA_COLUMN(Holder, contacts, depth), doc::Contact_depth)
      .property("lens_volume", MORULA_COLUMN(Holder, contacts, lens_volume), doc::Contact_lens_volume)
      .property("error_bound", MORULA_COLUMN(Holder, contacts, error_bound), doc::Contact_error_bound);
  return record;
}

}  // namespace morula::python
