// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What every instruction set does alike. Included by slab_extents.cpp once for each, inside a namespace that has
//   Wide                                registers of floats with + and -, min and max
//   all(x)                              x in every lane
//   points_per_register                 how many points fill one when their coordinates are its lanes
//   load_run(points)                  so many points that lie one after the other
//   load_listed(points, index)          so many: index[0], index[4], …
//   points_to_columns(a, b, c, d)       four of those: a, b, c become the x, y and z of the points
//   lanes_of(wide)                      an array
// and with MORULA_TARGET, what a function must carry to be compiled for it.

constexpr std::size_t points_per_step = 4 * points_per_register;

struct Slab {
  Wide lower, upper;
};
MORULA_TARGET inline void add(Slab& slab, Wide value) {
  slab.lower = min(value, slab.lower);
  slab.upper = max(value, slab.upper);
}

struct Rows {
  Wide row[4];
};
MORULA_TARGET inline Rows run_rows(const LocalPoint* points) {
  return {load_run(points), load_run(points + points_per_register), load_run(points + 2 * points_per_register),
          load_run(points + 3 * points_per_register)};
}
MORULA_TARGET inline Rows listed_rows(const LocalPoint* points, const std::uint32_t* index) {
  return {load_listed(points, index), load_listed(points, index + 1), load_listed(points, index + 2),
          load_listed(points, index + 3)};
}

/// The slabs of a k-DOP, in order.
template <int k>
struct Slabs {
  Slab slab[k / 2];
};

template <int k>
MORULA_TARGET inline void add_points(Slabs<k>& slabs, const Rows& rows) {
  Wide x = rows.row[0], y = rows.row[1], z = rows.row[2];
  points_to_columns(x, y, z, rows.row[3]);
  Slab* slab = slabs.slab;
  add(*slab++, x), add(*slab++, y), add(*slab++, z);
  const Wide sum = x + y, difference = x - y;
  if constexpr (has_corner_slabs(k)) {
    add(*slab++, sum + z), add(*slab++, sum - z);
    add(*slab++, difference + z), add(*slab++, difference - z);
  }
  if constexpr (has_edge_slabs(k)) {
    add(*slab++, sum), add(*slab++, difference);
    add(*slab++, x + z), add(*slab++, x - z);
    add(*slab++, y + z), add(*slab++, y - z);
  }
}
template <int k>
MORULA_TARGET inline void write_bounds(const Slabs<k>& slabs, float* lower, float* upper) {
  for (int i = 0; i < k / 2; ++i) {
    const auto low = lanes_of(slabs.slab[i].lower), high = lanes_of(slabs.slab[i].upper);
    lower[i] = *std::min_element(low.begin(), low.end());
    upper[i] = *std::max_element(high.begin(), high.end());
  }
}

// Boxes need no columns: the coordinates of a point are the lanes of its box.
template <>
struct Slabs<6> {
  Slab slab[1];
};
template <>
MORULA_TARGET inline void add_points<6>(Slabs<6>& box, const Rows& rows) {
  for (const Wide row : rows.row) add(box.slab[0], row);
}
template <>
MORULA_TARGET inline void write_bounds<6>(const Slabs<6>& box, float* lower, float* upper) {
  const auto low = lanes_of(box.slab[0].lower), high = lanes_of(box.slab[0].upper);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower[axis] = low[axis], upper[axis] = high[axis];
    for (std::size_t lane = axis + 4; lane < low.size(); lane += 4) {
      lower[axis] = std::min(lower[axis], low[lane]);
      upper[axis] = std::max(upper[axis], high[lane]);
    }
  }
}

template <int k>
MORULA_TARGET void slab_extents(const LocalPoint* points, std::span<const PointRun> runs,
                                std::span<const std::uint32_t> index, float* lower, float* upper) {
  Slabs<k> slabs;
  for (Slab& slab : slabs.slab) slab = {all(infinity), all(-infinity)};
  for (const PointRun& run : runs)
    for (std::uint32_t i = run.begin; i != run.end; i += points_per_step) add_points<k>(slabs, run_rows(points + i));
  for (std::size_t j = 0; j < index.size(); j += points_per_step) add_points<k>(slabs, listed_rows(points, &index[j]));
  write_bounds<k>(slabs, lower, upper);
  // A sum with zero makes a negative zero positive: which of two equal zeros was kept depends on their order.
  for (int i = 0; i < k / 2; ++i) lower[i] += 0.0f, upper[i] += 0.0f;
}
