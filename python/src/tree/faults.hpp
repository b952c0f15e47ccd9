// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Faults of a tree or a cover, as a message.
#pragma once

#include <string>
#include <vector>

namespace morula::python {

inline std::string joined(const std::vector<std::string>& faults) {
  std::string all;
  for (const std::string& fault : faults) all += (all.empty() ? "" : "; ") + fault;
  return all;
}

}  // namespace morula::python
