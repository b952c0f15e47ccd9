// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A hand of skinned fingers closes twice: freely, through itself, and with a swept query that stops each finger before
// it touches another or the palm. In every frame the facets that cross are those that brute force finds.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <morula/geometry/reproducible.hpp>
#include <morula/morula.hpp>
#include <numbers>
#include <set>
#include <vector>

using namespace morula;

namespace {

constexpr int fingers = 5, frames = 40;
constexpr double skin_thickness = 0.004, touching = 0.02, radius = 0.08;
constexpr const char* names[] = {"index", "middle", "ring", "little", "thumb", "palm"};

/// A turn about an axis through a point, relative to rest.
AffineTransform turn_about(const Vec3& point, const Vec3& axis, double angle) {
  const RigidTransform r = RigidTransform::from_axis(axis, angle);
  AffineTransform t{{r.rotate({1, 0, 0}), r.rotate({0, 1, 0}), r.rotate({0, 0, 1})}, {}};
  t.translation = point - t.linear(point);
  return t;
}

/// Parts of one mesh: a finger is a tube with round ends and three bones, one after the other.
class Hand {
 public:
  Mesh mesh;
  Skin skin;
  std::vector<int> part;  // by vertex: a finger, or 5 for the palm

  Hand() {
    skin.bone_count = 1 + 3 * fingers;  // bone 0 is the palm, which rests
    skin.begin = {0};
    const double lengths[] = {0.75, 0.8, 0.77, 0.68, 0.8};
    for (int f = 0; f < fingers; ++f) {
      const bool is_thumb = f == 4;
      finger_[f] = {.base = is_thumb ? Vec3{-0.12, 0.3, 0.13} : Vec3{0.1 + 0.2 * f, 1.02, 0.13},
                    .along = is_thumb ? Vec3{-1, 0, 0} : Vec3{0, 1, 0},
                    .hinge = is_thumb ? Vec3{0, 1, 0} : Vec3{1, 0, 0},
                    .length = lengths[f]};
      add_finger(f);
    }
    add_palm();
  }

  /// Where the vertices are when each finger is closed so far, from 0 to 1.
  void pose(const std::array<double, fingers>& closed, std::vector<Vec3>& positions) const {
    std::vector<AffineTransform> bones(skin.bone_count);
    for (int f = 0; f < fingers; ++f) {
      const Finger& finger = finger_[f];
      const double c = closed[static_cast<std::size_t>(f)];
      const auto joint = [&](double share) { return finger.base + finger.along * (share * finger.length); };
      // Besides, fingers come together, and the thumb goes towards them.
      const double aside = f == 4 ? 0.35 * c : -0.2 * (f - 1.5) * c;
      AffineTransform bone = turn_about(finger.base, {0, 0, 1}, aside);
      const double bends[] = {1.5, 1.5, 1.6};
      for (int k = 0; k < 3; ++k) {
        bone = bone * turn_about(joint(k / 3.0), finger.hinge, bends[k] * c);
        bones[static_cast<std::size_t>(1 + 3 * f + k)] = bone;
      }
    }
    positions.resize(mesh.positions.size());
    move_by_skin(skin, mesh.positions, bones, positions);
  }

 private:
  struct Finger {
    Vec3 base, along, hinge;
    double length = 0;
  };

  void weigh(std::uint32_t bone, double weight) {
    if (weight <= 0) return;
    skin.bones.push_back(bone);
    skin.weights.push_back(weight);
  }
  void end_vertex(int of_part) {
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
    part.push_back(of_part);
  }

  void add_finger(int f) {
    const Finger& finger = finger_[f];
    const Vec3 up{0, 0, 1}, side = cross(finger.along, up);
    constexpr std::uint32_t around = 12, rings = 16;
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto add = [&](double s, double thickness, double angle) {
      const auto turn = sin_cos(angle);
      mesh.positions.push_back(finger.base + finger.along * (s * finger.length) + side * (thickness * turn.cos) +
                               up * (thickness * turn.sin));
      // Evenly from bone to bone, around a third and two thirds of the length.
      const auto beyond = [&](double joint) { return std::clamp((s - joint) / 0.32 + 0.5, 0.0, 1.0); };
      const double second = beyond(1.0 / 3), third = beyond(2.0 / 3);
      const auto bone = static_cast<std::uint32_t>(1 + 3 * f);
      weigh(bone, 1 - second), weigh(bone + 1, second - third), weigh(bone + 2, third);
      end_vertex(f);
    };
    add(0, 0, 0);
    for (std::uint32_t r = 0; r < rings; ++r)
      for (std::uint32_t k = 0; k < around; ++k) {
        const double s = (r + 0.5) / rings, round = std::min({1.0, s * 8, (1 - s) * 8});
        add(s, radius * std::sqrt(round * (2 - round)), 2 * std::numbers::pi * (k + 0.5 * (r % 2)) / around);
      }
    add(1, 0, 0);
    const auto at = [&](std::uint32_t r, std::uint32_t k) { return first + 1 + r * around + k % around; };
    for (std::uint32_t k = 0; k < around; ++k) {
      mesh.facets.push_back({first, at(0, k), at(0, k + 1)});
      mesh.facets.push_back({at(rings - 1, k + 1), at(rings - 1, k), first + 1 + rings * around});
      for (std::uint32_t r = 0; r + 1 < rings; ++r) {
        mesh.facets.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
        mesh.facets.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
      }
    }
  }

  void add_palm() {
    Mesh palm = sample_body("blob", 12);
    const Box box = bounding_box(palm);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : palm.positions) {
      const Vec3 d = p - box.center(), e = box.extent();
      mesh.positions.push_back({0.4 + 0.84 * d.x / e.x, 0.48 + 0.9 * d.y / e.y, 0.13 + 0.24 * d.z / e.z});
      weigh(0, 1);
      end_vertex(fingers);
    }
    for (const Facet& f : palm.facets) mesh.facets.push_back({f[0] + first, f[1] + first, f[2] + first});
  }

  std::array<Finger, fingers> finger_;
};

/// All pairs of facets without a common vertex that intersect.
std::vector<FeaturePair> by_brute_force(const Mesh& mesh, const std::vector<Vec3>& at) {
  std::vector<Box> boxes(mesh.facets.size());
  for (std::size_t f = 0; f < boxes.size(); ++f)
    for (const std::uint32_t v : mesh.facets[f]) boxes[f].add(at[v]);
  std::vector<FeaturePair> found;
  for (std::uint32_t f = 0; f < boxes.size(); ++f)
    for (std::uint32_t g = f + 1; g < boxes.size(); ++g) {
      const Box &a = boxes[f], &b = boxes[g];
      if (a.lower.x > b.upper.x || b.lower.x > a.upper.x || a.lower.y > b.upper.y || b.lower.y > a.upper.y ||
          a.lower.z > b.upper.z || b.lower.z > a.upper.z)
        continue;
      const Facet &i = mesh.facets[f], &j = mesh.facets[g];
      if (std::find_first_of(i.begin(), i.end(), j.begin(), j.end()) != i.end()) continue;
      if (intersect(Triangle{at[i[0]], at[i[1]], at[i[2]]}, Triangle{at[j[0]], at[j[1]], at[j[2]]}))
        found.push_back({PairKind::facet_facet, f, g});
    }
  return found;
}

}  // namespace

int main() {
  const Hand hand;
  SurfaceTree tree(hand.mesh);
  std::printf("%zu vertices, %zu facets\n", hand.mesh.positions.size(), hand.mesh.facets.size());
  const auto part_of = [&](PairKind kind, bool is_a, std::uint32_t number) {
    if (kind == PairKind::edge_edge) return hand.part[tree.edges()[number][0]];
    return hand.part[kind == PairKind::vertex_facet && is_a ? number : tree.facets()[number][0]];
  };

  std::array<std::size_t, 2> most_crossings{};
  std::set<std::array<int, 2>> touched;
  for (const bool stops : {false, true}) {
    std::array<double, fingers> closed{};
    std::vector<Vec3> now, next;
    hand.pose(closed, now);
    SurfaceCrossingQuery crossings;
    SweptQuery swept({.distance = skin_thickness});
    ProximityQuery near({.distance = touching, .filter = {.same_component = true}});
    std::array<double, fingers> speed;
    speed.fill(1.0 / frames);
    for (int frame = 1; frame <= frames; ++frame) {
      // A step that would bring two features too near each other is taken without the fingers that they are of, until
      // none is left that moves towards another. What stands still can only be met by what moves.
      std::array<bool, fingers> moves;
      moves.fill(true);
      for (bool again = true; again;) {
        again = false;
        std::array<double, fingers> tried = closed;
        for (std::size_t f = 0; f < fingers; ++f) tried[f] += moves[f] ? speed[f] : 0;
        hand.pose(tried, next);
        if (stops) {
          if (!tree.update(now, next) || !swept.run(tree)) return 1;
          for (const SweptPair& pair : swept.pairs())
            for (const int of : {part_of(pair.kind, true, pair.a), part_of(pair.kind, false, pair.b)})
              if (of < fingers && moves[static_cast<std::size_t>(of)])
                moves[static_cast<std::size_t>(of)] = false, again = true;
        }
        if (!again) closed = tried;
      }
      now.swap(next);
      if (!tree.update(now) || !crossings.run(tree) || !near.run(tree)) return 1;
      const std::vector<FeaturePair> all = by_brute_force(hand.mesh, now);
      if (!std::equal(all.begin(), all.end(), crossings.pairs().begin(), crossings.pairs().end())) {
        std::printf("frame %d: brute force finds other crossings\n", frame);
        return 1;
      }
      most_crossings[stops] = std::max(most_crossings[stops], all.size());
      std::set<std::array<int, 2>> together;
      for (const ProximityPair& pair : near.pairs()) {
        const int a = part_of(pair.kind, true, pair.a), b = part_of(pair.kind, false, pair.b);
        together.insert({std::min(a, b), std::max(a, b)});
      }
      if (frame % 10 == 0)
        std::printf("%s, frame %2d: %4zu near pairs of features, %zu pairs of parts together, %zu crossings\n",
                    stops ? "stopping" : "freely  ", frame, near.pairs().size(), together.size(), all.size());
      if (stops) touched = together;
    }
    for (std::size_t f = 0; f < fingers; ++f) std::printf("  %s is closed to %.0f %%\n", names[f], 100 * closed[f]);
  }
  for (const auto& pair : touched) std::printf("  %s and %s touch\n", names[pair[0]], names[pair[1]]);
  // Without a query fingers go through the palm; with one they come to it and to each other, and nothing crosses.
  return most_crossings[0] > 0 && most_crossings[1] == 0 && touched.size() >= 4 ? 0 : 1;
}
