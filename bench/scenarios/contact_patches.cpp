// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario patches: the contact patches of a bending mesh with the tip of a tool of 5,040 facets that slides over its
// top, and with a copy of the mesh on its top. Times include the update of bodies that move, depths and points. Volumes
// are compared with those of lines through both bodies, force with its reaction, gradients with their sums.
#include <algorithm>
#include <cmath>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <numbers>

#include "frames.hpp"
#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

/// Where a line along z passes the surface of a or b.
struct LinePoint {
  double z;
  int winding;  // change of the winding number upward
  bool of_b;
};

/// A grid of lines along z over a box.
class LineGrid {
 public:
  explicit LineGrid(const Box& box) : box_(box), lines_(std::size_t{count} * count) {}

  void add(const Collider& body, bool of_b) {
    const Vec3 step = box_.extent() / count;
    for (std::uint32_t f = 0; f < body.mesh_facets().size(); ++f) {
      const Triangle t = body.triangle(f);
      const Vec3 n = area_vector(t), lower = min(min(t[0], t[1]), t[2]), upper = max(max(t[0], t[1]), t[2]);
      if (n.z == 0) continue;
      const auto range = [&](int axis) {
        const double first = std::ceil((lower[axis] - box_.lower[axis]) / step[axis] - 0.5);
        const double last = std::floor((upper[axis] - box_.lower[axis]) / step[axis] - 0.5);
        return std::pair{static_cast<int>(std::clamp(first, 0.0, count + 0.0)),
                         static_cast<int>(std::clamp(last, -1.0, count - 1.0))};
      };
      const auto [x0, x1] = range(0);
      const auto [y0, y1] = range(1);
      for (int i = x0; i <= x1; ++i)
        for (int j = y0; j <= y1; ++j) {
          const Vec3 p{box_.lower.x + (i + 0.5) * step.x, box_.lower.y + (j + 0.5) * step.y, 0};
          if (!holds(t, p)) continue;
          const double z = t[0].z - (n.x * (p.x - t[0].x) + n.y * (p.y - t[0].y)) / n.z;
          lines_[static_cast<std::size_t>(i * count + j)].push_back({z, n.z < 0 ? 1 : -1, of_b});
        }
    }
  }
  double volume() {
    double sum = 0;
    for (std::vector<LinePoint>& line : lines_) {
      std::sort(line.begin(), line.end(), [](const LinePoint& p, const LinePoint& q) { return p.z < q.z; });
      int winding[2] = {0, 0};
      for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        winding[line[k].of_b] += line[k].winding;
        sum += winding[0] * winding[1] * (line[k + 1].z - line[k].z);
      }
    }
    const Vec3 e = box_.extent();
    return sum * e.x * e.y / (count * count);
  }

 private:
  static constexpr int count = 160;

  static bool holds(const Triangle& t, const Vec3& p) {
    int turns = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = t[k], &b = t[(k + 1) % 3];
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      const bool right = a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y)) > p.x;
      if (right) turns += a.y <= p.y ? 1 : -1;
    }
    return turns != 0;
  }

  Box box_;
  std::vector<std::vector<LinePoint>> lines_;
};

Box box_of(const Collider& body) {
  Box box;
  for (std::uint32_t v = 0; v < body.vertex_count(); ++v) box.add(body.vertex(v));
  return box;
}

/// Checks the present result by other means.
void verify(const ContactPatchQuery& query, const Collider& a, const Collider& b, Result& result) {
  const Box box_a = box_of(a), box_b = box_of(b);
  const Box common{max(box_a.lower, box_b.lower), min(box_a.upper, box_b.upper)};
  if (common.lower.x < common.upper.x && common.lower.y < common.upper.y) {
    LineGrid lines(common);
    lines.add(a, false);
    lines.add(b, true);
    const Vec3 e = common.extent();
    const double tolerance = 0.02 * query.volume() + 1e-5 * e.x * e.y * std::abs(e.z);
    result.expect(std::abs(lines.volume() - query.volume()) <= tolerance, "not the volume that lines find");
  } else {
    result.expect(query.volume() == 0, "a volume of bodies that are apart");
  }
  for (const ContactPatch& patch : query.patches()) {
    const double slack = 1e-11 * (patch.a.area + patch.b.area);
    result.expect(length(patch.a.area_vector + patch.b.area_vector) <= slack, "action is not reaction");
    Vec3 sum, force;
    for (const VertexGradient& g : patch.a.gradients) sum += g.gradient;
    for (const PatchPoint& point : patch.points) force += point.force;
    result.expect(length(sum - patch.a.area_vector) <= slack, "gradients do not add up");
    if (!patch.points.empty())
      result.expect(length(force + patch.a.area_vector) <= slack, "forces of points do not add up");
  }
}

struct PressedPair {
  const char* item;
  Collider &a, &b;
  std::vector<RigidTransform> places;  // of b, by frame
};

/// The tool stands on the highest point of the mesh, a fiftieth of its size inside, and slides.
std::vector<RigidTransform> slides(const Mesh& mesh, const Mesh& tool, std::size_t count) {
  const Box of_tool = bounding_box(tool);
  const double size = bounding_box(mesh).diagonal();
  Vec3 top = mesh.positions.front();
  for (const Vec3& p : mesh.positions)
    if (p.z > top.z) top = p;
  const RigidTransform down = RigidTransform::from_axis({0, 1, 0}, std::numbers::pi / 2);
  const Vec3 lowest = down(Vec3{of_tool.upper.x, of_tool.center().y, of_tool.center().z});
  std::vector<RigidTransform> places;
  for (std::size_t f = 0; f < count; ++f) {
    const double way = static_cast<double>(f) / static_cast<double>(count);
    places.push_back({down.rows, top + Vec3{0.02 * way, 0.013 * way, -0.02} * size - lowest});
  }
  return places;
}

/// The copy lies on the mesh, turned by a right angle and more, a fiftieth of its height deeper than where they meet.
std::vector<RigidTransform> turns(Collider& a, Collider& b, std::size_t count) {
  const Box box = bounding_box(a.surface());
  const auto place = [&](double height, double way) {
    const RigidTransform turn = RigidTransform::from_axis({0, 0, 1}, 0.5 * std::numbers::pi + 0.1 * way);
    const Vec3 center = box.center();
    return RigidTransform{turn.rows, center - turn.rotate(center) + Vec3{0, 0, height * box.extent().z}};
  };
  CrossingQuery crossings;
  double height = 1;
  for (; height > 0; height -= 0.02) {
    b.set_transform(place(height, 0));
    require(crossings.run(a, b));
    if (!crossings.pairs().empty()) break;
  }
  std::vector<RigidTransform> places;
  for (std::size_t f = 0; f < count; ++f)
    places.push_back(place(height - 0.02, static_cast<double>(f) / static_cast<double>(count)));
  return places;
}

}  // namespace

std::vector<Result> run_patches(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  Body body(input.mesh, model, {}, *settings.workers), copy(input.mesh, model, {}, *settings.workers);
  const Mesh tool = sample_body("tool", 48);
  Body steel(tool, build(tool, tree_options(settings), *settings.workers));
  Collider a(input.mesh, body), b(input.mesh, copy), tip(tool, steel);
  const std::vector<Frame> frames = bend_and_back(input.mesh);

  const std::vector<RigidTransform> of_tip = slides(input.mesh, tool, frames.size());
  const std::vector<RigidTransform> of_copy = turns(a, b, frames.size());
  std::vector<Result> results;
  for (const PressedPair& pair : {PressedPair{"tool", a, tip, of_tip}, PressedPair{"copy", a, b, of_copy}}) {
    Result result{.scenario = "patches", .item = pair.item, .mesh = input.name};
    ContactPatchQuery query(pair.a, pair.b);
    CrossingQuery crossings;
    const auto move = [&](std::size_t f) {
      require(body.update(frames[f], *settings.workers));
      pair.b.set_transform(pair.places[f]);
    };
    std::vector<double> alone, of_crossings;
    double patches = 0, facets = 0, pairs = 0, volume = 0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      move(f);
      require(query.run());
      if (f % 6 == 0) verify(query, pair.a, pair.b, result);
      patches += static_cast<double>(query.patches().size());
      volume = std::max(volume, query.volume());
      for (const ContactPatch& patch : query.patches())
        facets += static_cast<double>(patch.a.facets.size() + patch.b.facets.size());
    }
    timed(settings, [&] {
      for (std::size_t f = 0; f < frames.size(); ++f) {
        const double moving = processor_seconds_of([&] { move(f); });
        alone.push_back(processor_seconds_of([&] { require(query.run()); }));
        result.seconds.push_back(moving + alone.back());
        of_crossings.push_back(processor_seconds_of([&] { require(crossings.run(pair.a, pair.b)); }));
        pairs += static_cast<double>(crossings.pairs().size());
      }
    });
    const auto mean = [&](double sum) { return sum / static_cast<double>(frames.size()); };
    result.figures = {{"query_us", median(alone) * 1e6},
                      {"crossings_us", median(of_crossings) * 1e6},
                      {"patches", mean(patches)},
                      {"facets", mean(facets)},
                      {"crossings", pairs / static_cast<double>(alone.size())},
                      {"largest_volume", volume}};
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace morula::bench
