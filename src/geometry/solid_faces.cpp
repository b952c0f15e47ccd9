// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "geometry/solid_faces.hpp"

#include <algorithm>

#include "parallel/interruptible_sort.hpp"

namespace morula::detail {
namespace {

using FaceCorners = std::array<std::uint8_t, 4>;  // corners of a solid, counter-clockwise seen from outside
constexpr std::uint8_t none = 255;                // the fourth corner of a triangle

constexpr std::array tetrahedron_faces{FaceCorners{0, 2, 1, none}, FaceCorners{0, 1, 3, none},
                                       FaceCorners{1, 2, 3, none}, FaceCorners{0, 3, 2, none}};
constexpr std::array hexahedron_faces{FaceCorners{0, 3, 2, 1}, FaceCorners{4, 5, 6, 7}, FaceCorners{0, 1, 5, 4},
                                      FaceCorners{1, 2, 6, 5}, FaceCorners{2, 3, 7, 6}, FaceCorners{3, 0, 4, 7}};
constexpr std::array wedge_faces{FaceCorners{0, 1, 2, none}, FaceCorners{3, 5, 4, none}, FaceCorners{0, 3, 4, 1},
                                 FaceCorners{1, 4, 5, 2}, FaceCorners{2, 5, 3, 0}};
constexpr std::array pyramid_faces{FaceCorners{0, 3, 2, 1}, FaceCorners{0, 1, 4, none}, FaceCorners{1, 2, 4, none},
                                   FaceCorners{2, 3, 4, none}, FaceCorners{3, 0, 4, none}};

std::span<const FaceCorners> faces_of(SolidShape shape) {
  switch (shape) {
    case SolidShape::tetrahedron:
      return tetrahedron_faces;
    case SolidShape::hexahedron:
      return hexahedron_faces;
    case SolidShape::wedge:
      return wedge_faces;
    case SolidShape::pyramid:
      return pyramid_faces;
  }
  return {};
}

}  // namespace

double signed_volume_of(SolidShape shape, std::span<const Vec3> points, const std::uint32_t* corners) {
  double volume = 0;
  for (const FaceCorners& face : faces_of(shape)) {
    const Vec3 origin = points[corners[0]], a = points[corners[face[0]]] - origin;
    for (std::size_t k = 2; k < 4 && face[k] != none; ++k)
      volume += dot(a, cross(points[corners[face[k - 1]]] - origin, points[corners[face[k]]] - origin));
  }
  return volume;
}

void add_faces(SolidShape shape, const std::uint32_t* corners, bool is_mirrored, std::size_t solid,
               std::vector<SolidFace>& faces) {
  for (const FaceCorners& face : faces_of(shape)) {
    SolidFace made{{no_corner, no_corner, no_corner, no_corner}, {}, faces.size(), solid};
    const std::size_t count = face[3] == none ? 3 : 4;
    for (std::size_t k = 0; k < count; ++k) made.key[k] = corners[face[k]];
    made.vertices = made.key;
    if (is_mirrored) std::reverse(made.vertices.begin(), made.vertices.begin() + static_cast<std::ptrdiff_t>(count));
    std::sort(made.key.begin(), made.key.end());
    faces.push_back(made);
  }
}

void sort_by_key(std::vector<SolidFace>& faces) {
  sort_interruptibly(
      faces, [](const SolidFace& a, const SolidFace& b) { return a.key != b.key ? a.key < b.key : a.place < b.place; });
}

std::size_t end_of_run(std::span<const SolidFace> faces, std::size_t begin) {
  std::size_t end = begin + 1;
  while (end < faces.size() && faces[end].key == faces[begin].key) ++end;
  return end;
}

void sort_by_place(std::vector<SolidFace>& faces) {
  sort_interruptibly(faces, [](const SolidFace& a, const SolidFace& b) { return a.place < b.place; });
}

}  // namespace morula::detail
