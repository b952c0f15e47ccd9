// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/surface/layer_patches.hpp>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "surface/layers/known_layers.hpp"
#include "surface/layers/layer_integrals.hpp"
#include "surface/layers/layer_pairs.hpp"
#include "surface/layers/layer_points.hpp"
#include "surface/pairs/feature_query.hpp"

namespace morula {
using namespace detail;
namespace {

/// Keeps the pairs of facets that are not proven to be farther apart than the thickness along a normal of one.
struct FacetsNear {
  double thickness;

  static bool are_apart(const Triangle& a, const Triangle& b, double thickness) {
    const Vec3 normal = normalized(area_vector(a), Vec3{});
    std::array<double, 3> of_a, of_b;
    for (std::size_t k = 0; k < 3; ++k) of_a[k] = dot(a[k] - a[0], normal), of_b[k] = dot(b[k] - a[0], normal);
    const auto [a_least, a_most] = std::minmax({of_a[0], of_a[1], of_a[2]});
    const auto [b_least, b_most] = std::minmax({of_b[0], of_b[1], of_b[2]});
    return b_least - a_most > thickness || a_least - b_most > thickness;
  }
  void operator()(const SurfaceTreeState& a, const SurfaceTreeState& b, std::span<const FeaturePair> pairs,
                  std::vector<FeaturePair>& found) const {
    const auto triangle = [](const SurfaceTreeState& s, std::uint32_t facet) -> Triangle {
      const Facet& f = s.mesh.facets[facet];
      return {s.from_of(f[0]), s.from_of(f[1]), s.from_of(f[2])};
    };
    InterruptPoller poll_interrupt(128);
    for (const FeaturePair& pair : pairs) {
      poll_interrupt();
      const Triangle ta = triangle(a, pair.a), tb = triangle(b, pair.b);
      if (!are_apart(ta, tb, thickness) && !are_apart(tb, ta, thickness)) found.push_back(pair);
    }
  }
};

/// All that patches() refers to.
struct LayerResult {
  struct Side {
    std::vector<std::uint32_t> facets;
    std::vector<VertexGradient> gradients;
    std::vector<std::size_t> facets_begin, gradients_begin;
  };
  std::vector<LayerPatch> patches;
  std::array<Side, 2> sides;
  std::vector<LayerPoint> points;
  std::vector<std::size_t> points_begin;
  double volume = 0;

  void clear() noexcept {
    patches.clear();
    points.clear();
    points_begin.clear();
    for (Side& side : sides) {
      side.facets.clear(), side.gradients.clear();
      side.facets_begin.clear(), side.gradients_begin.clear();
    }
    volume = 0;
  }
  template <class T>
  static std::span<const T> range(const std::vector<T>& values, const std::vector<std::size_t>& begin, std::size_t i) {
    const std::size_t end = i + 1 < begin.size() ? begin[i + 1] : values.size();
    return std::span(values).subspan(begin[i], end - begin[i]);
  }
  std::span<const std::uint32_t> facets(std::size_t k, std::size_t patch) const {
    return range(sides[k].facets, sides[k].facets_begin, patch);
  }
  std::span<const VertexGradient> gradients(std::size_t k, std::size_t patch) const {
    return range(sides[k].gradients, sides[k].gradients_begin, patch);
  }
};

/// The axis of the world that is most nearly across the normal.
int axis_across(const Vec3& normal) {
  const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
  return x <= y && x <= z ? 0 : y <= z ? 1 : 2;
}

}  // namespace

struct LayerPatchQuery::State {
  CallState call;
  LayerPatchOptions options;
  FeatureQuery<FeaturePair> query;

  std::array<LayerMesh, 2> meshes;
  std::array<LayerPartners, 2> partners;
  EdgeLayers edges;
  std::vector<LayerCandidate> candidates;
  std::vector<std::uint8_t> is_near;  // by pair
  std::vector<LayerPiece> pieces;
  LayerGroups groups;
  std::vector<std::uint32_t> pieces_begin, pieces_by_patch, pairs_begin, pairs_by_patch;
  LayerIntegrals integrals;
  std::vector<LayerSample> samples;
  std::vector<std::size_t> samples_begin;
  std::vector<double> pressed_areas;
  LayerPoints points;
  std::vector<KnownLayers::Match> matches;
  KnownLayers known;
  std::array<const SurfaceTreeState*, 2> known_of{};  // surfaces of the known patches, kept by meshes
  LayerResult result, next;
  std::uint32_t first_id = 0, next_id = 0;  // of the first new patch of this run, and of the next one
  Vec3 origin;

  void forget() noexcept {
    query.forget();
    result.clear();
    known = {};
  }
  template <class Step>
  SurfaceQueryStatus run_call(CallKind kind, const Step& step) {
    return call_of(*this, kind, [&] {
      const SurfaceQueryStatus status = step(FacetsNear{options.thickness});
      if (!status) return status;
      // Whatever interrupted a run, its patches are recognized by those of the run before.
      if (kind == CallKind::begins) known.finish(), first_id = next_id;
      next_id = first_id;
      find();
      return status;
    });
  }
  SurfaceQueryStatus run(const SurfaceTreeState& a, const SurfaceTreeState& b, Workers& workers) {
    return run_call(CallKind::begins, [&](const FacetsNear& narrow) {
      return query.run(a, b, {.reach = options.thickness, .features = Features::facets}, options, workers, narrow);
    });
  }

  bool is_with_itself() const { return query.search().is_with_itself(); }
  const LayerMesh& mesh(std::size_t side) const { return meshes[is_with_itself() ? 0 : side]; }
  const LayerPartners& partners_of(std::size_t side) const { return partners[is_with_itself() ? 0 : side]; }
  void find();
  void read();
  void find_pieces(std::size_t side);
  void find_pieces_of_edge(std::size_t side, std::uint32_t edge, std::uint32_t of_facet);
  void sort_by_patch();
  void measure(std::uint32_t patch);
  void put_facets(std::uint32_t patch);
  void recognize();
  void complete(std::uint32_t patch);
};

void LayerPatchQuery::State::find() {
  const StandardFloats standard;
  read();
  is_near.assign(query.found().size(), 0);
  pieces.clear();
  for (std::size_t side = 0; side < (is_with_itself() ? 1u : 2u); ++side) find_pieces(side);
  groups.find(is_near, partners_of(0), mesh(0), partners_of(1), mesh(1));
  sort_by_patch();
  next.clear();
  samples.clear(), samples_begin.clear(), pressed_areas.clear();
  for (std::uint32_t patch = 0; patch < groups.patch_count(); ++patch) measure(patch);
  samples_begin.push_back(samples.size());
  recognize();
  known.start();
  for (std::uint32_t patch = 0; patch < groups.patch_count(); ++patch) complete(patch);
  for (std::size_t i = 0; i < next.patches.size(); ++i)
    next.patches[i].points = LayerResult::range(next.points, next.points_begin, i);
  std::swap(result, next);
}

// Prepares the meshes, reads the positions of facets with partners, and lists the partners.
void LayerPatchQuery::State::read() {
  const SurfaceTreeState &a = query.search().a(), &b = query.search().b();
  if (known_of != std::array{&a, &b}) known.clear();
  known_of = {};
  meshes[0].start(a);
  if (!is_with_itself()) meshes[1].start(b);
  known_of = {&a, &b};
  const std::span<const FeaturePair> pairs = query.found();
  origin = pairs.empty() ? Vec3{} : a.from_of(a.mesh.facets[pairs[0].a][0]);
  partners[0].start(pairs, is_with_itself() ? 2 : 0, meshes[0].facet_count());
  if (!is_with_itself()) partners[1].start(pairs, 1, meshes[1].facet_count());
  for (std::size_t side = 0; side < (is_with_itself() ? 1u : 2u); ++side)
    for (const LayerPartners::Run& run : partners[side].runs()) meshes[side].read(run.facet, origin);
}

void LayerPatchQuery::State::find_pieces(std::size_t side) {
  InterruptPoller poll_interrupt(16);
  for (const LayerPartners::Run& run : partners_of(side).runs()) {
    if (!mesh(side).is_usable(run.facet)) continue;
    poll_interrupt();
    for (const std::uint32_t edge : mesh(side).edges(run.facet)) find_pieces_of_edge(side, edge, run.facet);
  }
}

void LayerPatchQuery::State::find_pieces_of_edge(std::size_t side, std::uint32_t edge, std::uint32_t of_facet) {
  const LayerPartners& of = partners_of(side);
  candidates.clear();
  std::size_t runs = 0;
  for (const std::uint32_t facet : mesh(side).facets_of_edge(edge)) {
    const LayerPartners::Run* run = of.find(facet);
    if (!run) continue;
    // The first of the edge's facets stands for all of them.
    if (runs++ == 0 && facet != of_facet) return;
    for (const LayerPartners::Partner& p : of.partners(*run)) candidates.push_back({p.partner, p.number, p.end});
  }
  const auto by_facet = [](const LayerCandidate& c, const LayerCandidate& d) {
    return std::tie(c.facet, c.number) < std::tie(d.facet, d.number);
  };
  if (runs > 1) {
    std::sort(candidates.begin(), candidates.end(), by_facet);
    const auto same = [](const LayerCandidate& c, const LayerCandidate& d) { return c.facet == d.facet; };
    candidates.erase(std::unique(candidates.begin(), candidates.end(), same), candidates.end());
  }
  const auto [lower, upper] = mesh(side).ends(edge);
  const Vec3 p = mesh(side).at(lower), u = mesh(side).at(upper) - p;
  edges.find(edge, p, u, mesh(1 - side), options.thickness, candidates, pieces);
  const auto is_acting = [&](std::uint32_t facet) {
    const auto at = std::lower_bound(candidates.begin(), candidates.end(), facet,
                                     [](const LayerCandidate& c, std::uint32_t f) { return c.facet < f; });
    return at != candidates.end() && at->facet == facet && at->is_near;
  };
  for (const std::uint32_t facet : mesh(side).facets_of_edge(edge))
    if (const LayerPartners::Run* run = of.find(facet))
      for (const LayerPartners::Partner& p_near : of.partners(*run))
        if (is_acting(p_near.partner)) is_near[p_near.number] = 1;
}

void LayerPatchQuery::State::sort_by_patch() {
  const std::size_t count = groups.patch_count();
  const auto sort = [&](std::size_t size, const auto& patch_of, std::vector<std::uint32_t>& begin,
                        std::vector<std::uint32_t>& sorted) {
    begin.assign(count + 2, 0);
    const auto of = [&](std::size_t i) { return std::min<std::size_t>(patch_of(i), count); };
    for (std::size_t i = 0; i < size; ++i) ++begin[of(i) + 1];
    for (std::size_t p = 0; p <= count; ++p) begin[p + 1] += begin[p];
    sorted.resize(size);
    for (std::uint32_t i = 0; i < size; ++i) sorted[begin[of(i)]++] = i;
    for (std::size_t p = count + 1; p > 0; --p) begin[p] = begin[p - 1];
    begin[0] = 0;
  };
  sort(
      pieces.size(), [&](std::size_t i) { return groups[pieces[i].candidate].patch; }, pieces_begin, pieces_by_patch);
  sort(
      is_near.size(), [&](std::size_t i) { return groups[i].patch; }, pairs_begin, pairs_by_patch);
}

void LayerPatchQuery::State::put_facets(std::uint32_t patch) {
  for (std::size_t k = 0; k < 2; ++k) {
    LayerResult::Side& side = next.sides[k];
    side.facets_begin.push_back(side.facets.size());
    for (std::uint32_t i = pairs_begin[patch]; i < pairs_begin[patch + 1]; ++i) {
      const std::uint32_t pair = pairs_by_patch[i];
      const bool is_a = (k == 0) != groups[pair].swapped;
      side.facets.push_back(is_a ? query.found()[pair].a : query.found()[pair].b);
    }
    const auto begin = side.facets.begin() + static_cast<std::ptrdiff_t>(side.facets_begin.back());
    std::sort(begin, side.facets.end());
    side.facets.erase(std::unique(begin, side.facets.end()), side.facets.end());
  }
}

void LayerPatchQuery::State::measure(std::uint32_t patch) {
  check_interrupt();
  samples_begin.push_back(samples.size());
  integrals.start(mesh(0), mesh(1), options.thickness, 0x1p-46 * query.largest_coordinate());
  for (std::uint32_t i = pieces_begin[patch]; i < pieces_begin[patch + 1]; ++i) {
    const LayerPiece& piece = pieces[pieces_by_patch[i]];
    const auto side = static_cast<std::uint8_t>(piece.end ^ (groups[piece.candidate].swapped ? 1 : 0));
    integrals.add(piece, side, options.max_points > 0 ? &samples : nullptr);
  }
  const LayerSums& sums = integrals.sums();
  LayerPatch made;
  made.volume = sums.volume;
  const Vec3 center = sums.volume != 0 ? sums.first_moment / sums.volume : Vec3{};
  made.centroid = origin + center;
  made.depth = sums.depth;
  made.mean_depth = sums.pressed_area > 0 ? 2 * sums.volume / sums.pressed_area : 0;
  made.a.area = sums.area[0], made.b.area = sums.area[1];
  put_facets(patch);
  for (std::uint8_t k = 0; k < 2; ++k) {
    LayerSide& side = k == 0 ? made.a : made.b;
    next.sides[k].gradients_begin.push_back(next.sides[k].gradients.size());
    integrals.put(k, center, next.sides[k].gradients, side.area_vector, side.moment);
  }
  pressed_areas.push_back(sums.pressed_area);
  next.volume += made.volume;
  next.patches.push_back(made);
}

void LayerPatchQuery::State::recognize() {
  matches.assign(next.patches.size(), {});
  for (std::uint32_t i = 0; i < matches.size(); ++i)
    known.count(i, next.gradients(0, i), next.gradients(1, i), is_with_itself());
  known.match(matches);
}

void LayerPatchQuery::State::complete(std::uint32_t patch) {
  LayerPatch& made = next.patches[patch];
  const KnownLayers::Match& match = matches[patch];
  std::array<std::size_t, 2> end{0, 1};
  if (match.swapped) std::swap(made.a, made.b), std::swap(end[0], end[1]);
  made.a.facets = next.facets(end[0], patch), made.b.facets = next.facets(end[1], patch);
  made.a.gradients = next.gradients(end[0], patch), made.b.gradients = next.gradients(end[1], patch);
  const double across = length(made.a.area_vector);
  // Sums that cancel each other leave no direction.
  // mutant layers-closed-normal: `0x1p-40` -> `0`
  if (across > 0x1p-40 * pressed_areas[patch]) made.normal = -made.a.area_vector / across;

  KnownLayers::Patch now{0, axis_across(made.normal)};
  if (match.known != KnownLayers::none) {
    now.id = known[match.known].id;
    // The axis stays until it is too near the normal.
    if (std::abs(made.normal[known[match.known].axis]) < 0.9) now.axis = known[match.known].axis;
  }
  made.id = match.known != KnownLayers::none ? now.id : (now.id = next_id++);
  known.add(now, made.a.gradients, made.b.gradients);
  next.points_begin.push_back(next.points.size());
  if (options.max_points == 0 || made.normal == Vec3{}) return;
  const std::span<LayerSample> of =
      std::span(samples).subspan(samples_begin[patch], samples_begin[patch + 1] - samples_begin[patch]);
  if (match.swapped)
    for (LayerSample& sample : of) sample.pressure = -sample.pressure;
  Vec3 first;
  first[now.axis] = 1;
  first = normalized(first - made.normal * dot(first, made.normal));
  points.add(of, pressed_areas[patch], made.normal, first, options.max_points, {&mesh(end[0]), made.a.facets},
             {&mesh(end[1]), made.b.facets}, origin, next.points);
}

LayerPatchQuery::LayerPatchQuery(LayerPatchOptions options) : state_(std::make_unique<State>()) {
  set_options(std::move(options));
}
LayerPatchQuery::~LayerPatchQuery() = default;
LayerPatchQuery::LayerPatchQuery(LayerPatchQuery&&) noexcept = default;
LayerPatchQuery& LayerPatchQuery::operator=(LayerPatchQuery&&) noexcept = default;

void LayerPatchQuery::set_options(LayerPatchOptions options) {
  require_idle(state_->call);
  require_length(options.thickness, "LayerPatchOptions::thickness");
  if (options.thickness == 0) throw std::invalid_argument("LayerPatchOptions::thickness must be more than 0");
  if (options.max_points > 16)
    throw std::invalid_argument("LayerPatchOptions::max_points " + std::to_string(options.max_points) +
                                " is more than 16");
  FeatureFilter::require_usable(options.filter);
  require_budget(options.budget);
  state_->options = std::move(options);
}
const LayerPatchOptions& LayerPatchQuery::options() const {
  return state_->options;
}

SurfaceQueryStatus LayerPatchQuery::run(const SurfaceTree& surface, Workers& workers) {
  return state_->run(state_of(surface), state_of(surface), workers);
}
SurfaceQueryStatus LayerPatchQuery::run(const SurfaceTree& a, const SurfaceTree& b, Workers& workers) {
  return state_->run(state_of(a), state_of(b), workers);
}
SurfaceQueryStatus LayerPatchQuery::resume(Workers& workers) {
  const LayerPatchOptions& options = state_->options;
  return state_->run_call(CallKind::goes_on, [&](const FacetsNear& narrow) {
    return state_->query.resume(options.thickness, options, workers, narrow);
  });
}

std::span<const LayerPatch> LayerPatchQuery::patches() const {
  return state_->result.patches;
}
double LayerPatchQuery::volume() const {
  return state_->result.volume;
}
const std::vector<OpenFacets>& LayerPatchQuery::open() const {
  return state_->query.open();
}

}  // namespace morula
