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
//                           a raise for the ratio of each distance; each inner node reads its children twice, with
//                           their centers at rest and the same two numbers
//   approach2               each leaf reads its linked vertices once, each inner node its children; one distance per
//                           node, to the farthest corner of its box
//   traditional, weighted   each node reads its vertices twice, with a weight for the center, and measures each
//   exact                   each node reads its anchors, with a weight, and three of them again, with 6 numbers, if it
//                           carries a remainder; it reads its core, and measures it once and after each of 4 pulls, for
//                           which it reads the farthest point; it reads its center and the sum of anchors at rest, and
//                           a radius. Then each leaf reads its points once for at most 4 nodes of its chain, which is
//                           itself and the nodes above; each node of the chain measures those that it tests, and keeps
//                           its reach
//
// For `exact`, anchors, cores and pulls are counted by their largest numbers, so its counts hold for every frame and
// are upper bounds: 28 anchors of a node (16 directions, 4 points that span space, 8 rounds), and 32 points of a core.
// The cores of one level together have no more points than all leaves own, since a core has different points that its
// node owns, and nodes of one level own those of different leaves. Padding of groups is counted for no rule. Leaves are
// fitted only in bodies for known poses, which have no counts.
#include <algorithm>
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

constexpr std::size_t most_anchors = 28, most_core = 32, most_pulls = 4, nodes_in_registers = 4;

/// The most points that the cores of all nodes have.
std::size_t core_points(const SphereTree& tree, std::size_t owned) {
  std::size_t points = 0;
  for (std::size_t level = 0; level < tree.level_count(); ++level)
    points += std::min(most_core * (tree.level_begin[level + 1] - tree.level_begin[level]), owned);
  return points;
}

/// report: of the body that has the rule on all levels.
UpdateCounts counts_of_exact(const UpdateStatus& status, const BindReport& report, const SphereTree& tree) {
  UpdateCounts counts{.name = std::string(name(Rule::exact))};
  const std::size_t nodes = tree.node_count(), tested = status.points_tested, owned = report.corners_owned;
  const std::size_t anchors = most_anchors * nodes, cores = core_points(tree, owned), pulls = most_pulls * nodes;
  const std::size_t carried = report.carried_centers + report.degenerate_anchors;
  const std::size_t walks = (tree.level_count() + nodes_in_registers - 1) / nodes_in_registers;
  std::size_t chains = 0;  // nodes of all leaves' chains
  for (std::uint32_t node = 0; node < nodes; ++node)
    if (tree.is_leaf(node)) chains += tree.level_of(node) + 1;
  counts.points_read = tested + anchors + 3 * carried + cores + pulls;
  counts.distances = tested + cores * (1 + most_pulls);
  add_frame(status, counts);
  counts.bytes_read += anchors * (listed + number_size) + carried * (3 * listed + 6 * number_size) + cores * listed +
                       pulls * point_size + nodes * (2 * sphere_size + number_size) + walks * owned * listed +
                       chains * (sphere_size + number_size);
  counts.bytes_written += nodes * (2 * sphere_size + number_size) + chains * number_size;
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
  Body body(mesh, model, {.rules = {Rule::exact}, .details = {}, .modes = {}});
  const UpdateStatus status = checked(body.update(mesh.positions));
  counts.push_back(counts_of_exact(status, body.bind_report(), model.tree));
  return counts;
}

}  // namespace morula::study
