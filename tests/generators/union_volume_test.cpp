// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Empty space in the union of a set of spheres, set after set: each as if it were the first.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/driver/union_volume.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/signed_distance.hpp>
#include <support/meshes.hpp>

#include "on_capsule.hpp"

namespace morula {
using namespace detail;
namespace {

using test::OnCapsule;

TEST(UnionVolume, of_one_sphere_is_its_outside_volume) {
  const OnCapsule on;
  UnionVolume volume(on.lines);
  for (const Sphere& s :
       {Sphere{{0.3, 0.4, 0.1}, 0.3}, Sphere{{1.4, 0.1, 0}, 0.4}, Sphere{{0, 3, 0}, 0.7}, Sphere{{0, 0, 0}, 2}}) {
    const double exact = outside_volume(on.shape.distance(), s);
    EXPECT_NEAR(volume.outside({&s, 1}), exact, 0.05 * exact) << "at " << s.center.x << ", " << s.center.y;
  }
}

// Spheres that come and go, twice in a set, side by side with others that reach far out; on bodies whose faces lie on
// lines and on those that no line meets.
TEST(UnionVolume, has_the_same_bits_whatever_came_before) {
  for (const test::NamedMesh& body : test::all_meshes()) {
    if (body.mesh.facets.empty()) continue;
    const ObjectShape shape(body.mesh);
    for (const int cells : {16, 100}) {
      const ObjectLines lines(body.mesh, shape, cells, serial_workers());
      const Box box = shape.bounding_box();
      const double size = max_norm(box.extent());
      Random random(7);
      const auto some = [&] {
        Sphere s{box.center(), size * random.uniform(0, 0.4)};
        for (int k = 0; k < 3; ++k) s.center[k] += size * random.uniform(-0.5, 0.5);
        return s;
      };
      UnionVolume volume(lines);
      std::vector<Sphere> spheres{some()};
      for (int step = 0; step < 24; ++step) {
        const std::size_t which = std::min(
            spheres.size() - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(spheres.size())));
        if (step % 4 == 0)
          spheres[which] = some();
        else if (step % 7 == 3)
          spheres.push_back(spheres[which]);
        else if (step % 7 == 5 && spheres.size() > 1)
          spheres.erase(spheres.begin() + static_cast<std::ptrdiff_t>(which));
        else
          spheres.push_back(some());
        if (step == 11) spheres.back().radius *= 3;
        const double first = UnionVolume(lines).outside(spheres);
        const Sphere& one = spheres.front();
        EXPECT_EQ(volume.outside(one), UnionVolume(lines).outside({&one, 1})) << body.name << ", step " << step;
        EXPECT_EQ(volume.outside(spheres), first) << body.name << ", step " << step;
        std::reverse(spheres.begin(), spheres.end());
        EXPECT_EQ(volume.outside(spheres), first) << body.name << ", step " << step;
      }
    }
  }
}

}  // namespace
}  // namespace morula
