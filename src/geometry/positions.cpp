// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/positions.hpp>
#include <stdexcept>
#include <string>

namespace morula {

PositionView PositionView::indexed(const PositionView& nodes, std::span<const std::uint32_t> index) {
  if (nodes.index_) throw std::invalid_argument("the nodes of an indexed view are indexed themselves");
  for (std::size_t i = 0; i < index.size(); ++i)
    if (index[i] >= nodes.size())
      throw std::invalid_argument("vertex " + std::to_string(i) + " is node " + std::to_string(index[i]) + " of " +
                                  std::to_string(nodes.size()));
  PositionView view = nodes;
  view.count_ = index.size();
  view.index_ = index.data();
  return view;
}

std::vector<Vec3> PositionView::to_vector() const {
  std::vector<Vec3> copy;
  copy.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) copy.push_back((*this)[i]);
  return copy;
}

}  // namespace morula
