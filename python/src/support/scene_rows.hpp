// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Results of a scene, as copies that its next update does not change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/scene/scene.hpp>
#include <type_traits>
#include <vector>

#include "contact_patches.hpp"
#include "contacts.hpp"

namespace morula::python {

/// Contacts of one pair of bodies, or of all.
struct SceneContacts {
  std::vector<Contact> contacts;
};

/// A pair of bodies, with its contacts.
struct SceneRow {
  ScenePair pair;  // its spans are not used
  SceneContacts contacts;
  ContactSurfaces surfaces;
  Crossings crossings;
  ContactPatches patches;
};

/// All pairs of an update: a copy, which the next update does not touch.
struct SceneRows {
  std::vector<ScenePair> pairs;  // its spans are not used
  std::vector<std::uint64_t> user_data_a, user_data_b;
  std::vector<std::uint32_t> contacts_begin{0}, crossings_begin{0};
  SceneContacts contacts;
  std::vector<std::size_t> surfaces_begin{0};
  ContactSurfaces surfaces;
  Crossings crossings;
  std::vector<ContactPatches> patches;  // by pair

  SceneRow row(std::size_t i) const {
    const auto part = [](const auto& all, std::size_t begin, std::size_t end) {
      using List = std::remove_cvref_t<decltype(all)>;
      return List(all.begin() + static_cast<std::ptrdiff_t>(begin), all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    return {pairs[i],
            {part(contacts.contacts, contacts_begin[i], contacts_begin[i + 1])},
            {part(surfaces.rows, surfaces_begin[i], surfaces_begin[i + 1])},
            {part(crossings.pairs, crossings_begin[i], crossings_begin[i + 1])},
            patches[i]};
  }
};

struct FoundTouch {
  BodyId body;
  Touch touch;
};

SceneRows rows_of(const Scene& scene);
SceneRow row_of(const Scene& scene, const ScenePair& pair);

}  // namespace morula::python
