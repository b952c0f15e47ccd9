// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts and moves of a proxy among few facets; segments and facets of small whole coordinates, by whole numbers.
#include "surface/haptic/proxy_contacts.hpp"

#include <gtest/gtest.h>

#include <array>
#include <support/meshes.hpp>
#include <support/transforms.hpp>

namespace morula {
namespace {

using detail::KeptDistances;
using detail::NearFacet;

std::vector<NearFacet> two_facets(double below, double above) {
  return {{0, {Vec3{-1, -1, -below}, Vec3{1, -1, -below}, Vec3{0, 1, -below}}},
          {1, {Vec3{-1, -1, above}, Vec3{1, -1, above}, Vec3{0, 1, above}}}};
}

TEST(ProxyContacts, are_two_between_facets_that_face_each_other_however_near) {
  const KeptDistances kept(0.1, 1e-4);
  for (const double gap : {1e-2, 1e-5, 1e-8, 1e-12}) {
    std::vector<detail::ProxyContact> contacts;
    detail::find_contacts(two_facets(gap, 2 * gap), {}, kept, contacts);
    ASSERT_EQ(contacts.size(), 2u) << gap;
    EXPECT_EQ(contacts[0].normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(contacts[1].normal, (Vec3{0, 0, -1}));
  }
}

TEST(ProxyContacts, are_one_for_each_plane_of_many_facets) {
  // In a box whose faces have thousands of facets, three faces are within reach.
  const Vec3 center{0.7, 0.65, 0.6};
  for (const Vec3& offset : {Vec3{}, Vec3{1e6, -3e6, 2e6}})
    for (const int shifts : {0, 1, 2}) {
      const auto turned = [&](Vec3 p) {
        for (int k = 0; k < shifts; ++k) p = {p.y, p.z, p.x};
        return p + offset;
      };
      const Mesh box = test::box_mesh({-1, -1, -1}, {1, 1, 1}, 24);
      std::vector<NearFacet> near;
      for (std::uint32_t f = 0; f < box.facets.size(); ++f) {
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k) t[k] = turned(box.positions[box.facets[f][k]]);
        near.push_back({f, t});
      }
      std::vector<detail::ProxyContact> contacts;
      detail::find_contacts(near, turned(center), KeptDistances(0.8, 1e-3), contacts);
      ASSERT_EQ(contacts.size(), 3u) << offset.x << " " << shifts;
      Vec3 sum;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += contacts[k].normal;
        EXPECT_NEAR(contacts[k].distance, 1 - dot(-contacts[k].normal, turned(center) - offset), 1e-8);
        EXPECT_EQ(contacts[k].facet, near[contacts[k].place].facet);
        EXPECT_LT(k == 0 ? 0 : contacts[k - 1].place, contacts[k].place + (k == 0));
      }
      EXPECT_LT(distance(sum, {-1, -1, -1}), 1e-8);
    }
}

TEST(ProxyContacts, leave_a_share_of_each_move_however_near_the_facets_are) {
  const KeptDistances kept(0, 1e-4);
  for (const double gap : {1e-5, 1e-7, 1e-9}) {
    const double share = detail::free_share(two_facets(gap, 2 * gap), {}, {0, 0, 2 * gap}, kept);
    EXPECT_GT(share, 0.01) << gap;
    EXPECT_LT(share, 0.02) << gap;
  }
}

TEST(ProxyContacts, have_the_normals_of_their_facets_down_to_rounding) {
  // A facet in general position, far from the origin for its size; a point hardly off it.
  Random random(3);
  for (int round = 0; round < 500; ++round) {
    const Triangle t{test::random_point(random, 1), test::random_point(random, 1), test::random_point(random, 1)};
    if (length(area_vector(t)) < 0.1) continue;
    const Vec3 normal = normalized(area_vector(t));
    const double side = round % 2 == 0 ? 1 : -1;
    std::vector<detail::ProxyContact> contacts;
    detail::find_contacts({{0, t}}, at_barycentric(t, {0.3, 0.3, 0.4}) + side * 1e-14 * normal, KeptDistances(0, 1e-4),
                          contacts);
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_LT(distance(contacts[0].normal, side * normal), 1e-14) << round;
  }
}

// Whole numbers: every product below is exact.
using Whole = std::array<long long, 3>;

Whole minus(const Whole& a, const Whole& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
long long volume(const Whole& a, const Whole& b, const Whole& c, const Whole& d) {
  const Whole u = minus(b, a), v = minus(c, a), w = minus(d, a);
  return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

TEST(ProxyContacts, of_a_segment_are_found_exactly) {
  // A segment that is not in the plane of the facet meets it where the volumes over its three sides have one sign.
  Random random(4);
  int met = 0, touching = 0, tested = 0;
  const auto point = [&](long long reach) {
    const Vec3 p = test::random_whole(random, static_cast<double>(reach));
    return Whole{static_cast<long long>(p.x), static_cast<long long>(p.y), static_cast<long long>(p.z)};
  };
  const auto vec = [](const Whole& p) {
    return Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  };
  for (int round = 0; round < 40000; ++round) {
    const long long reach = round % 2 == 0 ? 3 : 1000;
    const Whole a = point(reach), b = point(reach), c = point(reach), p = point(reach), q = point(reach);
    const long long at_p = volume(a, b, c, p), at_q = volume(a, b, c, q);
    if (at_p == 0 && at_q == 0) continue;
    const long long u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
    const bool is_across = (at_p >= 0 && at_q <= 0) || (at_p <= 0 && at_q >= 0);
    const bool expected = is_across && ((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0));
    const std::vector<NearFacet> near{{0, {vec(a), vec(b), vec(c)}}};
    ASSERT_EQ(detail::meets_a_facet(near, vec(p), vec(q)), expected) << round;
    ++tested, met += expected, touching += expected && (at_p == 0 || at_q == 0 || u == 0 || v == 0 || w == 0);
    // From a point of the facet, the segment leaves it unless it stays in its plane.
    if (at_p == 0 && expected) {
      EXPECT_TRUE(detail::leaves_facets(near, vec(p), vec(q))) << round;
    }
  }
  EXPECT_GT(met, tested / 20);
  EXPECT_GT(touching, 500);
}

}  // namespace
}  // namespace morula
