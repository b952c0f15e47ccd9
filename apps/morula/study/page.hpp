// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// index.html of a study: claims and figures, and beside them the body in motion.
#pragma once

#include <functional>

#include "page/page.hpp"
#include "study/run.hpp"

namespace morula::cli {

/// The first body on its medial tree (or its first one): every motion of the study, with approach2 and exact.
/// study: the JSON of study.json. The frames are the samples of the figures.
PageContent study_page(const StudyPlan& plan, const StudyResult& result, Json study, Workers& workers,
                       const std::function<void(double, std::string)>& progress);

}  // namespace morula::cli
