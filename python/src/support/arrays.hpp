// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Arrays: in as they are, where their layout allows it; out as views that keep their owner.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/positions.hpp>
#include <morula/geometry/sphere.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "casters.hpp"

namespace morula::python {

/// "an array of int64, shape (5, 3)", "a list": for messages.
std::string describe(nb::handle object);
/// Throws TypeError for `given`. wanted: the required type as text, "an array of floats".
[[noreturn]] void reject_type(nb::handle given, const std::string& name, const std::string& wanted);
/// A plain value that is looked at by name. Throws TypeError.
template <class Value>
Value value_of(nb::handle given, const std::string& name, const char* wanted) {
  Value value;
  if (!nb::try_cast(given, value)) reject_type(given, name, wanted);
  return value;
}
/// The same for a value that a Python function has returned.
template <class Value>
Value returned(nb::handle given, const char* function, const char* wanted) {
  return value_of<Value>(given, std::string(function) + "() has returned", wanted);
}

/// Positions of one frame, as an array gives them. Nothing is copied when the three numbers of a vertex lie together,
/// aligned, and vertices are at equal distances: C order, slices, columns of records. Else they are copied, as double.
class Positions {
 public:
  /// Throws ValueError or TypeError that names the argument, its type and shape, and the remedy.
  Positions(nb::handle given, const char* name);
  /// One frame of an array of frames.
  Positions(const Positions& frames, std::size_t frame);
  Positions(Positions&&) = default;
  Positions& operator=(Positions&&) = default;
  const PositionView& view() const { return view_; }
  std::size_t frame_count() const { return frame_count_; }
  /// Positions from an array of shape (frames, vertices, 3).
  static Positions frames(nb::handle given, const char* name);

 private:
  Positions() : view_(std::span<const Vec3>()) {}
  void read(nb::handle given, const char* name, std::size_t axes);

  nb::ndarray<nb::ro> array_;
  std::shared_ptr<std::vector<Vec3>> copy_;
  PositionView view_;
  std::size_t frame_count_ = 1;
  std::int64_t frame_stride_ = 0;  // bytes
};

/// Copies of arrays of floats: rows of three, four, or any number of numbers.
std::vector<Vec3> points_of(nb::handle given, const char* name);
std::vector<Sphere> spheres_of(nb::handle given, const char* name);
/// shape: of the array, as many axes as `axes` says; -1 there stands for any length.
std::vector<double> numbers_of(nb::handle given, const char* name, std::vector<std::int64_t> axes,
                               std::vector<std::size_t>& shape);
/// Any integers, checked: none negative, none beyond 32 bits.
std::vector<std::uint32_t> indices_of(nb::handle given, const char* name);
std::vector<Facet> facets_of(nb::handle given, const char* name);
/// Rows of so many indices, one after the other.
std::vector<std::uint32_t> index_rows_of(nb::handle given, const char* name, std::size_t columns);

/// Facets, as an array gives them. Nothing is copied of 32-bit integers in C order, signed or not, that are aligned;
/// others are converted.
class Facets {
 public:
  /// Throws ValueError or TypeError as facets_of() does, for negative indices too.
  Facets(nb::handle given, const char* name);
  explicit Facets(std::vector<Facet>&& own) : own_(std::move(own)), view_(own_) {}
  Facets(Facets&&) = default;
  Facets& operator=(Facets&&) = default;
  std::span<const Facet> view() const { return view_; }

 private:
  nb::ndarray<nb::ro> array_;
  std::vector<Facet> own_;  // of facets that were converted
  std::span<const Facet> view_;
};

/// Throws ValueError unless an argument has as many rows as `of` has of something: "the mesh's vertices". columns: of
/// the array; 0 where a row is one number.
void require_rows(std::size_t given, std::size_t wanted, const char* name, int columns, const char* of);

/// A read-only view of data that its owner still uses.
template <class Scalar, nb::ssize_t... Shape>
using View = nb::ndarray<nb::numpy, const Scalar, nb::shape<Shape...>>;
/// Memory of the array's own: a copy that the caller may write to.
template <class Scalar, nb::ssize_t... Shape>
using Copy = nb::ndarray<nb::numpy, Scalar, nb::shape<Shape...>>;
using Points = View<double, -1, 3>;
using SphereRows = View<double, -1, 4>;
using Numbers = View<double, -1>;
using Indices = View<std::uint32_t, -1>;
using IndexTriples = View<std::uint32_t, -1, 3>;
using IndexPairs = View<std::uint32_t, -1, 2>;
using Flags = View<bool, -1>;

/// Views of memory that `owner` keeps.
inline Points points(std::span<const Vec3> p, nb::handle owner) {
  return Points(reinterpret_cast<const double*>(p.data()), {p.size(), 3}, owner);
}
inline SphereRows sphere_rows(std::span<const Sphere> s, nb::handle owner) {
  return SphereRows(reinterpret_cast<const double*>(s.data()), {s.size(), 4}, owner);
}
inline IndexTriples triples(std::span<const Facet> f, nb::handle owner) {
  return IndexTriples(reinterpret_cast<const std::uint32_t*>(f.data()), {f.size(), 3}, owner);
}
inline Indices indices(std::span<const std::uint32_t> i, nb::handle owner) {
  return Indices(i.data(), {i.size()}, owner);
}
inline Numbers numbers(std::span<const double> n, nb::handle owner) {
  return Numbers(n.data(), {n.size()}, owner);
}

/// Moves a vector to where an array keeps it.
template <class T>
std::pair<std::vector<T>*, nb::capsule> kept(std::vector<T>&& values) {
  auto* moved = new std::vector<T>(std::move(values));
  return {moved, nb::capsule(moved, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); })};
}
inline Copy<double, -1, 3> own_points(std::vector<Vec3>&& p) {
  auto [values, owner] = kept(std::move(p));
  return {reinterpret_cast<double*>(values->data()), {values->size(), 3}, owner};
}
inline Copy<double, -1, 4> own_spheres(std::vector<Sphere>&& s) {
  auto [values, owner] = kept(std::move(s));
  return {reinterpret_cast<double*>(values->data()), {values->size(), 4}, owner};
}
inline Copy<std::uint32_t, -1> own_indices(std::vector<std::uint32_t>&& i) {
  auto [values, owner] = kept(std::move(i));
  return {values->data(), {values->size()}, owner};
}
inline Copy<double, -1> own_numbers(std::vector<double>&& n) {
  auto [values, owner] = kept(std::move(n));
  return {values->data(), {values->size()}, owner};
}

/// One member of many records, as a strided view.
template <class Record, class Scalar>
View<Scalar, -1> column(std::span<const Record> records, const Scalar* first, nb::handle owner) {
  static_assert(sizeof(Record) % sizeof(Scalar) == 0);
  const std::int64_t strides[]{static_cast<std::int64_t>(sizeof(Record) / sizeof(Scalar))};
  const std::size_t shape[]{records.size()};
  return View<Scalar, -1>(first, 1, shape, owner, strides);
}
template <class Record, class Row>
View<double, -1, 3> column3(std::span<const Record> records, const Row* first, nb::handle owner) {
  static_assert(sizeof(Record) % sizeof(double) == 0 && sizeof(Row) == 3 * sizeof(double));
  const std::int64_t strides[]{static_cast<std::int64_t>(sizeof(Record) / sizeof(double)), 1};
  const std::size_t shape[]{records.size(), 3};
  return View<double, -1, 3>(reinterpret_cast<const double*>(first), 2, shape, owner, strides);
}

/// The mesh of a call: a view of the given Mesh or arrays, and their owners. Arrays are copied only if Positions or
/// Facets cannot borrow them.
class BorrowedMesh {
 public:
  explicit BorrowedMesh(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)), view_(*mesh_) {}
  BorrowedMesh(Positions&& positions, Facets&& facets)
      : positions_(std::move(positions)), facets_(std::move(facets)), view_(positions_->view(), facets_->view()) {}
  BorrowedMesh(BorrowedMesh&&) = default;
  BorrowedMesh& operator=(BorrowedMesh&&) = default;
  const MeshView& operator*() const { return view_; }
  const MeshView* operator->() const { return &view_; }
  /// The Mesh that was given, or a copy of the arrays.
  std::shared_ptr<const Mesh> kept() const;

 private:
  std::shared_ptr<const Mesh> mesh_;    // this,
  std::optional<Positions> positions_;  // or these
  std::optional<Facets> facets_;
  MeshView view_;
};

/// A mesh of ours, anything with `vertices` and `faces`, a meshio.Mesh, or a tuple of two arrays. All its indices are
/// in range. Throws ValueError or TypeError that names the argument and the remedy.
BorrowedMesh mesh_of(const MeshGiven& given, const char* name = "mesh");
/// The same for an object that reads the mesh after the call, when the owner of the arrays may have written to them: a
/// solver moves its vertices, and a facet that changes could name no vertex.
inline std::shared_ptr<const Mesh> kept_mesh_of(const MeshGiven& given, const char* name = "mesh") {
  return mesh_of(given, name).kept();
}

}  // namespace morula::python
