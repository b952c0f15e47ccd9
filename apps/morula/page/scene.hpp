// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A scene of the page, made by moving a body.
#pragma once

#include <functional>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/rules.hpp>

#include "page/page.hpp"

namespace morula::cli {

/// The spheres of a tree through all frames of a motion, as scene of motion 0; when `measured`, with what the page
/// shows of levels and spheres. tree: what to call it. progress: the share done. Throws UsageError, naming the frame,
/// for positions that cannot be used.
PageScene follow_motion(const PageMotion& motion, const Mesh& rest, const Built& built, const std::string& tree,
                        const std::vector<Rule>& rules, bool measured, Workers& workers,
                        const std::function<void(double)>& progress);

}  // namespace morula::cli
