// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "specimens.hpp"

namespace morula::fuzz {

const Mesh& specimen_mesh() {
  static const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                         {Facet{0, 2, 1}, Facet{0, 1, 3}, Facet{1, 2, 3}, Facet{0, 3, 2}}};
  return mesh;
}

}  // namespace morula::fuzz
