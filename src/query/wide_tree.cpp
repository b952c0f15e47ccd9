// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Top-down build by the surface area heuristic over bins [wald2007], four ranges at a time: a node's range is split,
// then the half of larger area again, until there are four.
#include "query/wide_tree.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/scale.hpp>
#include <span>
#include <utility>

namespace morula::detail::wide {
namespace {

// Ranges of more facets are split one node after the other, level by level; each smaller one is built to the end by one
// chunk. The size is large enough to amortize a chunk, and small enough to give work to a few cores.
constexpr std::uint32_t subtree_grain = 4096;
constexpr std::size_t facet_grain = 8192;

// A box as its lower corner and the negative of its upper one, so that growing it is one kind of minimum, in
// coordinates that the mesh's box maps to [−½, ½]. It only steers splits: only speed depends on its rounding.
struct FloatBox {
  static constexpr float infinity = std::numeric_limits<float>::infinity();
  Float4 lower{infinity, infinity, infinity, infinity};
  Float4 minus_upper{infinity, infinity, infinity, infinity};

  void add(const FloatBox& other) {
    lower = min(other.lower, lower);
    minus_upper = min(other.minus_upper, minus_upper);
  }
  Float4 doubled_center() const { return lower - minus_upper; }
  float half_area() const {
    const Float4 size = -minus_upper - lower;
    return size[0] >= 0 ? size[0] * size[1] + size[1] * size[2] + size[2] * size[0] : 0;
  }
};

// A facet's box; the lane that boxes do not use holds the facet's index.
struct Reference {
  FloatBox box;
  std::uint32_t facet() const { return std::bit_cast<std::uint32_t>(float{box.minus_upper[3]}); }
};
static_assert(sizeof(Reference) == 32);

struct Range {
  std::uint32_t begin, end;
  float half_area;
  std::uint32_t count() const { return end - begin; }
};

// Box, far-field expansion and bounding radius of a set of facets; built up from the leaves.
struct Summary {
  Box box;
  Vec3 centroid;
  double area = 0;
  Vec3 area_vector;
  double moment[6] = {};
  double radius = 0;
};

// The nearest point of a triangle is computed as corner + edges × weights, so rounding may put it outside the box of
// the corners by a few ulps of the coordinates. Boxes are padded by more, so pruning by box distance can never
// contradict the distance that the facet itself would report.
Box facet_box(const Triangle& t) {
  Box box;
  for (const Vec3& corner : t) box.add(corner);
  const double pad = 0x1p-48 * std::max(max_norm(box.lower), max_norm(box.upper));
  return {box.lower - Vec3{pad, pad, pad}, box.upper + Vec3{pad, pad, pad}};
}

Summary summary_of(const Triangle& t) {
  Summary s;
  s.box = facet_box(t);
  s.centroid = t[0] + ((t[1] - t[0]) + (t[2] - t[0])) / 3.0;
  s.area_vector = 0.5 * area_vector(t);
  s.area = length(s.area_vector);
  for (const Vec3& corner : t) s.radius = std::max(s.radius, distance(corner, s.centroid));
  return s;
}

Summary joined(const Summary* parts, int count) {
  Summary s;
  Vec3 weighted, first = parts[0].centroid;
  for (int i = 0; i < count; ++i) {
    s.box.add(parts[i].box);
    s.area += parts[i].area;
    s.area_vector += parts[i].area_vector;
    weighted += (parts[i].centroid - first) * parts[i].area;
  }
  s.centroid = s.area > 0 ? first + weighted / s.area : s.box.center();
  for (int i = 0; i < count; ++i) {
    const Vec3 y = parts[i].centroid - s.centroid, n = parts[i].area_vector;
    const double shift[6] = {
        y.x * n.x, y.y * n.y, y.z * n.z, y.x * n.y + y.y * n.x, y.x * n.z + y.z * n.x, y.y * n.z + y.z * n.y};
    for (int m = 0; m < 6; ++m) s.moment[m] += parts[i].moment[m] + shift[m];
    s.radius = std::max(s.radius, length(y) + parts[i].radius);
  }
  const Vec3 reach = max(s.centroid - s.box.lower, s.box.upper - s.centroid);
  s.radius = std::min(s.radius, length(reach));
  return s;
}

void set_cluster(Clusters& clusters, int k, const Summary& s) {
  for (int axis = 0; axis < 3; ++axis) {
    clusters.centroid[axis][k] = s.centroid[axis];
    clusters.area_vector[axis][k] = s.area_vector[axis];
  }
  for (int m = 0; m < 6; ++m) clusters.moment[m][k] = s.moment[m];
  clusters.radius[k] = s.radius;
}

// The largest patch with oriented boxes: only patches of a few facets are flat.
constexpr std::uint32_t largest_patch = 512;

class Builder {
 public:
  Builder(const MeshView& mesh, Workers& workers) : mesh_(mesh), workers_(workers) {}

  Tree build() {
    const std::size_t count = mesh_.facet_count();
    references_.resize(count);
    tree_.facets.resize(count);
    tree_.corners.assign(mesh_.facets.begin(), mesh_.facets.end());
    tree_.positions.resize(mesh_.vertex_count());
    for (std::size_t v = 0; v < tree_.positions.size(); ++v) tree_.positions[v] = mesh_.positions[v];
    make_references();
    split_large_ranges();

    // The number of subtrees built at a time: until they are appended they take their memory twice.
    constexpr std::size_t batch = 64;
    std::vector<std::array<Summary, width>> summaries(tree_.nodes.size());
    tree_.clusters.resize(tree_.nodes.size());
    for (std::size_t first = 0; first < pending_.size(); first += batch) {
      std::vector<Subtree> subtrees(std::min(batch, pending_.size() - first));
      parallel_for(workers_, subtrees.size(), 1, [&](std::size_t i, std::size_t) {
        const Pending& pending = pending_[first + i];
        subtrees[i].nodes.reserve(pending.range.count() / 8);
        subtrees[i].first_slot = pending.range.begin;
        subtrees[i].triangles.resize(pending.range.count());
        subtrees[i].summary = build_node(subtrees[i], pending.range, pending.depth);
        subtrees[i].triangles = {};
      });
      append(subtrees, std::span(pending_).subspan(first), summaries);
    }
    close_top(summaries);
    return std::move(tree_);
  }

 private:
  struct Subtree {
    std::vector<Node> nodes;
    std::vector<Clusters> clusters;
    std::vector<FacetBoxes> boxes;
    Summary summary;
    // By slot, while the tree is made.
    std::uint32_t first_slot = 0;
    std::vector<Triangle> triangles;
    std::span<const Triangle> patch(const Range& range) const {
      return std::span(triangles).subspan(range.begin - first_slot, range.count());
    }
  };
  // A node still to be made, and the child slot that will point to it.
  struct Pending {
    Range range;
    int depth;
    std::uint32_t parent;
    int child;
  };
  static constexpr std::uint32_t no_parent = 0xffffffffu;

  void make_references() {
    const std::size_t count = mesh_.facet_count();
    std::vector<Box> boxes((count + facet_grain - 1) / facet_grain);
    parallel_for(workers_, count, facet_grain, [&](std::size_t begin, std::size_t end) {
      Box& box = boxes[begin / facet_grain];
      for (std::size_t f = begin; f < end; ++f)
        for (const Vec3& corner : mesh_.corners(f)) box.add(corner);
    });
    Box& whole = tree_.box;
    for (const Box& box : boxes) whole.add(box);
    const Vec3 center = whole.center();
    const double size = max_norm(whole.extent());
    const double scale = size > 1e-300 ? 1 / size : 0;
    tree_.units = Units(whole);
    parallel_for(workers_, count, facet_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) {
        Box box;
        for (const Vec3& corner : mesh_.corners(f)) box.add(corner);
        const Vec3 lower = (box.lower - center) * scale, upper = (box.upper - center) * scale;
        const auto index = std::bit_cast<float>(static_cast<std::uint32_t>(f));
        references_[f].box.lower =
            Float4{static_cast<float>(lower.x), static_cast<float>(lower.y), static_cast<float>(lower.z), 0};
        references_[f].box.minus_upper =
            Float4{static_cast<float>(-upper.x), static_cast<float>(-upper.y), static_cast<float>(-upper.z), index};
      }
    });
  }

  // One level of nodes after the other; leaves pending_ with ranges that are small enough for one chunk each.
  void split_large_ranges() {
    std::vector<Pending> level{{{0, static_cast<std::uint32_t>(references_.size()), 0}, 0, no_parent, 0}};
    while (!level.empty()) {
      std::vector<Pending> large;
      for (const Pending& p : level) (p.range.count() > subtree_grain ? large : pending_).push_back(p);
      struct Children {
        Range ranges[width];
        int count;
      };
      std::vector<Children> made(large.size());
      parallel_for(workers_, large.size(), 1, [&](std::size_t i, std::size_t) {
        made[i].count = split_node(large[i].range, large[i].depth, made[i].ranges);
      });
      level.clear();
      for (std::size_t i = 0; i < large.size(); ++i) {
        const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
        if (large[i].parent != no_parent) tree_.nodes[large[i].parent].first[large[i].child] = index;
        tree_.nodes.push_back({});
        tree_.nodes.back().size = made[i].count;
        for (int k = 0; k < made[i].count; ++k) level.push_back({made[i].ranges[k], large[i].depth + 1, index, k});
      }
    }
  }

  // Appends subtrees behind all nodes so far. pending: the entries of these subtrees first, then the entries of later
  // ones.
  void append(std::span<const Subtree> subtrees, std::span<const Pending> pending,
              std::vector<std::array<Summary, width>>& summaries) {
    std::size_t nodes = 0, boxes = 0, facets = 0, all_facets = 0;
    for (const Subtree& subtree : subtrees) nodes += subtree.nodes.size(), boxes += subtree.boxes.size();
    for (std::size_t i = 0; i < pending.size(); ++i)
      all_facets += pending[i].range.count(), facets += i < subtrees.size() ? pending[i].range.count() : 0;
    // Reserves room for later subtrees as well, estimated from these: growth by doubling would take the memory twice.
    const double share = 1.1 * static_cast<double>(all_facets) / static_cast<double>(facets);
    const auto make_room = [&](auto& all, std::size_t now) {
      if (all.size() + now > all.capacity())
        all.reserve(all.size() + static_cast<std::size_t>(share * static_cast<double>(now)));
    };
    make_room(tree_.nodes, nodes);
    make_room(tree_.clusters, nodes);
    make_room(tree_.boxes, boxes);
    for (std::size_t i = 0; i < subtrees.size(); ++i) {
      const auto offset = static_cast<std::uint32_t>(tree_.nodes.size());
      const auto first_leaf = static_cast<std::uint32_t>(tree_.boxes.size());
      for (Node node : subtrees[i].nodes) {
        for (int k = 0; k < node.size; ++k) (node.count[k] == 0 ? node.first[k] += offset : node.leaf[k] += first_leaf);
        tree_.nodes.push_back(node);
      }
      tree_.boxes.insert(tree_.boxes.end(), subtrees[i].boxes.begin(), subtrees[i].boxes.end());
      tree_.clusters.insert(tree_.clusters.end(), subtrees[i].clusters.begin(), subtrees[i].clusters.end());
      if (pending[i].parent == no_parent) continue;
      tree_.nodes[pending[i].parent].first[pending[i].child] = offset;
      summaries[pending[i].parent][static_cast<std::size_t>(pending[i].child)] = subtrees[i].summary;
    }
  }

  // Completes the nodes from the last one above the subtrees up to the root. summaries: summaries of those children
  // that are subtrees.
  void close_top(std::vector<std::array<Summary, width>>& summaries) {
    const std::size_t top_count = summaries.size();
    for (std::size_t n = top_count; n-- > 0;) {
      Node& node = tree_.nodes[n];
      Box all;
      for (int k = 0; k < node.size; ++k) {
        Summary& s = summaries[n][static_cast<std::size_t>(k)];
        if (node.first[k] < top_count) s = joined(summaries[node.first[k]].data(), tree_.nodes[node.first[k]].size);
        set_cluster(tree_.clusters[n], k, s);
        all.add(s.box);
      }
      BoxMaker maker(tree_.units, all);
      for (int k = 0; k < node.size; ++k) maker.set(k, summaries[n][static_cast<std::size_t>(k)].box);
      node.boxes = maker.boxes();
    }
  }

  // Depth-first, parents before children. Returns the summary that the node's parent needs.
  Summary build_node(Subtree& subtree, const Range& range, int depth) {
    assert(depth < largest_depth);
    const std::size_t index = subtree.nodes.size();
    subtree.nodes.emplace_back();
    subtree.clusters.emplace_back();
    Range ranges[width];
    const int count = split_node(range, depth, ranges);
    subtree.nodes[index].size = count;
    Summary summaries[width];
    Box all;
    for (int k = 0; k < count; ++k) {
      const bool is_leaf = ranges[k].count() <= largest_leaf;
      const auto next = static_cast<std::uint32_t>(subtree.nodes.size());
      summaries[k] = is_leaf ? build_leaf(subtree, ranges[k]) : build_node(subtree, ranges[k], depth + 1);
      Node& node = subtree.nodes[index];
      node.first[k] = is_leaf ? ranges[k].begin : next;
      node.count[k] = is_leaf ? ranges[k].count() : 0;
      set_cluster(subtree.clusters[index], k, summaries[k]);
      all.add(summaries[k].box);
    }
    BoxMaker maker(tree_.units, all);
    Node& node = subtree.nodes[index];
    for (int k = 0; k < count; ++k) {
      if (ranges[k].count() > largest_patch) {
        maker.set(k, summaries[k].box);
        continue;
      }
      const auto patch = subtree.patch(ranges[k]);
      maker.set(k, patch, summaries[k].area_vector);
      // The box of a leaf with one facet is as tight as the facet's own box.
      if (node.count[k] < 2) continue;
      node.leaf[k] = static_cast<std::uint32_t>(subtree.boxes.size());
      subtree.boxes.push_back(maker.facets_of(k, patch));
    }
    node.boxes = maker.boxes();
    return joined(summaries, count);
  }

  Summary build_leaf(Subtree& subtree, const Range& range) {
    Summary summaries[largest_leaf];
    for (std::uint32_t slot = range.begin; slot < range.end; ++slot) {
      const std::uint32_t facet = references_[slot].facet();
      tree_.facets[slot] = facet;
      Triangle& corners = subtree.triangles[slot - subtree.first_slot];
      corners = tree_.triangle(facet);
      summaries[slot - range.begin] = summary_of(corners);
    }
    return joined(summaries, static_cast<int>(range.count()));
  }

  // Cuts a range into up to `width` parts. Parts small enough for a leaf are cut too while there is room: a tighter box
  // costs nothing in a node that is tested as a whole.
  int split_node(const Range& range, int depth, Range* parts) {
    parts[0] = range;
    int count = 1;
    while (count < width) {
      int widest = -1;
      for (int k = 0; k < count; ++k) {
        if (parts[k].count() < 2) continue;
        const bool prefer_size = widest >= 0 && depth >= deepest_shaped_split;
        if (widest < 0 || (prefer_size ? parts[k].count() > parts[widest].count() : is_wider(parts[k], parts[widest])))
          widest = k;
      }
      if (widest < 0) break;
      const Range whole = parts[widest];
      const Cut cut = depth >= deepest_shaped_split ? halves(whole) : best_cut(whole);
      // The halves stay next to each other, so a node's facets lie in the order of its children.
      std::copy_backward(parts + widest + 1, parts + count, parts + count + 1);
      parts[widest] = {whole.begin, cut.middle, cut.half_area[0]};
      parts[widest + 1] = {cut.middle, whole.end, cut.half_area[1]};
      ++count;
    }
    return count;
  }

  // Ranges too large for a leaf come first, because the others need no further node.
  static bool is_wider(const Range& a, const Range& b) {
    const bool a_is_leaf = a.count() <= largest_leaf, b_is_leaf = b.count() <= largest_leaf;
    return a_is_leaf != b_is_leaf ? b_is_leaf : a.half_area > b.half_area;
  }

  struct Cut {
    std::uint32_t middle;
    float half_area[2];
  };
  static Cut halves(const Range& range) {
    return {range.begin + range.count() / 2, {range.half_area, range.half_area}};
  }

  static constexpr int most_bins = 16;
  // The bin of a box on each axis, by its doubled center.
  struct Binning {
    Float4 lower, scale, last;
    Float4 operator()(const FloatBox& box) const {
      return min(max((box.doubled_center() - lower) * scale, Float4{}), last);
    }
  };

  // Moves the references in bins below `bin` to the front. Returns where the others begin.
  std::uint32_t partition(const Range& range, const Binning& binning, int axis, int bin) {
    const auto first = static_cast<float>(bin);
    Reference *low = references_.data() + range.begin, *high = references_.data() + range.end;
    for (;;) {
      while (low != high && binning(low->box)[axis] < first) ++low;
      while (low != high && binning((high - 1)->box)[axis] >= first) --high;
      if (low == high) break;
      std::swap(*low++, *--high);
    }
    return static_cast<std::uint32_t>(low - references_.data());
  }

  // Most ranges are of a few facets, and most of the work on them would be clearing bins.
  Cut best_cut(const Range& range) {
    return range.count() >= 32  ? best_cut<most_bins>(range)
           : range.count() >= 8 ? best_cut<most_bins / 2>(range)
                                : best_cut<most_bins / 4>(range);
  }

  template <int bin_count>
  Cut best_cut(const Range& range) {
    Reference* const begin = references_.data() + range.begin;
    Reference* const end = references_.data() + range.end;
    FloatBox centers;
    for (const Reference* r = begin; r != end; ++r) {
      const Float4 center = r->box.doubled_center();
      centers.add({center, -center});
    }
    const auto bin_float = static_cast<float>(bin_count);
    const Float4 size = -centers.minus_upper - centers.lower;
    const auto scale = [&](int axis) { return size[axis] > 0 ? std::min(bin_float / size[axis], 1e30f) : 0.0f; };
    const float last = bin_float - 1;
    const Binning binning{centers.lower, {scale(0), scale(1), scale(2), 0}, {last, last, last, last}};
    FloatBox bins[3][bin_count];
    std::uint32_t counts[3][bin_count] = {};
    for (const Reference* r = begin; r != end; ++r) {
      const Float4 at = binning(r->box);
      for (int axis = 0; axis < 3; ++axis) {
        const int bin = static_cast<int>(at[axis]);
        bins[axis][bin].add(r->box);
        ++counts[axis][bin];
      }
    }

    float least_cost = std::numeric_limits<float>::infinity();
    int best_axis = -1, best_bin = 0;
    Cut cut{};
    for (int axis = 0; axis < 3; ++axis) {
      // A cut in front of bin b leaves bins b and up on the right.
      float right_area[bin_count];
      FloatBox right, left;
      for (int b = bin_count - 1; b > 0; --b) {
        right.add(bins[axis][b]);
        right_area[b] = right.half_area();
      }
      std::uint32_t left_count = 0;
      for (int b = 1; b < bin_count; ++b) {
        left.add(bins[axis][b - 1]);
        left_count += counts[axis][b - 1];
        if (left_count == 0 || left_count == range.count()) continue;
        const float left_area = left.half_area();
        const float cost =
            left_area * static_cast<float>(left_count) + right_area[b] * static_cast<float>(range.count() - left_count);
        if (!(cost < least_cost)) continue;
        least_cost = cost;
        best_axis = axis;
        best_bin = b;
        cut.half_area[0] = left_area;
        cut.half_area[1] = right_area[b];
      }
    }
    if (best_axis < 0) return halves(range);  // all centers are at one point

    cut.middle = partition(range, binning, best_axis, best_bin);
    return cut;
  }

  MeshView mesh_;
  Workers& workers_;
  Tree tree_;
  std::vector<Reference> references_;
  std::vector<Pending> pending_;
};

}  // namespace

Tree build(const MeshView& mesh, Workers& workers) {
  require_usable_scale(mesh);
  return Builder(mesh, workers).build();
}

}  // namespace morula::detail::wide
