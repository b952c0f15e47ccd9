// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of filter.cpp: each configuration has a lane.

constexpr int registers = static_cast<int>(filter_block) / lanes;
constexpr unsigned every_lane = (1u << lanes) - 1;

struct WideCenter {
  Wide x, y, z;
};
inline WideCenter center_of(const PlacedCenter& c, int q) {
  return {load(c.x + q * lanes), load(c.y + q * lanes), load(c.z + q * lanes)};
}
inline Wide square_apart(const WideCenter& a, const WideCenter& b) {
  const Wide x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}
// Squares of the length from which on there is a gap, and up to which there is a contact; below 0 if there is none.
inline float gap_from(float reach, float allowance) {
  return (reach + allowance) * (reach + allowance);
}
inline float contact_to(float reach, float allowance) {
  return reach > 2 * allowance ? (reach - allowance) * (reach - allowance) : -1;
}
// Configurations of this register, lowest bit first.
inline unsigned part_of(unsigned wanted, int q) {
  return wanted >> (q * lanes) & every_lane;
}

void place(const PlacedLink& link, const Spheref* spheres, std::size_t count, PlacedCenter* centers) {
  for (int q = 0; q < registers; ++q) {
    Wide m[12];
    for (int k = 0; k < 12; ++k) m[k] = load(link.entries[k] + q * lanes);
    for (std::size_t i = 0; i < count; ++i) {
      const Wide x = all(spheres[i].center.x), y = all(spheres[i].center.y), z = all(spheres[i].center.z);
      store(m[0] * x + m[1] * y + m[2] * z + m[3], centers[i].x + q * lanes);
      store(m[4] * x + m[5] * y + m[6] * z + m[7], centers[i].y + q * lanes);
      store(m[8] * x + m[9] * y + m[10] * z + m[11], centers[i].z + q * lanes);
    }
  }
}

LaneSets groups(const PlacedGroup& a, const PlacedGroup& b, float allowance, unsigned wanted) {
  LaneSets result;
  for (int q = 0; q < registers; ++q) {
    unsigned open = part_of(wanted, q);
    if (open == 0) continue;
    const WideCenter around_b = center_of(b.centers[0], q);
    const auto gaps = [&](std::size_t i, const WideCenter& p) {
      return lanes_at_most(all(gap_from(a.radii[i] + b.radii[0], allowance)), square_apart(p, around_b));
    };
    open &= ~gaps(0, center_of(a.centers[0], q));
    unsigned near = 0, contacts = 0;
    for (std::size_t i = 1; i < a.count && open != 0; ++i) {
      const WideCenter p = center_of(a.centers[i], q);
      if ((open & ~gaps(i, p)) == 0) continue;
      Wide least = all(1);
      for (std::size_t j = 1; j < b.count; ++j)
        least =
            min(square_apart(p, center_of(b.centers[j], q)) - all(gap_from(a.radii[i] + b.radii[j], allowance)), least);
      const unsigned found = lanes_at_most(least, Wide{}) & open;
      if (found == 0) continue;
      near |= found;
      for (std::size_t j = 1; j < b.count; ++j)
        contacts |= lanes_at_most(square_apart(p, center_of(b.centers[j], q)),
                                  all(contact_to(a.radii[i] + b.radii[j], allowance))) &
                    found;
      open &= ~contacts;
    }
    result.near |= near << (q * lanes), result.contacts |= contacts << (q * lanes);
  }
  return result;
}

// Squares of distances from an obstacle against the reach of each sphere.
template <class Square>
inline LaneSets group_near(const PlacedGroup& group, float more, float allowance, unsigned wanted,
                           const Square& square) {
  LaneSets result;
  for (int q = 0; q < registers; ++q) {
    unsigned open = part_of(wanted, q);
    if (open == 0) continue;
    open &= ~lanes_at_most(all(gap_from(group.radii[0] + more, allowance)), square(center_of(group.centers[0], q)));
    unsigned near = 0, contacts = 0;
    for (std::size_t i = 1; i < group.count && open != 0; ++i) {
      const Wide d = square(center_of(group.centers[i], q));
      const float reach = group.radii[i] + more;
      near |= ~lanes_at_most(all(gap_from(reach, allowance)), d) & open;
      contacts |= lanes_at_most(d, all(contact_to(reach, allowance))) & open;
      open &= ~contacts;
    }
    result.near |= near << (q * lanes), result.contacts |= contacts << (q * lanes);
  }
  return result;
}

inline Wide beyond(Wide local, float half) {
  return max(max(local, -local) - all(half), Wide{});
}

LaneSets box(const PlacedGroup& group, const FilterBox& box, float allowance, unsigned wanted) {
  return group_near(group, 0, allowance, wanted, [&](const WideCenter& c) {
    const Wide x = c.x - all(box.center[0]), y = c.y - all(box.center[1]), z = c.z - all(box.center[2]);
    const auto along = [&](int k) {
      return beyond(all(box.rows[k][0]) * x + all(box.rows[k][1]) * y + all(box.rows[k][2]) * z, box.half[k]);
    };
    const Wide a = along(0), b = along(1), d = along(2);
    return a * a + b * b + d * d;
  });
}

LaneSets sphere(const PlacedGroup& group, const Spheref& sphere, float allowance, unsigned wanted) {
  const WideCenter center{all(sphere.center.x), all(sphere.center.y), all(sphere.center.z)};
  return group_near(group, sphere.radius, allowance, wanted,
                    [&](const WideCenter& c) { return square_apart(c, center); });
}

unsigned bounds(const PlacedGroup& group, const float* lower, const float* upper, float allowance, unsigned wanted) {
  unsigned near = 0;
  for (int q = 0; q < registers; ++q) {
    const WideCenter c = center_of(group.centers[0], q);
    const auto along = [&](Wide p, int k) { return max(max(all(lower[k]) - p, p - all(upper[k])), Wide{}); };
    const Wide x = along(c.x, 0), y = along(c.y, 1), z = along(c.z, 2);
    near |= (~lanes_at_most(all(gap_from(group.radii[0], allowance)), x * x + y * y + z * z) & every_lane)
            << (q * lanes);
  }
  return near & wanted;
}

constexpr FilterKernels kernels{place, groups, box, sphere, bounds};
