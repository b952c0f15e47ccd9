// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "volumes.hpp"

#include <algorithm>
#include <cmath>
#include <morula/query/signed_distance.hpp>
#include <morula/update/kdop_tree.hpp>
#include <numeric>

namespace morula::bench {
namespace {

template <class Overlap>
Pairs walk(const SphereTree& tree, const Overlap& overlap) {
  struct Open {
    std::uint32_t a, b, a_level, b_level;
  };
  Pairs pairs;
  std::vector<Open> open{{0, 0, 0, 0}};
  while (!open.empty()) {
    const Open now = open.back();
    open.pop_back();
    ++pairs.tests;
    if (!overlap(now.a, now.b)) continue;
    const bool a_ends = tree.is_leaf(now.a), b_ends = tree.is_leaf(now.b);
    if (a_ends && b_ends) {
      ++pairs.touching_leaves;
    } else if (!a_ends && (b_ends || now.a_level <= now.b_level)) {
      for (std::uint32_t c = 0; c < tree.child_count[now.a]; ++c)
        open.push_back({tree.first_child[now.a] + c, now.b, now.a_level + 1, now.b_level});
    } else {
      for (std::uint32_t c = 0; c < tree.child_count[now.b]; ++c)
        open.push_back({now.a, tree.first_child[now.b] + c, now.a_level, now.b_level + 1});
    }
  }
  return pairs;
}

template <class Overlap>
std::size_t try_all_leaves(const SphereTree& tree, const Overlap& overlap) {
  std::size_t touching = 0;
  for (std::uint32_t a = 0; a < tree.node_count(); ++a)
    for (std::uint32_t b = 0; b < tree.node_count(); ++b)
      touching += tree.is_leaf(a) && tree.is_leaf(b) && overlap(a, b);
  return touching;
}

class SphereVolumes final : public Volumes {
  // Of a node of this tree and one of the other.
  auto overlap(const Volumes& other) const {
    const Body& b = static_cast<const SphereVolumes&>(other).body_;
    return [a_spheres = body_.spheres(), b_spheres = b.spheres(), shift = b.origin() - body_.origin()](
               std::uint32_t i, std::uint32_t j) {
      const Spheref &s = a_spheres[i], &t = b_spheres[j];
      const double reach = static_cast<double>(s.radius) + static_cast<double>(t.radius);
      return squared_distance(Vec3(s.center), Vec3(t.center) + shift) <= reach * reach;
    };
  }

 public:
  SphereVolumes(const Mesh& mesh, const CoveredTree& model, Rule rule)
      : tree_(model.tree), body_(mesh, model, {.rules = {rule}}) {}

  UpdateStatus update(const PositionView& positions, Workers& workers) override {
    return body_.update(positions, workers);
  }
  std::uint64_t hash() const override { return body_.hash(); }
  bool covers(const PositionView& positions) const override {
    std::vector<Sphere> spheres;
    body_.copy_spheres(spheres);
    return certify(body_.cover(), positions, spheres).covered;
  }
  bool contains(std::uint32_t node, const Vec3& point) const override { return power(body_.sphere(node), point) <= 0; }
  Box box(std::uint32_t node) const override {
    const Sphere s = body_.sphere(node);
    const Vec3 reach{s.radius, s.radius, s.radius};
    return {s.center - reach, s.center + reach};
  }
  std::size_t bytes_per_node() const override { return sizeof(Spheref); }
  Pairs traverse(const Volumes& other) const override { return walk(tree_, overlap(other)); }
  std::size_t touching_leaves(const Volumes& other) const override { return try_all_leaves(tree_, overlap(other)); }
  bool is_nested() const override { return false; }

 private:
  const SphereTree& tree_;
  Body body_;
};

class KDopVolumes final : public Volumes {
  // Of a node of this tree and one of the other.
  auto overlap(const Volumes& other) const {
    const KDopTree& b = static_cast<const KDopVolumes&>(other).dops_;
    std::array<double, 13> shift{};
    for (std::size_t i = 0; i < dops_.directions().size(); ++i)
      shift[i] = dot(dops_.directions()[i], b.origin() - dops_.origin());
    return [&a = dops_, &b, shift](std::uint32_t i, std::uint32_t j) {
      const auto a_lower = a.lower(i), a_upper = a.upper(i), b_lower = b.lower(j), b_upper = b.upper(j);
      for (std::size_t s = 0; s < a_lower.size(); ++s)
        if (static_cast<double>(a_lower[s]) > static_cast<double>(b_upper[s]) + shift[s] ||
            static_cast<double>(b_lower[s]) + shift[s] > static_cast<double>(a_upper[s]))
          return false;
      return true;
    };
  }

 public:
  KDopVolumes(const Mesh& mesh, const CoveredTree& model, int k)
      : tree_(model.tree), cover_(model.cover), dops_(mesh, model, k) {}

  UpdateStatus update(const PositionView& positions, Workers& workers) override {
    return dops_.update(positions, workers);
  }
  std::uint64_t hash() const override { return dops_.hash(); }
  bool covers(const PositionView& positions) const override {
    for (std::uint32_t node = 0; node < tree_.node_count(); ++node)
      for (const std::uint32_t c : cover_.region_corners(node))
        if (!contains(node, corner_position(cover_, c, positions))) return false;
    return true;
  }
  bool contains(std::uint32_t node, const Vec3& point) const override {
    const auto lower = dops_.lower(node), upper = dops_.upper(node);
    for (std::size_t i = 0; i < lower.size(); ++i) {
      const double on = dot(dops_.directions()[i], point - dops_.origin());
      if (on < static_cast<double>(lower[i]) || on > static_cast<double>(upper[i])) return false;
    }
    return true;
  }
  Box box(std::uint32_t node) const override {
    const auto low = dops_.lower(node), high = dops_.upper(node);
    return {dops_.origin() + Vec3(Vec3f{low[0], low[1], low[2]}),
            dops_.origin() + Vec3(Vec3f{high[0], high[1], high[2]})};
  }
  std::size_t bytes_per_node() const override { return static_cast<std::size_t>(dops_.k()) * sizeof(float); }
  Pairs traverse(const Volumes& other) const override { return walk(tree_, overlap(other)); }
  std::size_t touching_leaves(const Volumes& other) const override { return try_all_leaves(tree_, overlap(other)); }
  bool is_nested() const override { return true; }

 private:
  const SphereTree& tree_;
  const Cover& cover_;
  KDopTree dops_;
};

template <Rule rule>
std::unique_ptr<Volumes> spheres(const Mesh& mesh, const CoveredTree& model) {
  return std::make_unique<SphereVolumes>(mesh, model, rule);
}
template <int k>
std::unique_ptr<Volumes> kdops(const Mesh& mesh, const CoveredTree& model) {
  return std::make_unique<KDopVolumes>(mesh, model, k);
}

}  // namespace

const std::vector<VolumeKind>& volume_kinds() {
  static const std::vector<VolumeKind> kinds{
      {"spheres, exact", spheres<Rule::exact>},
      {"spheres, approach2", spheres<Rule::approach2>},
      {"boxes", kdops<6>},
      {"14-DOPs", kdops<14>},
      {"18-DOPs", kdops<18>},
      {"26-DOPs", kdops<26>},
  };
  return kinds;
}

SharedLattice::SharedLattice(const Box& box, int resolution, const MeshView& mesh, Workers& workers)
    : edge_(max_norm(box.extent()) / resolution) {
  first_ = box.lower + Vec3{0.5, 0.5, 0.5} * edge_;
  for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<int>(std::ceil(box.extent()[axis] / edge_));
  inside_.resize(number(0, 0, size_[2]));
  const SignedDistance object(mesh, workers);
  parallel_for(workers, static_cast<std::size_t>(size_[2]), 1, [&](std::size_t layer, std::size_t) {
    const int k = static_cast<int>(layer);
    for (int j = 0; j < size_[1]; ++j)
      for (int i = 0; i < size_[0]; ++i) inside_[number(i, j, k)] = object.is_inside(point(i, j, k));
  });
  inside_count_ = std::accumulate(inside_.begin(), inside_.end(), std::size_t{0});
}

double SharedLattice::looseness(const Volumes& volumes, std::span<const std::uint32_t> nodes) const {
  std::vector<std::uint8_t> taken_in(inside_.size());
  for (const std::uint32_t node : nodes) {
    const Box box = volumes.box(node);
    std::array<int, 3> begin, end;
    for (int axis = 0; axis < 3; ++axis) {
      begin[axis] = std::max(0, static_cast<int>(std::ceil((box.lower[axis] - first_[axis]) / edge_)));
      end[axis] = std::min(size_[axis], 1 + static_cast<int>(std::floor((box.upper[axis] - first_[axis]) / edge_)));
    }
    for (int k = begin[2]; k < end[2]; ++k)
      for (int j = begin[1]; j < end[1]; ++j)
        for (int i = begin[0]; i < end[0]; ++i)
          if (volumes.contains(node, point(i, j, k))) taken_in[number(i, j, k)] = 1;
  }
  std::size_t outside = 0;
  for (std::size_t n = 0; n < inside_.size(); ++n) outside += taken_in[n] && !inside_[n];
  return static_cast<double>(outside) / static_cast<double>(inside_count_);
}

Vec3 SharedLattice::point(int i, int j, int k) const {
  return first_ + Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} * edge_;
}

std::size_t SharedLattice::number(int i, int j, int k) const {
  return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(j)) *
             static_cast<std::size_t>(size_[0]) +
         static_cast<std::size_t>(i);
}

}  // namespace morula::bench
