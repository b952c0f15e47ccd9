// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/reading.hpp"

#include <algorithm>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

std::string place_of(const PolygonReader::Place& place, std::string_view kind) {
  std::string text = std::string(kind) + " " + std::to_string(place.face) + ", counted from 0";
  if (place.line > 0) text += ", on line " + std::to_string(place.line);
  return text;
}

}  // namespace

std::string counted(std::size_t count, std::string_view one) {
  return std::to_string(count) + " " + std::string(one) + (count == 1 ? "" : "s");
}

void LeftOut::add(std::size_t at, std::string_view name) {
  if (count++ > 0) return;
  line = at;
  first = name;
}

void PolygonReader::cut(std::span<const Vec3> points, std::span<const std::uint32_t> corners, std::span<Facet> facets,
                        std::size_t first, Place place) {
  const std::span<Facet> own = facets.subspan(first, corners.size() - 2);
  MeshInfo& info = reading_.info;
  ++info.polygons;
  // mutant frame-polygons-by-themselves: `if (cut_as_given(corners, own, first)) return` -> ``
  if (cut_as_given(corners, own, first)) return;
  const PolygonShape shape = cutter_.cut(points, corners, own);
  if (shape.cut == PolygonCut::ears) ++info.concave_polygons;
  if (shape.cut == PolygonCut::crossing && info.crossing_polygons++ == 0) first_crossing_ = place;
  if (shape.bent && info.bent_polygons++ == 0) first_bent_ = place;
}

// Facets with as many corners fill the polygon when its sides are the rest of their sides: all others cancel in pairs.
// Welded vertices stand for the corners that became them.
bool PolygonReader::cut_as_given(std::span<const std::uint32_t> corners, std::span<Facet> own, std::size_t first) {
  if (reading_.cut_like.size() < first + own.size()) return false;
  const std::span<const Facet> given = reading_.cut_like.subspan(first, own.size());
  in_rest_.assign(corners.begin(), corners.end());
  if (!reading_.cut_like_vertex.empty())
    for (std::uint32_t& v : in_rest_) {
      if (v >= reading_.cut_like_vertex.size()) return false;
      v = reading_.cut_like_vertex[v];
    }
  std::vector<std::pair<std::uint32_t, std::uint32_t>>& to = sides_;
  to.clear();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> back;
  const auto add = [&](std::uint32_t a, std::uint32_t b) {
    if (a == b) return;
    to.emplace_back(a, b);
    back.emplace_back(b, a);
  };
  for (const Facet& f : given)
    for (std::size_t k = 0; k < 3; ++k) add(f[k], f[(k + 1) % 3]);
  for (std::size_t k = 0; k < corners.size(); ++k) add(in_rest_[(k + 1) % corners.size()], in_rest_[k]);
  std::sort(to.begin(), to.end());
  std::sort(back.begin(), back.end());
  // mutant frame-polygons-unchecked: `if (to != back) return false` -> ``
  if (to != back) return false;
  for (std::size_t i = 0; i < own.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      // Where corners of the polygon are welded, either of them is right: facets are compared as welded ones.
      const auto at = std::find(in_rest_.begin(), in_rest_.end(), given[i][k]);
      if (at == in_rest_.end()) return false;
      own[i][k] = corners[static_cast<std::size_t>(at - in_rest_.begin())];
    }
  return true;
}

void PolygonReader::finish(std::string_view kind) {
  MeshInfo& info = reading_.info;
  const std::string one(kind);
  if (info.crossing_polygons > 0)
    info.notes.push_back(
        counted(info.crossing_polygons, one) + (info.crossing_polygons == 1 ? " crosses itself" : " cross themselves") +
        " or cannot be cut in reasonable time, and became facets about the first corner; the first is " +
        place_of(first_crossing_, kind));
  if (info.bent_polygons > 0)
    info.notes.push_back(counted(info.bent_polygons, one) +
                         (info.bent_polygons == 1 ? " is far from flat, and was" : " are far from flat, and were") +
                         " cut as seen along the normal; the first is " + place_of(first_bent_, kind));
}

void FaceReader::end(std::size_t line) {
  const std::size_t first = mesh_.facets.size();
  const PolygonReader::Place place{faces_++, line};
  for (std::size_t k = 2; k < corners_.size(); ++k) mesh_.facets.push_back({corners_[0], corners_[k - 1], corners_[k]});
  if (corners_.size() == 3) return;
  const std::size_t known = mesh_.vertex_count();
  if (std::all_of(corners_.begin(), corners_.end(), [&](std::uint32_t v) { return v < known; }))
    polygons_.cut(mesh_.positions, corners_, mesh_.facets, first, place);
  else
    waiting_.push_back({first, corners_.size(), place});
}

void FaceReader::finish() {
  InterruptPoller poll_interrupt(4096);
  for (const Waiting& polygon : waiting_) {
    poll_interrupt();
    corners_of_fan(std::span(mesh_.facets).subspan(polygon.first, polygon.corners - 2), corners_);
    polygons_.cut(mesh_.positions, corners_, mesh_.facets, polygon.first, polygon.place);
  }
  waiting_.clear();
  polygons_.finish("face");
}

void corners_of_fan(std::span<const Facet> fan, std::vector<std::uint32_t>& corners) {
  corners.assign({fan[0][0], fan[0][1]});
  for (const Facet& f : fan) corners.push_back(f[2]);
}

}  // namespace morula::detail
