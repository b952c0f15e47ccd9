// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/collide/primitives.hpp>
#include <morula/tree/walk.hpp>

#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "collide/shapes/placed_shapes.hpp"
#include "geometry/exact_predicates.hpp"
#include "geometry/infinity.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// The ray as the axis of sheared coordinates [woop2013].
class ShearedRay {
 public:
  explicit ShearedRay(const Ray& ray) : origin_(ray.origin), t_end_(ray.t_end) {
    // The direction is scaled by a power of two, which changes no bit of the answer: its squares may be out of range.
    const int exponent = std::ilogb(max_norm(ray.direction));
    for (int axis = 0; axis < 3; ++axis) scaled_[axis] = std::ldexp(ray.direction[axis], -exponent);
    scale_ = std::ldexp(1.0, -exponent);
    size_ = length(scaled_);
    unit_ = scaled_ / size_;
    // The longest axis becomes the ray's; the order of the others keeps the orientation.
    const Vec3 size{std::abs(scaled_.x), std::abs(scaled_.y), std::abs(scaled_.z)};
    z_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    if (scaled_[z_] < 0) std::swap(x_, y_);
    shear_x_ = scaled_[x_] / scaled_[z_];
    shear_y_ = scaled_[y_] / scaled_[z_];
  }

  // A lower bound of the t of all hits in the sphere; infinite when there are none.
  //
  // Let S bound |coordinates| of origin and sphere. Differences to the origin are off by u S, the foot on the line and
  // the remainder by a dozen u S, and sheared vertices stand for real ones within 6 u S: the sum is below 64 u S; the
  // allowance is 2^-45 S = 256 u S.
  double bound(const Sphere& s) const {
    const Vec3 offset = s.center - origin_;
    const double along = dot(offset, unit_);
    // mutant ray-pad: `0x1p-45` -> `0`
    const double pad = 0x1p-45 * (max_norm(s.center) + s.radius + max_norm(origin_));
    const double reach = s.radius + pad;
    const double aside = squared_length(offset - unit_ * along), reach_squared = reach * reach;
    if (aside > reach_squared || along + reach < 0) return infinity;
    // The nearer end of the chord; when the ray starts inside, its start.
    const double half = std::sqrt(reach_squared - aside);
    const double first = (along - half - pad) / size_ * scale_;
    return first > t_end_ ? infinity : first;
  }

  // Whether the ray hits the triangle at a t from 0 to `limit`.
  bool hits(const Triangle& t, double limit, double& where, Barycentric& barycentric) const {
    std::array<Vec3, 3> from_origin{t[0] - origin_, t[1] - origin_, t[2] - origin_};
    // Areas of very small and near triangles would underflow: they are scaled up by a power of two, which changes no
    // verdict.
    const double largest = std::max({max_norm(from_origin[0]), max_norm(from_origin[1]), max_norm(from_origin[2])});
    constexpr double least_ordinary = 0x1p-400;
    const int exponent = largest > 0 && largest < least_ordinary ? std::ilogb(largest) : 0;
    if (exponent != 0)
      for (Vec3& p : from_origin)
        p = {std::ldexp(p.x, -exponent), std::ldexp(p.y, -exponent), std::ldexp(p.z, -exponent)};
    double x[3], y[3], z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = from_origin[k];
      x[k] = p[x_] - shear_x_ * p[z_];
      y[k] = p[y_] - shear_y_ * p[z_];
      z[k] = p[z_];
    }
    // Most triangles are wholly on one side: the signs below would differ, or all areas be 0.
    const auto is_aside = [](const double(&c)[3]) {
      // mutant ray-aside: `c[0] > 0` -> `c[0] >= 0`
      return (c[0] > 0 && c[1] > 0 && c[2] > 0) || (c[0] < 0 && c[1] < 0 && c[2] < 0);
    };
    if (is_aside(x) || is_aside(y)) return false;
    // The side of the origin, which is the ray, on which an edge passes.
    const auto side = [&](int from, int to) {
      return orient2d({}, {x[from], y[from], 0}, {x[to], y[to], 0}, projections[2]);
    };
    const int u = side(2, 1), v = side(0, 2), w = side(1, 0);
    // mutant ray-edges: `< 0 || v < 0 || w <` -> `<= 0 || v <= 0 || w <=`
    if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
    // Signs are exact, magnitudes nearly: one magnitude may have lost all its digits.
    const double a = u == 0 ? 0.0 : std::abs(x[2] * y[1] - y[2] * x[1]);
    const double b = v == 0 ? 0.0 : std::abs(x[0] * y[2] - y[0] * x[2]);
    const double c = w == 0 ? 0.0 : std::abs(x[1] * y[0] - y[1] * x[0]);
    const double sum = a + b + c;
    if (!(sum > 0)) return false;
    barycentric = {a / sum, b / sum, c / sum};
    const double height = z[0] + barycentric[1] * (z[1] - z[0]) + barycentric[2] * (z[2] - z[0]);
    where = std::ldexp(height / scaled_[z_], exponent) * scale_;
    return where >= 0 && where <= limit;
  }
  double t_end() const { return t_end_; }

 private:
  Vec3 origin_, scaled_, unit_;
  double t_end_, scale_, size_;
  double shear_x_, shear_y_;
  int x_, y_, z_;
};

/// The point of a facet that a ray hits, from its t and barycentric coordinates.
RayPoint finished_point(const Collider& body, RayPoint point) {
  const Triangle corners = body.triangle(point.point.facet);
  point.point.point = at_barycentric(corners, point.point.barycentric);
  point.normal = normalized(area_vector(corners), Vec3{0, 0, 0});
  return point;
}

/// Calls found(point) for every facet that the ray hits at a t up to `limit`, which found() may lower; for a facet with
/// several leaves, perhaps several times. Points have no coordinates and no normal yet.
template <class Found>
RayHit walk_along(const Collider& body, const Ray& ray, double& limit, const Found& found) {
  RayHit result;
  result.status = askable(body);
  if (result.status && !is_usable(ray)) result.status = {Status::Code::bad_shape};
  if (!result.status) return result;
  result.certified = body.sphere_state().covers;
  const PlacedSpheres spheres(body);
  const ShearedRay sheared(ray);
  // Bounds of spheres that are missed are infinite: the limit stays below.
  limit = std::min(ray.t_end, std::numeric_limits<double>::max());
  const auto bound = [&](std::uint32_t node) {
    ++result.sphere_tests;
    return sheared.bound(spheres(node));
  };
  walk_nearest_first(
      body.tree(), bound, [&] { return limit; }, [](double) {},
      [&](std::uint32_t leaf, double) {
        for (const std::uint32_t facet : body.facets(leaf)) {
          ++result.facet_tests;
          double t = 0;
          Barycentric barycentric{};
          if (sheared.hits(body.triangle(facet), limit, t, barycentric))
            found(RayPoint{t, {facet, barycentric, {}}, {}});
        }
        return true;
      });
  return result;
}

}  // namespace

RayHit RayQuery::run(const Collider& body, const Ray& ray) const {
  const StandardFloats standard;
  std::optional<RayPoint> first;
  double limit = 0;
  RayHit result = walk_along(body, ray, limit, [&](const RayPoint& point) {
    if (first && point.t == first->t && point.point.facet >= first->point.facet) return;
    first = point;
    limit = point.t;
  });
  if (first) result.first = finished_point(body, *first);
  return result;
}

RayHit RayQuery::run_all(const Collider& body, const Ray& ray, std::vector<RayPoint>& hits) const {
  const StandardFloats standard;
  hits.clear();
  double limit = 0;
  RayHit result = walk_along(body, ray, limit, [&](const RayPoint& point) { hits.push_back(point); });
  // A facet has the same numbers in all of its leaves.
  std::sort(hits.begin(), hits.end(), [](const RayPoint& x, const RayPoint& y) {
    return x.t != y.t ? x.t < y.t : x.point.facet < y.point.facet;
  });
  // mutant ray-facets-once: `hits.erase(` -> `static_cast<void>(`
  hits.erase(std::unique(hits.begin(), hits.end(),
                         [](const RayPoint& x, const RayPoint& y) { return x.point.facet == y.point.facet; }),
             hits.end());
  for (RayPoint& point : hits) point = finished_point(body, point);
  if (!hits.empty()) result.first = hits.front();
  return result;
}

std::vector<RayPoint> all_hits(const Collider& body, const Ray& ray) {
  std::vector<RayPoint> hits;
  require_good(RayQuery().run_all(body, ray, hits).status);
  return hits;
}

RayHit first_hit(const Collider& body, const Ray& ray) {
  const RayHit result = RayQuery().run(body, ray);
  require_good(result.status);
  return result;
}

}  // namespace morula
