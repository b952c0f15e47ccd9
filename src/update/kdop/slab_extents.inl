// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of the slab kernels, on registers of wide.inl.

struct Slab {
  Wide lower, upper;
};
inline void add(Slab& slab, Wide value) {
  slab.lower = min(value, slab.lower);
  slab.upper = max(value, slab.upper);
}

/// The slabs of a k-DOP, in order.
template <int k>
struct Slabs {
  Slab slab[k / 2];
};

template <int k>
inline void add_points(Slabs<k>& slabs, const Rows& rows) {
  const WidePoints p = columns(rows);
  Slab* slab = slabs.slab;
  add(*slab++, p.x), add(*slab++, p.y), add(*slab++, p.z);
  const Wide sum = p.x + p.y, difference = p.x - p.y;
  if constexpr (has_corner_slabs(k)) {
    add(*slab++, sum + p.z), add(*slab++, sum - p.z);
    add(*slab++, difference + p.z), add(*slab++, difference - p.z);
  }
  if constexpr (has_edge_slabs(k)) {
    add(*slab++, sum), add(*slab++, difference);
    add(*slab++, p.x + p.z), add(*slab++, p.x - p.z);
    add(*slab++, p.y + p.z), add(*slab++, p.y - p.z);
  }
}
template <int k>
inline void write_bounds(const Slabs<k>& slabs, float* lower, float* upper) {
  for (int i = 0; i < k / 2; ++i) {
    lower[i] = least_lane(slabs.slab[i].lower);
    upper[i] = largest_lane(slabs.slab[i].upper);
  }
}

// Boxes need no columns: the coordinates of a point are the lanes of its box.
template <>
struct Slabs<6> {
  Slab slab[1];
};
template <>
inline void add_points<6>(Slabs<6>& box, const Rows& rows) {
  add(box.slab[0], rows.a), add(box.slab[0], rows.b), add(box.slab[0], rows.c), add(box.slab[0], rows.d);
}
template <>
inline void write_bounds<6>(const Slabs<6>& box, float* lower, float* upper) {
  const Wide low = box.slab[0].lower, high = box.slab[0].upper;
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis] = low[axis], upper[axis] = high[axis];
    for (int lane = axis + 4; lane < lanes; lane += 4) {
      lower[axis] = low[lane] < lower[axis] ? low[lane] : lower[axis];
      upper[axis] = high[lane] > upper[axis] ? high[lane] : upper[axis];
    }
  }
}

template <int k>
void slab_extents(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                  float* lower, float* upper) {
  Slabs<k> slabs;
  for (Slab& slab : slabs.slab) slab = {all(infinity), all(-infinity)};
  for (const PointRun *run = runs.data(), *end = run + runs.size(); run != end; ++run)
    for (std::uint32_t i = run->begin; i != run->end; i += lanes) add_points<k>(slabs, load_run(points + i));
  for (const std::uint32_t *i = index.data(), *end = i + index.size(); i != end; i += lanes)
    add_points<k>(slabs, gather(points, i));
  write_bounds<k>(slabs, lower, upper);
  // A sum with zero makes a negative zero positive: which of two equal zeros was kept depends on their order.
  for (int i = 0; i < k / 2; ++i) lower[i] += 0.0f, upper[i] += 0.0f;
}
