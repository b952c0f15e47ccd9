// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Work of updates, as formulas over counts: points at leaves, children of inner nodes, nodes.
//
// A point takes 16 bytes, a weight, a divisor and an index 4, a sphere 16, a box of 6 bounds 24. All rules read the
// mesh's positions (24 bytes), write them as points, and move the points of cuts, each from three points and three
// weights of 8 bytes. Then:
//
//   boxes                   each leaf reads its points once; each inner node reads its children's boxes
//   approach1               each leaf reads its linked vertices twice, with a weight for the center, and a divisor and
//   a
//                           raise for the ratio of each distance; each inner node reads its children twice, with their
//                           centers at rest and the same two numbers
//   approach2               each leaf reads its linked vertices once, each inner node its children; one distance per
//                           node, to the farthest corner of its box
//   traditional, weighted   each node reads its vertices twice, with a weight for the center, and measures each
#include <morula/study/run.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <stdexcept>

namespace morula::study {
namespace {

constexpr std::size_t position_size = 24, point_size = 16, index_size = 4, number_size = 4, sphere_size = 16,
                      box_size = 24, cut_weight_size = 8;
constexpr std::size_t listed = point_size + index_size;

/// Nodes that are children.
std::size_t child_count(const SphereTree& tree) {
  return tree.node_count() - 1;
}

/// The points of a frame, which every rule makes first.
void add_frame(const UpdateStatus& status, UpdateCounts& counts) {
  const std::size_t cuts = status.cut_points_moved;
  counts.bytes_read += status.vertices_read * position_size + 3 * cuts * (point_size + cut_weight_size);
  counts.bytes_written += (status.vertices_read + cuts) * point_size;
}

UpdateCounts counts_of(Rule rule, const UpdateStatus& status, const SphereTree& tree) {
  UpdateCounts counts{.name = std::string(name(rule))};
  const std::size_t points = status.points_tested, children = child_count(tree);
  add_frame(status, counts);
  counts.bytes_written += tree.node_count() * sphere_size;
  if (rule == Rule::approach2) {
    counts.points_read = points;
    counts.children_read = children;
    counts.distances = tree.node_count();
    counts.bytes_read += points * listed + children * sphere_size;
  } else {
    counts.points_read = 2 * points;
    counts.distances = points;
    counts.bytes_read += points * (2 * listed + number_size);
  }
  if (rule == Rule::approach1) {
    counts.children_read = 2 * children;
    counts.distances += children;
    counts.bytes_read += points * 2 * number_size + children * (3 * sphere_size + 2 * number_size);
  }
  return counts;
}

UpdateCounts counts_of_boxes(const UpdateStatus& status, const SphereTree& tree) {
  UpdateCounts counts{.name = "boxes"};
  counts.points_read = status.points_tested;
  counts.children_read = child_count(tree);
  add_frame(status, counts);
  counts.bytes_read += counts.points_read * listed + counts.children_read * box_size;
  counts.bytes_written += tree.node_count() * box_size;
  return counts;
}

}  // namespace

std::vector<UpdateCounts> count_updates(const Mesh& mesh, const CoveredTree& model) {
  std::vector<UpdateCounts> counts;
  const auto checked = [](const UpdateStatus& status) {
    if (!status) throw std::invalid_argument(message(status));
    return status;
  };
  KDopTree boxes(mesh, model, 6);
  counts.push_back(counts_of_boxes(checked(boxes.update(mesh.positions)), model.tree));
  for (const Rule rule : {Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2}) {
    Body body(mesh, model, {.rules = {rule}, .details = {}, .modes = {}});
    counts.push_back(counts_of(rule, checked(body.update(mesh.positions)), model.tree));
  }
  return counts;
}

}  // namespace morula::study
