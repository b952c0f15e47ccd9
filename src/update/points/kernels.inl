// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of the update's kernels, on registers of wide.inl.

inline Wide squared_distance(const WidePoints& p, Wide x, Wide y, Wide z) {
  const Wide dx = p.x - x, dy = p.y - y, dz = p.z - z;
  return dx * dx + dy * dy + dz * dz;
}

template <int count>
struct Centers {
  Wide x[count], y[count], z[count];
};
template <int count>
[[gnu::always_inline]] inline void measure(const WidePoints& p, const Centers<count>& c, Wide (&farthest)[count]) {
  for (int k = 0; k < count; ++k) farthest[k] = max(squared_distance(p, c.x[k], c.y[k], c.z[k]), farthest[k]);
}

template <int count>
void farthest_of_few(const LocalPoint* points, const PointRun* run, const PointRun* runs_end,
                     const std::uint32_t* index, const std::uint32_t* index_end, const Vec3f* centers, float* squared) {
  Centers<count> c;
  Wide farthest[count];
  for (int k = 0; k < count; ++k) {
    c.x[k] = all(centers[k].x), c.y[k] = all(centers[k].y), c.z[k] = all(centers[k].z);
    farthest[k] = Wide{};
  }
  for (; run != runs_end; ++run)
    for (std::uint32_t i = run->begin; i != run->end; i += lanes) measure(columns(load_run(points + i)), c, farthest);
  for (; index != index_end; index += lanes) measure(columns(gather(points, index)), c, farthest);
  for (int k = 0; k < count; ++k) squared[k] = largest_lane(farthest[k]);
}

void farthest(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
              std::span<const Vec3f> centers, float* squared) {
  const PointRun *run = runs.data(), *runs_end = run + runs.size();
  const std::uint32_t *i = index.data(), *index_end = i + index.size();
  switch (centers.size()) {
    case 4:
      return farthest_of_few<4>(points, run, runs_end, i, index_end, centers.data(), squared);
    case 3:
      return farthest_of_few<3>(points, run, runs_end, i, index_end, centers.data(), squared);
    case 2:
      return farthest_of_few<2>(points, run, runs_end, i, index_end, centers.data(), squared);
    case 1:
      return farthest_of_few<1>(points, run, runs_end, i, index_end, centers.data(), squared);
    default:
      return;
  }
}

// Largest squared distance to the points of a group, which `row` gives: row(i) has `lanes` of them from the i-th on.
template <class Row>
[[gnu::always_inline]] inline Wide farthest_of_group(const Row& row, Wide x, Wide y, Wide z) {
  Wide farthest{};
  for (std::size_t i = 0; i < points_per_group; i += lanes)
    farthest = max(squared_distance(columns(row(i)), x, y, z), farthest);
  return farthest;
}

// visit(row) for each group.
template <class Visit>
[[gnu::always_inline]] inline void each_group(const LocalPoint* points, std::span<const PointRun> runs,
                                              std::span<const std::uint32_t> index, const Visit& visit) {
  for (const PointRun& run : runs)
    for (std::uint32_t p = run.begin; p != run.end; p += points_per_group)
      visit([&](std::size_t i) { return load_run(points + p + i); });
  for (std::size_t p = 0; p != index.size(); p += points_per_group)
    visit([&](std::size_t i) { return gather(points, &index[p + i]); });
}

void farthest_of_groups(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                        const Vec3f& center, float* groups) {
  const Wide x = all(center.x), y = all(center.y), z = all(center.z);
  each_group(points, runs, index, [&](const auto& row) { *groups++ = largest_lane(farthest_of_group(row, x, y, z)); });
}

float farthest_of_some(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                       const Vec3f& center, const float* groups, float least) {
  const Wide x = all(center.x), y = all(center.y), z = all(center.z);
  Wide farthest{};
  each_group(points, runs, index, [&](const auto& row) {
    if (*groups++ >= least) farthest = max(farthest_of_group(row, x, y, z), farthest);
  });
  return largest_lane(farthest);
}

Vec3f pull(const LocalPoint* points, const Pull& pull, const Vec3f& center) {
  constexpr int packs = static_cast<int>(core_size) / lanes;
  WidePoints core[packs];
  for (int k = 0; k < packs; ++k) core[k] = columns(gather(points, pull.core + k * lanes));

  float cx = center.x, cy = center.y, cz = center.z;
  Vec3f best = center;
  float least = 0;
  for (int step = 0;; ++step) {
    const Wide x = all(cx), y = all(cy), z = all(cz);
    Wide distances[packs];
    Wide farthest{};
    for (int k = 0; k < packs; ++k) {
      distances[k] = squared_distance(core[k], x, y, z);
      farthest = max(distances[k], farthest);
    }
    const float squared = largest_lane(farthest);
    if (step == 0 || squared < least) least = squared, best = {cx, cy, cz};
    if (squared <= pull.enough || step == pull_steps) return best;
    // The first in the list among equals, on every processor.
    unsigned equal = 0;
    for (int k = 0; k < packs; ++k) equal |= lanes_equal(distances[k], all(squared)) << (k * lanes);
    const LocalPoint& far = points[pull.core[__builtin_ctz(equal)]];
    const float distance = __builtin_sqrtf(squared);
    const float along = 0.15f * distance / static_cast<float>(step + 1);
    const float excess = 0.8f * (__builtin_sqrtf(least) - pull.rest_radius);
    const float share = (along < excess ? along : excess) / distance;
    cx += share * (far.x - cx), cy += share * (far.y - cy), cz += share * (far.z - cz);
  }
}

// The farthest of the points that each lane has looked at: the first among equals. In registers of sixteen its
// coordinates, since a choice there is cheap; else its place in the core, and coordinates are fetched once for all
// steps through the core.
typedef std::int32_t WideInt __attribute__((vector_size(4 * lanes)));
struct FarthestOfLanes {
  Wide most;
#if MORULA_LANES == 16
  Wide x, y, z;
  void begin(float below = -1.0f) {
    most = all(below), x = y = z = Wide{};
  }
  void look_at(const WidePoints& p, Wide squared, WideInt) {
    x = squared > most ? p.x : x, y = squared > most ? p.y : y, z = squared > most ? p.z : z;
    most = max(squared, most);
  }
  WidePoints point(const LocalPoint*, const std::uint32_t*) const {
    return {x, y, z};
  }
#else
  WideInt place;
  void begin(float below = -1.0f) {
    most = all(below), place = WideInt{};
  }
  void look_at(const WidePoints&, Wide squared, WideInt here) {
    place = squared > most ? here : place;
    most = max(squared, most);
  }
  WidePoints point(const LocalPoint* points, const std::uint32_t* cores) const {
    std::uint32_t index[lanes];
    for (int k = 0; k < lanes; ++k)
      index[k] = cores[nodes_at_once * static_cast<std::size_t>(place[k]) + static_cast<std::size_t>(k)];
    return columns(gather(points, index));
  }
#endif
};

// Each lane pulls a node by the steps of pull: a lane that has enough stays where it is, so it finds the same distance
// again, which is no better. If a register has fewer lanes than nodes_at_once, two work in turn: each step ends in
// roots and quotients that wait for each other.
constexpr int pulled_at_once = lanes < static_cast<int>(nodes_at_once) ? 2 : 1;

void pull_lanes(const LocalPoint* points, const std::uint32_t* cores, std::size_t core_count, const float* rest_radii,
                LocalPoint* centers) {
  constexpr int n = pulled_at_once;
  WidePoints core[core_size][n];
  for (std::size_t k = 0; k < core_count; ++k)
    for (int r = 0; r < n; ++r) core[k][r] = columns(gather(points, cores + nodes_at_once * k + r * lanes));
  Wide rest[n], enough[n], x[n], y[n], z[n], best_x[n], best_y[n], best_z[n], least[n];
  for (int r = 0; r < n; ++r) {
    rest[r] = load(rest_radii + r * lanes);
    const Wide reach = all(most_growth) * rest[r];
    enough[r] = reach * reach;
    const auto row = [&](int k) { return points_in_rows(centers + r * lanes + k); };
    const WidePoints start = columns(Rows{row(0), row(1), row(2), row(3)});
    best_x[r] = x[r] = start.x, best_y[r] = y[r] = start.y, best_z[r] = z[r] = start.z;
    least[r] = Wide{};
  }
  for (int step = 0;; ++step) {
    FarthestOfLanes far[n];
    for (int r = 0; r < n; ++r) far[r].begin();
    WideInt place{};
    for (std::size_t k = 0; k < core_count; ++k, place += 1)
      for (int r = 0; r < n; ++r) far[r].look_at(core[k][r], squared_distance(core[k][r], x[r], y[r], z[r]), place);
    bool all_have_enough = true;
    for (int r = 0; r < n; ++r) {
      const Wide most = far[r].most;
      if (step == 0) {
        least[r] = most;
      } else {
        best_x[r] = most < least[r] ? x[r] : best_x[r], best_y[r] = most < least[r] ? y[r] : best_y[r];
        best_z[r] = most < least[r] ? z[r] : best_z[r];
        least[r] = min(most, least[r]);
      }
      all_have_enough = all_have_enough && lanes_at_most(most, enough[r]) == (1u << lanes) - 1;
    }
    if (step == pull_steps || all_have_enough) break;
    for (int r = 0; r < n; ++r) {
      const Wide most = far[r].most;
      // mutant pull-of-other-lanes-core: `cores + r * lanes` -> `cores`
      const WidePoints farthest = far[r].point(points, cores + r * lanes);
      const Wide distance = root(most);
      const Wide along = all(0.15f) * distance / all(static_cast<float>(step + 1));
      const Wide excess = all(0.8f) * (root(least[r]) - rest[r]);
      // mutant pull-of-lanes-that-have-enough: `most <= enough[r] ? Wide{} : min` -> `min`
      const Wide share = most <= enough[r] ? Wide{} : min(along, excess) / distance;
      x[r] += share * (farthest.x - x[r]), y[r] += share * (farthest.y - y[r]), z[r] += share * (farthest.z - z[r]);
    }
  }
  for (int r = 0; r < n; ++r) {
    float out[3][lanes];
    store(best_x[r], out[0]), store(best_y[r], out[1]), store(best_z[r], out[2]);
    for (int k = 0; k < lanes; ++k) centers[r * lanes + k] = LocalPoint{out[0][k], out[1][k], out[2][k], 0};
  }
}

void pull_many(const LocalPoint* points, const std::uint32_t* cores, std::size_t core_count, const float* rest_radii,
               LocalPoint* centers) {
  for (std::size_t k = 0; k < nodes_at_once; k += pulled_at_once * lanes)
    pull_lanes(points, cores + k, core_count, rest_radii + k, centers + k);
}

// A leaf in each lane; a good one goes nowhere. No share is above 1/2, so centers stay finite. The nearest point is the
// farthest by negative distances.
void fit_lanes(const LocalPoint* points, const Fits& fits, LocalPoint* centers) {
  WidePoints core[core_size], near[near_size];
  for (std::size_t k = 0; k < core_size; ++k) core[k] = columns(gather(points, fits.cores + nodes_at_once * k));
  for (std::size_t k = 0; k < near_size; ++k) near[k] = columns(gather(points, fits.near + nodes_at_once * k));
  const auto row = [&](int k) { return points_in_rows(centers + k); };
  const WidePoints start = columns(Rows{row(0), row(1), row(2), row(3)});
  Wide x = start.x, y = start.y, z = start.z, best_x = x, best_y = y, best_z = z, least{}, limit{};
  const Wide enough = load(fits.enough);
  Wide at_start{};
  for (int step = 0;; ++step) {
    FarthestOfLanes far, nearest;
    far.begin(), nearest.begin(-__builtin_inff());
    WideInt place{};
    for (std::size_t k = 0; k < core_size; ++k, place += 1)
      far.look_at(core[k], squared_distance(core[k], x, y, z), place);
    place = WideInt{};
    for (std::size_t k = 0; k < near_size; ++k, place += 1)
      nearest.look_at(near[k], -squared_distance(near[k], x, y, z), place);
    const Wide cost = far.most + nearest.most;
    if (step == 0) {
      least = at_start = cost, limit = all(most_squared_growth) * far.most;
      if (lanes_at_most(cost, enough) == (1u << lanes) - 1) break;
    } else {
      // mutant fit-grows: `limit` -> `4 * limit`
      const Wide here = far.most <= limit ? cost : all(__builtin_inff());
      best_x = here < least ? x : best_x, best_y = here < least ? y : best_y, best_z = here < least ? z : best_z;
      // mutant fit-costs-more: `here < least ? here : least` -> `here`
      least = here < least ? here : least;
    }
    if (step == fit_steps) break;
    const WidePoints to = far.point(points, fits.cores), from = nearest.point(points, fits.near);
    const Wide reach = root(far.most), protrusion = max(reach - root(-nearest.most), Wide{});
    // mutant fit-of-one-point: `Wide{} ?` -> `all(-1.0f) ?`
    const Wide some = reach > Wide{} ? all(fit_lengths[step]) * protrusion / reach : Wide{};
    const Wide share = at_start > enough ? some : Wide{};
    x += share * (to.x - from.x), y += share * (to.y - from.y), z += share * (to.z - from.z);
  }
  float out[3][lanes];
  store(best_x, out[0]), store(best_y, out[1]), store(best_z, out[2]);
  for (int k = 0; k < lanes; ++k) centers[k] = LocalPoint{out[0][k], out[1][k], out[2][k], 0};
}

void fit_many(const LocalPoint* points, const Fits& fits, LocalPoint* centers) {
  for (std::size_t k = 0; k < nodes_at_once; k += lanes)
    fit_lanes(points, {fits.cores + k, fits.near + k, fits.enough + k}, centers + k);
}

void weighted_sums(const LocalPoint* points, const std::uint32_t* index, const float* weight,
                   std::span<const std::uint32_t> group_begin, LocalPoint* sums) {
  constexpr std::size_t at_once = lanes / 4;
  const std::uint32_t* begin = group_begin.data();
  const std::size_t groups = group_begin.size() - 1;
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t node = 0; node < nodes_per_group; node += at_once) {
      Wide even{}, odd{};
      for (std::size_t i = begin[g] + node; i < begin[g + 1]; i += 2 * nodes_per_group) {
        even += spread(weight + i) * points_apart<1>(points, index + i);
        odd += spread(weight + i + nodes_per_group) * points_apart<1>(points, index + i + nodes_per_group);
      }
      store(even + odd, &sums[nodes_per_group * g + node].x);
    }
}

// TurnedAxes, a node in each lane.
struct WideVector {
  Wide x, y, z;
};
inline WideVector operator-(const WideVector& a, const WideVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline WideVector operator*(const WideVector& a, Wide s) {
  return {a.x * s, a.y * s, a.z * s};
}
inline Wide dot(const WideVector& a, const WideVector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline WideVector cross(const WideVector& a, const WideVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline WideVector unit(const WideVector& a, float x, float y) {
  const Wide length = root(dot(a, a));
  const auto choose = [&](Wide coordinate, float fallback) { return length > 0 ? coordinate / length : all(fallback); };
  return {choose(a.x, x), choose(a.y, y), choose(a.z, 0)};
}

void carry(const LocalPoint* points, const Remainders& remainders, std::size_t begin, std::size_t end,
           LocalPoint* moves) {
  const Wide zero{}, one = all(1.0f);
  for (std::size_t i = begin; i < end; i += lanes) {
    const auto point = [&](int k) {
      const WidePoints p = columns(gather(points, remainders.points[k] + i));
      return WideVector{p.x, p.y, p.z};
    };
    const WideVector p = point(0), side = point(2) - p, a = unit(point(1) - p, 1, 0);
    WideVector b = side - a * dot(a, side);
    const Wide limit = all(1e-12f) * dot(side, side), length = dot(b, b);
    const Wide x = max(a.x, -a.x), y = max(a.y, -a.y), z = max(a.z, -a.z);
    // The axis that a is farthest from: the first among equals.
    const Wide to_x = x <= y ? (x <= z ? one : zero) : zero, to_y = to_x > zero ? zero : y <= z ? one : zero;
    const WideVector across = cross(a, {to_x, to_y, one - to_x - to_y});
    b = {length > limit ? b.x : across.x, length > limit ? b.y : across.y, length > limit ? b.z : across.z};
    b = unit(b, 0, 1);
    b = unit(b - a * dot(a, b), 0, 1);
    const WideVector c = cross(a, b);
    const auto numbers = [&](const float* const(&arrays)[3]) {
      return WideVector{load(arrays[0] + i), load(arrays[1] + i), load(arrays[2] + i)};
    };
    const WideVector e = numbers(remainders.in_axes), rest = numbers(remainders.at_rest);
    float move[3][lanes];
    store(a.x * e.x + b.x * e.y + c.x * e.z - rest.x, move[0]);
    store(a.y * e.x + b.y * e.y + c.y * e.z - rest.y, move[1]);
    store(a.z * e.x + b.z * e.y + c.z * e.z - rest.z, move[2]);
    for (int k = 0; k < lanes; ++k)
      moves[i - begin + static_cast<std::size_t>(k)] = LocalPoint{move[0][k], move[1][k], move[2][k], 0};
  }
}

// Up to the end of each entry's points in turn: entry `first` and those below it, which look at more.
template <int count, int first>
[[gnu::always_inline]] inline void measure_by_entry(const LocalPoint* points, const std::uint32_t* index,
                                                    std::uint32_t i, const std::uint32_t* ends, const Centers<count>& c,
                                                    Wide (&farthest)[4]) {
  if constexpr (first < count) {
    // mutant leaves-without-their-lists: `i !=` -> `i + lanes <`
    for (; i != ends[first]; i += lanes) {
      const WidePoints p = columns(gather(points, index + i));
      for (int k = first; k < count; ++k) farthest[k] = max(squared_distance(p, c.x[k], c.y[k], c.z[k]), farthest[k]);
    }
    measure_by_entry<count, first + 1>(points, index, i, ends, c, farthest);
  }
}

template <int count>
[[gnu::always_inline]] inline void farthest_of_leaf(const LocalPoint* points, const LeafLists& lists, std::size_t leaf,
                                                    std::size_t entry, const Spheref* spheres, float* squared) {
  Centers<count> c;
  Wide farthest[4]{};
  for (int k = 0; k < count; ++k) {
    const Spheref& s = spheres[lists.nodes[lists.chain[entry + k]]];
    c.x[k] = all(s.center.x), c.y[k] = all(s.center.y), c.z[k] = all(s.center.z);
  }
  for (std::uint32_t r = lists.run_begin[leaf]; r != lists.run_begin[leaf + 1]; ++r)
    // mutant leaves-without-their-runs: `i !` -> `i + lanes !`
    for (std::uint32_t i = lists.runs[r].begin; i != lists.runs[r].end; i += lanes) {
      const WidePoints p = columns(load_run(points + i));
      for (int k = 0; k < count; ++k) farthest[k] = max(squared_distance(p, c.x[k], c.y[k], c.z[k]), farthest[k]);
    }
  measure_by_entry<count, 0>(points, lists.points, lists.point_begin[leaf], lists.point_end + entry, c, farthest);
  const Four most = largest_lanes(farthest[0], farthest[1], farthest[2], farthest[3]);
  for (int k = 0; k < count; ++k) squared[entry + k] = most[k];
}

void farthest_of_leaves(const LocalPoint* points, const LeafLists& lists, std::size_t begin, std::size_t end,
                        std::size_t count, const Spheref* spheres, float* squared) {
  for (std::size_t leaf = begin; leaf < end; ++leaf) {
    std::size_t entry = lists.chain_begin[leaf], last = lists.chain_begin[leaf + 1];
    while (last > entry && lists.chain[last - 1] >= count) --last;
    for (; entry + 4 <= last; entry += 4) farthest_of_leaf<4>(points, lists, leaf, entry, spheres, squared);
    switch (last - entry) {
      case 3:
        farthest_of_leaf<3>(points, lists, leaf, entry, spheres, squared);
        break;
      case 2:
        farthest_of_leaf<2>(points, lists, leaf, entry, spheres, squared);
        break;
      case 1:
        farthest_of_leaf<1>(points, lists, leaf, entry, spheres, squared);
        break;
      default:
        break;
    }
  }
}

// The compiler makes registers of it.
void covering_radii(const float* squared, const float* norms, std::size_t count, const RadiusAllowances& given,
                    float* __restrict radii) {
  const RadiusAllowances allowances = given;
  for (std::size_t i = 0; i < count; ++i) {
    const double farthest = __builtin_sqrt(static_cast<double>(squared[i]));
    const double mesh_coordinate = allowances.coordinate + static_cast<double>(norms[i]);
    // mutant radii-of-many-without-underflow: `mesh_coordinate + RadiusAllowances::of_underflow` -> `mesh_coordinate`
    const double pad = allowances.least + allowances.per_coordinate * mesh_coordinate + RadiusAllowances::of_underflow;
    // rounded_up, of positive numbers
    const double exact = farthest * RadiusAllowances::of_distance + pad;
    const float nearest = static_cast<float>(exact);
    // mutant radii-of-many-to-nearest: `static_cast<double>(nearest) < exact` -> `false`
    const std::uint32_t below = static_cast<double>(nearest) < exact ? 1u : 0u;
    radii[i] = __builtin_bit_cast(float, __builtin_bit_cast(std::uint32_t, nearest) + below);
  }
}

void move_edge_cuts(const LocalPoint* points, const EdgeCut* cuts, std::size_t count, LocalPoint* out) {
  static_assert(sizeof(EdgeCut) == 12);
  constexpr std::size_t at_once = lanes / 4;
  std::size_t i = 0;
  for (; i + at_once <= count; i += at_once) {
    const auto* ends = reinterpret_cast<const std::uint32_t*>(cuts + i);  // of the next record three further on
#if MORULA_LANES == 16
    const Four weight{cuts[i].weight, cuts[i + 1].weight, cuts[i + 2].weight, cuts[i + 3].weight};
    const Wide share = spread(weight);
#elif MORULA_LANES == 8
    const Wide share = spread(cuts[i].weight, cuts[i + 1].weight);
#else
    const Wide share = all(cuts[i].weight);
#endif
    const Wide v0 = points_apart<3>(points, ends), v1 = points_apart<3>(points, ends + 1);
    store(v0 + share * (v1 - v0), &out[i].x);
  }
  for (; i != count; ++i) {
    const Four v0 = load_point(points[cuts[i].point[0]]), v1 = load_point(points[cuts[i].point[1]]);
    *reinterpret_cast<Four*>(out + i) = v0 + cuts[i].weight * (v1 - v0);
  }
}

void move_inner_cuts(const LocalPoint* points, const InnerCut* cuts, std::size_t count, LocalPoint* out) {
  static_assert(sizeof(InnerCut) == 20);
  constexpr std::size_t at_once = lanes / 4;
  std::size_t i = 0;
  for (; i + at_once <= count; i += at_once) {
    const auto* corners = reinterpret_cast<const std::uint32_t*>(cuts + i);  // of the next record five further on
#if MORULA_LANES == 16
    const Four weight1{cuts[i].weight1, cuts[i + 1].weight1, cuts[i + 2].weight1, cuts[i + 3].weight1};
    const Four weight2{cuts[i].weight2, cuts[i + 1].weight2, cuts[i + 2].weight2, cuts[i + 3].weight2};
    const Wide share1 = spread(weight1), share2 = spread(weight2);
#elif MORULA_LANES == 8
    const Wide share1 = spread(cuts[i].weight1, cuts[i + 1].weight1);
    const Wide share2 = spread(cuts[i].weight2, cuts[i + 1].weight2);
#else
    const Wide share1 = all(cuts[i].weight1), share2 = all(cuts[i].weight2);
#endif
    const Wide v0 = points_apart<5>(points, corners), v1 = points_apart<5>(points, corners + 1);
    const Wide v2 = points_apart<5>(points, corners + 2);
    store(v0 + share1 * (v1 - v0) + share2 * (v2 - v0), &out[i].x);
  }
  for (; i != count; ++i) {
    const Four v0 = load_point(points[cuts[i].point[0]]), v1 = load_point(points[cuts[i].point[1]]);
    const Four v2 = load_point(points[cuts[i].point[2]]);
    *reinterpret_cast<Four*>(out + i) = v0 + cuts[i].weight1 * (v1 - v0) + cuts[i].weight2 * (v2 - v0);
  }
}

// The argument is a copy: Clang 14 casts the first lane in the place of every lane that is cast directly.
inline std::int32_t bits_of(float x) {
  return __builtin_bit_cast(std::int32_t, x);
}

// narrow_floats, where write(i, points) puts at_once of them, from the i-th on, and write_one(i, point) one.
template <class Write, class WriteOne>
std::uint32_t narrow_packed(const float* packed, std::size_t count, const Vec3f& origin, const Write& write,
                            const WriteOne& write_one) {
  constexpr std::size_t at_once = lanes / 4;
  const Four one{origin.x, origin.y, origin.z, 0};
#if MORULA_LANES == 16
  const Wide at = __builtin_shufflevector(one, one, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
#define MORULA_SPREAD(v) __builtin_shufflevector(v, Wide{}, 0, 1, 2, 16, 3, 4, 5, 16, 6, 7, 8, 16, 9, 10, 11, 16)
#elif MORULA_LANES == 8
  const Wide at = __builtin_shufflevector(one, one, 0, 1, 2, 3, 0, 1, 2, 3);
#define MORULA_SPREAD(v) __builtin_shufflevector(v, Wide{}, 0, 1, 2, 8, 3, 4, 5, 8)
#else
  const Wide at = one;
#define MORULA_SPREAD(v) __builtin_shufflevector(v, Wide{}, 0, 1, 2, 4)
#endif
  const WideInt without_sign = WideInt{} + 0x7fffffff;
  WideInt most{};
  // A load reads beyond its points: at_once floats, so not in front of the last of them.
  std::size_t i = 0;
  for (; i + 2 * at_once <= count; i += at_once) {
    const Wide loaded = *reinterpret_cast<const LooseWide*>(packed + 3 * i);
    const Wide p = MORULA_SPREAD(loaded) - at;
    write(i, p);
    const WideInt magnitude = __builtin_bit_cast(WideInt, p) & without_sign;
    most = magnitude > most ? magnitude : most;
  }
#undef MORULA_SPREAD
  std::int32_t largest = 0;
  for (int k = 0; k < lanes; ++k) largest = most[k] > largest ? most[k] : largest;
  // mutant kernel-tail-of-packed-floats: `i <` -> `i + 1 <`
  for (; i < count; ++i) {
    const Four p = Four{packed[3 * i], packed[3 * i + 1], packed[3 * i + 2], 0} - one;
    write_one(i, p);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t magnitude = bits_of(p[k]) & 0x7fffffff;
      largest = magnitude > largest ? magnitude : largest;
    }
  }
  return static_cast<std::uint32_t>(largest);
}

std::uint32_t narrow_floats(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out) {
  return narrow_packed(
      packed, count, origin, [&](std::size_t i, const Wide& p) { *reinterpret_cast<LooseWide*>(out + i) = p; },
      [&](std::size_t i, const Four& p) { *reinterpret_cast<Four*>(out + i) = p; });
}

std::uint32_t narrow_scattered(const float* packed, std::size_t count, const Vec3f& origin, const std::uint32_t* to,
                               LocalPoint* out) {
  const auto write_one = [&](std::size_t i, const Four& p) { *reinterpret_cast<Four*>(out + to[i]) = p; };
  return narrow_packed(
      packed, count, origin,
      [&](std::size_t i, const Wide& p) {
        write_one(i, __builtin_shufflevector(p, p, 0, 1, 2, 3));
#if MORULA_LANES >= 8
        write_one(i + 1, __builtin_shufflevector(p, p, 4, 5, 6, 7));
#endif
#if MORULA_LANES == 16
        write_one(i + 2, __builtin_shufflevector(p, p, 8, 9, 10, 11));
        write_one(i + 3, __builtin_shufflevector(p, p, 12, 13, 14, 15));
#endif
      },
      write_one);
}

constexpr Kernels kernels{
    farthest, farthest_of_groups, farthest_of_some, pull,           pull_many,       fit_many,      weighted_sums,
    carry,    farthest_of_leaves, covering_radii,   move_edge_cuts, move_inner_cuts, narrow_floats, narrow_scattered};
