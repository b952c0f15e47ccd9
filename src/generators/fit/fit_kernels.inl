// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of fit_kernels.cpp, on registers of wide.inl.

typedef std::int32_t WideInts __attribute__((vector_size(4 * lanes), may_alias));
typedef std::int32_t FourInts __attribute__((vector_size(16), may_alias));
typedef std::int32_t LooseInts __attribute__((vector_size(4 * lanes), aligned(4), may_alias));
typedef std::int32_t LooseFourInts __attribute__((vector_size(16), aligned(4), may_alias));
typedef float LooseFour __attribute__((vector_size(16), aligned(4), may_alias));
typedef std::uint8_t WideBytes __attribute__((vector_size(lanes), may_alias));
constexpr int quarters = lanes / 4;

// One for each four lanes.
inline WideInts spread_ints(const std::int32_t* numbers) {
#if MORULA_LANES == 4
  return WideInts{} + numbers[0];
#else
  return __builtin_bit_cast(WideInts, spread(reinterpret_cast<const float*>(numbers)));
#endif
}
inline Wide counting() {
  Wide result;
  for (int k = 0; k < lanes; ++k) result[k] = static_cast<float>(k);
  return result;
}
inline Wide counting_to_three() {
  Wide result;
  for (int k = 0; k < lanes; ++k) result[k] = static_cast<float>(k % 4);
  return result;
}
inline Wide truncated(Wide a, WideInts& whole) {
  whole = __builtin_convertvector(a, WideInts);
  return __builtin_convertvector(whole, Wide);
}
inline Four quarter(Wide a, int k) {
#if MORULA_LANES == 16
  switch (k) {
    case 0:
      return __builtin_shufflevector(a, a, 0, 1, 2, 3);
    case 1:
      return __builtin_shufflevector(a, a, 4, 5, 6, 7);
    case 2:
      return __builtin_shufflevector(a, a, 8, 9, 10, 11);
    default:
      return __builtin_shufflevector(a, a, 12, 13, 14, 15);
  }
#elif MORULA_LANES == 8
  return k == 0 ? __builtin_shufflevector(a, a, 0, 1, 2, 3) : __builtin_shufflevector(a, a, 4, 5, 6, 7);
#else
  static_cast<void>(k);
  return a;
#endif
}

// Four registers of quarters, each with the four floats at one place: columns() and last_column() split them, four
// places by four.
template <class At>
inline Wide quarters_at(const At& at, int first) {
#if MORULA_LANES == 4
  return *reinterpret_cast<const LooseFour*>(at(first));
#else
  const __m256 ab =
      _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(at(first))), _mm_loadu_ps(at(first + 4)), 1);
#if MORULA_LANES == 8
  return ab;
#else
  const __m512 abc = _mm512_insertf32x4(_mm512_castps256_ps512(ab), _mm_loadu_ps(at(first + 8)), 2);
  return _mm512_insertf32x4(abc, _mm_loadu_ps(at(first + 12)), 3);
#endif
#endif
}
template <class At>
inline Rows rows_at(const At& at) {
  return {quarters_at(at, 0), quarters_at(at, 1), quarters_at(at, 2), quarters_at(at, 3)};
}

struct IntRange {
  int begin, end;
};
inline int cut_off(float position, float last) {
  return position > 0 ? static_cast<int>(position < last ? position : last) : 0;
}

// Lines of a row come by fours, and fours of several rows share a register. A ball's rows are written down first, so
// that no branch waits for the width of a row.
struct Fours {
  static constexpr int most = 128, slack = 8;
  alignas(64) float in_row[most + slack];  // the square of the ball's half width there
  alignas(64) float first[most + slack];   // from its middle to the first of the four
  alignas(64) std::int32_t line[most + slack];
};

__attribute__((always_inline)) inline Wide empty_up_to(const GridStep* steps, Wide w, Wide last_cell, WideInts lines) {
  const Wide none{};
  WideInts cell;
  const Wide floor = truncated(min(max(w, none), last_cell), cell);
  // Places of the steps' floats. They are read back from memory: extracting them from the register one by one costs
  // more than all the rest.
  alignas(64) std::uint32_t place[lanes];
  *reinterpret_cast<WideInts*>(place) = 4 * (lines + cell);
  asm("" : "+m"(place));
  const Rows rows = rows_at([&](int k) { return &steps->before + place[k]; });
  const WidePoints p = columns(rows);  // before, start, slope
  return min(p.x + p.z * max(w - floor - p.y, none), last_column(rows));
}

__attribute__((noinline)) Four add_fours(const GridLines& lines, const LineBall& ball, Fours& fours, int count,
                                         Four total) {
  const Wide none{}, middle = all(ball.along), last_cell = all(static_cast<float>(lines.along - 1));
  const Wide across = counting_to_three();
  const WideInts in_four = __builtin_convertvector(across, WideInts) * lines.along;
  // Fours past the end have no chord: both ends are the same place, and nothing is between them.
  for (int k = 0; k < quarters; ++k) fours.in_row[count + k] = 0, fours.first[count + k] = 0, fours.line[count + k] = 0;
  for (int i = 0; i < count; i += quarters) {
    const Wide du = spread(fours.first + i) + across;
    const Wide chord = root(max(spread(fours.in_row + i) - du * du, none));
    const WideInts line = spread_ints(fours.line + i) + in_four;
    const Wide between = empty_up_to(lines.steps, middle + chord, last_cell, line) -
                         empty_up_to(lines.steps, middle - chord, last_cell, line);
    for (int k = 0; k < quarters; ++k) total = total + quarter(between, k);
  }
  return total;
}

// The sums are those of the plain loop, which adds each line to one of four by its place in the row. That du is taken
// from the first of a row on changes no bit: the ball is inside the grid, so its middle is at least a radius from the
// grid's border, and all distances between it and middles of cells within the radius are multiples of the last place of
// that coordinate and less than it: exact, however they are added up.
float outside(const GridLines& lines, const LineBall& ball) {
  Fours fours;
  int count = 0;
  Four total{};
  const float squared_radius = ball.radius * ball.radius, last_row = static_cast<float>(lines.rows);
  const IntRange rows{cut_off(ball.row - ball.radius + 0.5F, last_row),
                      cut_off(ball.row + ball.radius + 0.5F, last_row)};
  const Wide none{}, across = all(ball.across), last = all(static_cast<float>(lines.across));
  const FourInts steps_to{0, 4 * lines.along, 8 * lines.along, 12 * lines.along};
  const Four places{0, 4, 8, 12};
  for (int v = rows.begin; v < rows.end; v += lanes) {
    const Wide dv = (static_cast<float>(v) + counting()) + 0.5F - ball.row;
    const Wide in_row = squared_radius - dv * dv, half = root(max(in_row, none));
    // Rows that the ball does not meet begin where they end.
    alignas(64) std::int32_t begin[lanes], end[lanes];
    alignas(64) float square[lanes];
    WideInts whole;
    truncated(max(min(across - half + 0.5F, last), none), whole);
    *reinterpret_cast<WideInts*>(begin) = whole;
    truncated(max(min(across + half + 0.5F, last), none), whole);
    *reinterpret_cast<WideInts*>(end) = whole;
    store(in_row, square);
    const int here = rows.end - v < lanes ? rows.end - v : lanes;
    for (int k = 0; k < here; ++k) {
      Four first = places + (static_cast<float>(begin[k]) + 0.5F - ball.across);
      FourInts line = steps_to + ((v + k) * lines.across + begin[k]) * lines.along;
      // Four fours at a time, though most rows have fewer.
      for (int left = (end[k] - begin[k] + 3) >> 2; left > 0; left -= 4) {
        *reinterpret_cast<LooseFour*>(fours.first + count) = first;
        *reinterpret_cast<LooseFour*>(fours.in_row + count) = square[k] - Four{};
        *reinterpret_cast<LooseFourInts*>(fours.line + count) = line;
        count += left < 4 ? left : 4;
        if (count > Fours::most) total = add_fours(lines, ball, fours, count, total), count = 0;
        first = first + 16.0F, line = line + 16 * lines.along;
      }
    }
  }
  total = add_fours(lines, ball, fours, count, total);
  return (total[0] + total[1]) + (total[2] + total[3]);
}

// A step is a register. With a line to each lane, taking cells apart and putting steps together costs more than the
// sums do; those wait for each other along a line only, so the next line is on its way before one is done.
void make_steps(const OpenLines& lines, std::size_t begin, std::size_t end, float overlap_weight, bool go_on) {
  const Four shares[2]{{1, 1, 1, 1}, {1, overlap_weight, overlap_weight, 1}};  // of start, slope and total
  const std::size_t over_along = lines.over_along;
  for (std::size_t k = 0; k < lines.count; ++k) {
    const float* cells = reinterpret_cast<const float*>(lines.cells + k * lines.along + begin);
    const std::uint8_t* over = lines.over + k * lines.over_across + begin * over_along;
    GridStep* const steps = lines.steps + k * lines.along;
    Four sum = (go_on ? steps[begin - 1].after : 0) - Four{};
    for (std::size_t w = begin; w < end; ++w, cells += 3, over += over_along) {
      const Four cell = *reinterpret_cast<const LooseFour*>(cells) * shares[*over != 0];
      const Four after = sum + __builtin_shufflevector(cell, cell, 2, 2, 2, 2);
      const Four first_three = __builtin_shufflevector(sum, cell, 0, 4, 5, 5);
      *reinterpret_cast<Four*>(steps + w) = __builtin_shufflevector(first_three, after, 0, 1, 2, 7);
      sum = after;
    }
  }
}

// The last lanes of the points are those that end with them: who is offered a ball twice takes it once.
void offer(const PointColumns& points, const Vec3f& center, float square, std::uint32_t number,
           const PowerOwners& owners) {
  const std::size_t count = points.count;
  if (count < lanes) {
    plain::offer(points, center, square, number, owners);
    return;
  }
  const Wide x = all(center.x), y = all(center.y), z = all(center.z);
  const WideInts own = WideInts{} + static_cast<std::int32_t>(number);
  for (std::size_t i = 0; i < count; i += lanes) {
    const std::size_t first = i + lanes <= count ? i : count - lanes;
    const Wide dx = load(points.x + first) - x, dy = load(points.y + first) - y, dz = load(points.z + first) - z;
    const Wide power = dx * dx + dy * dy + dz * dz - square, least = load(owners.power + first);
    LooseInts& owner = *reinterpret_cast<LooseInts*>(owners.owner + first);
    const WideInts before = owner;
    const WideInts takes = (power < least) | ((power == least) & (own < before));
    store(takes ? power : least, owners.power + first);
    owner = takes ? own : before;
  }
}

void at_most(const float* numbers, std::size_t count, float limit, std::uint64_t* bits) {
  const Wide most = all(limit);
  std::size_t i = 0;
  std::uint64_t word = 0;
  for (; i + lanes <= count; i += lanes) {
    word |= static_cast<std::uint64_t>(lanes_at_most(load(numbers + i), most)) << (i % 64);
    if ((i + lanes) % 64 == 0) bits[i / 64] = word, word = 0;
  }
  for (std::size_t k = i; k < count; ++k) word |= static_cast<std::uint64_t>(numbers[k] <= limit) << (k % 64);
  if (count % 64 != 0) bits[count / 64] = word;
}

void at_most_in_double(const double* numbers, std::size_t count, double limit, std::uint64_t* bits) {
  const Doubles most = limit - Doubles{};
  constexpr std::uint64_t every = (1u << doubles) - 1;
  std::size_t i = 0;
  std::uint64_t word = 0;
  for (; i + doubles <= count; i += doubles) {
    const Doubles some = *reinterpret_cast<const LooseDoubles*>(numbers + i);
    word |= (every & ~std::uint64_t{greater(some, most)}) << (i % 64);
    if ((i + doubles) % 64 == 0) bits[i / 64] = word, word = 0;
  }
  for (std::size_t k = i; k < count; ++k) word |= static_cast<std::uint64_t>(numbers[k] <= limit) << (k % 64);
  if (count % 64 != 0) bits[count / 64] = word;
}

void squared_distances_in_double(const DoublePointColumns& points, const Vec3& center, double* squares) {
  const Doubles x = center.x - Doubles{}, y = center.y - Doubles{}, z = center.z - Doubles{};
  std::size_t i = 0;
  for (; i + doubles <= points.count; i += doubles) {
    const Doubles dx = *reinterpret_cast<const LooseDoubles*>(points.x + i) - x;
    const Doubles dy = *reinterpret_cast<const LooseDoubles*>(points.y + i) - y;
    const Doubles dz = *reinterpret_cast<const LooseDoubles*>(points.z + i) - z;
    *reinterpret_cast<LooseDoubles*>(squares + i) = dx * dx + dy * dy + dz * dz;
  }
  for (; i < points.count; ++i) squares[i] = squared_distance(Vec3{points.x[i], points.y[i], points.z[i]}, center);
}

// The last lanes of the points are those that end with them.
double farthest_exit(const DoublePointColumns& points, const DoublePointColumns& directions, const Sphere& ball) {
  const std::size_t count = points.count;
  if (count < doubles) return plain::farthest_exit(points, directions, ball);
  const Doubles none{}, square = ball.radius * ball.radius - Doubles{};
  const Doubles x = ball.center.x - Doubles{}, y = ball.center.y - Doubles{}, z = ball.center.z - Doubles{};
  Doubles most{};
  for (std::size_t i = 0; i < count; i += doubles) {
    const std::size_t first = i + doubles <= count ? i : count - doubles;
    const auto of = [&](const double* column) -> Doubles {
      return *reinterpret_cast<const LooseDoubles*>(column + first);
    };
    const Doubles dx = of(points.x) - x, dy = of(points.y) - y, dz = of(points.z) - z;
    const Doubles along = dx * of(directions.x) + dy * of(directions.y) + dz * of(directions.z);
    const Doubles inside = square - (dx * dx + dy * dy + dz * dz - along * along);
    const Doubles exit = root(inside > none ? inside : none) - along;
    most = ((inside >= none) & (exit > most)) ? exit : most;
  }
  double farthest = 0;
  for (int k = 0; k < doubles; ++k) farthest = most[k] > farthest ? most[k] : farthest;
  return farthest;
}

// The last lanes of the points are those that end with them.
void cell_numbers(const DoublePointColumns& points, const LatticeCells& cells, std::int32_t* numbers) {
  typedef std::int32_t HalfInts __attribute__((vector_size(4 * doubles)));
  typedef std::int32_t LooseHalfInts __attribute__((vector_size(4 * doubles), aligned(4), may_alias));
  const std::size_t count = points.count;
  if (count < doubles) return plain::cell_numbers(points, cells, numbers);
  for (std::size_t i = 0; i < count; i += doubles) {
    const std::size_t first = i + doubles <= count ? i : count - doubles;
    const auto along = [&](const double* coordinates, double origin, double per_edge) -> HalfInts {
      const Doubles from_origin = *reinterpret_cast<const LooseDoubles*>(coordinates + first) - origin;
      return __builtin_convertvector(from_origin * per_edge, HalfInts);
    };
    const HalfInts x = along(points.x, cells.origin.x, cells.per_edge.x);
    const HalfInts y = along(points.y, cells.origin.y, cells.per_edge.y);
    const HalfInts z = along(points.z, cells.origin.z, cells.per_edge.z);
    *reinterpret_cast<LooseHalfInts*>(numbers + first) = (x * cells.count[1] + y) * cells.count[2] + z;
  }
}

// Bit i: byte i of 64 is `wanted`.
inline std::uint64_t equal_of_64(const std::uint8_t* bytes, std::uint8_t wanted) {
#if MORULA_LANES == 16
  return _mm512_cmpeq_epi8_mask(_mm512_loadu_si512(bytes), _mm512_set1_epi8(static_cast<char>(wanted)));
#elif defined(__x86_64__) && MORULA_LANES == 8
  std::uint64_t bits = 0;
  const __m256i all_wanted = _mm256_set1_epi8(static_cast<char>(wanted));
  for (int k = 0; k < 64; k += 32) {
    const __m256i some = _mm256_loadu_si256(reinterpret_cast<const __m256i_u*>(bytes + k));
    bits |= std::uint64_t{static_cast<std::uint32_t>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(some, all_wanted)))} << k;
  }
  return bits;
#elif defined(__x86_64__)
  std::uint64_t bits = 0;
  const __m128i all_wanted = _mm_set1_epi8(static_cast<char>(wanted));
  for (int k = 0; k < 64; k += 16) {
    const __m128i some = _mm_loadu_si128(reinterpret_cast<const __m128i_u*>(bytes + k));
    bits |= std::uint64_t{static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(some, all_wanted)))} << k;
  }
  return bits;
#else
  std::uint64_t bits;
  plain::equal(bytes, 64, wanted, &bits);
  return bits;
#endif
}

void equal(const std::uint8_t* bytes, std::size_t count, std::uint8_t wanted, std::uint64_t* bits) {
  std::size_t i = 0;
  for (; i + 64 <= count; i += 64) bits[i / 64] = equal_of_64(bytes + i, wanted);
  if (i < count) plain::equal(bytes + i, count - i, wanted, bits + i / 64);
}

void with_less_power(const BallColumns& balls, const double (*corners)[4], std::size_t count, std::uint64_t* bits) {
  for (std::size_t word = 0; 64 * word < balls.count; ++word) bits[word] = 0;
  for (std::size_t i = 0; i < balls.count; i += doubles) {
    const auto of = [&](const double* column) -> Doubles { return *reinterpret_cast<const LooseDoubles*>(column + i); };
    const Doubles x = of(balls.x), y = of(balls.y), z = of(balls.z), square = of(balls.square);
    unsigned less = 0;
    for (std::size_t c = 0; c < count; ++c) {
      const Doubles dx = x - corners[c][0], dy = y - corners[c][1], dz = z - corners[c][2];
      less |= greater(corners[c][3] - Doubles{}, dx * dx + dy * dy + dz * dz - square);
    }
    bits[i / 64] |= static_cast<std::uint64_t>(less) << (i % 64);
  }
}

constexpr FitKernels kernels{
    outside,       make_steps,   offer, at_most,        at_most_in_double, squared_distances_in_double,
    farthest_exit, cell_numbers, equal, with_less_power};
