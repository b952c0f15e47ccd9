// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/extension.hpp"

namespace morula::cli {

CollideViews collide_views() {
  for (const Extension& extension : extensions())
    if (extension.collide_views) return extension.collide_views;
  return {};
}

}  // namespace morula::cli
