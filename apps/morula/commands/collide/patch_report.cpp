// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/patch_report.hpp"

namespace morula::cli {

std::string patch_vector_text(const Vec3& v) {
  return fmt::format("{} {} {}", figure(v.x), figure(v.y), figure(v.z));
}

std::string PatchReport::text() const {
  return fmt::format("{}\nsummary   {} of {} have patches; {} µs per frame (median)\n", table.text(), with_patches,
                     counted(microseconds.size(), "frame"), figure(median(microseconds)));
}

}  // namespace morula::cli
