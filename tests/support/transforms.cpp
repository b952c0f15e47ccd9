// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "support/transforms.hpp"

#include <cmath>

namespace morula::test {

Vec3 random_point(Random& random, double reach) {
  const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}

Vec3 random_whole(Random& random, double reach) {
  const Vec3 p = random_point(random, reach);
  return {std::round(p.x), std::round(p.y), std::round(p.z)};
}

RigidTransform random_transform(Random& random, double reach, const Vec3& about) {
  const auto number = [&] { return random.uniform(-1, 1); };
  const double w = number(), x = number(), y = number(), z = number();
  return RigidTransform::from_quaternion(w, x, y, z, about + random_point(random, reach));
}

}  // namespace morula::test
