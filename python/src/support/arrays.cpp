// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "arrays.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace morula::python {

namespace {

using Any = nb::ndarray<nb::ro>;

std::string shape_of(const Any& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i) text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return text + (array.ndim() == 1 ? ",)" : ")");
}

std::string type_of(const Any& array) {
  const nb::dlpack::dtype type = array.dtype();
  const char* kind = "bytes";
  switch (static_cast<nb::dlpack::dtype_code>(type.code)) {
    case nb::dlpack::dtype_code::Int:
      kind = "int";
      break;
    case nb::dlpack::dtype_code::UInt:
      kind = "uint";
      break;
    case nb::dlpack::dtype_code::Float:
      kind = "float";
      break;
    case nb::dlpack::dtype_code::Complex:
      kind = "complex";
      break;
    case nb::dlpack::dtype_code::Bool:
      return "bool";
    default:
      break;
  }
  return kind + std::to_string(type.bits);
}

bool is_kind(const Any& array, nb::dlpack::dtype_code kind) {
  return array.dtype().code == static_cast<std::uint8_t>(kind) && array.dtype().lanes == 1;
}
bool is_float(const Any& array) {
  return is_kind(array, nb::dlpack::dtype_code::Float) && (array.dtype().bits == 32 || array.dtype().bits == 64);
}

/// Copies of large arrays are long calls: they call this with the number of every row. Throws the exception that a
/// signal's handler raised. Memory of the copies is reserved and filled row by row: filling it with zeros first would
/// be a long call without a check.
void check_signals_at(std::size_t row) {
  if (row % 65536 == 65535 && PyErr_CheckSignals() != 0) throw nb::python_error();
}

bool is_true(nb::handle object, const char* attribute) {
  return nb::hasattr(object, attribute) && object.attr(attribute).is(nb::bool_(true));
}

/// The same for an array of NumPy with numbers that cannot be read in place.
std::string way_in_of_numpy(nb::handle given, const std::string& name) {
  const nb::object type = given.attr("dtype");
  if (type.attr("isnative").is(nb::bool_(false)))
    return " in this machine's byte order: " + name + ".astype(" + name + ".dtype.newbyteorder('='))";
  const auto bytes = nb::cast<std::int64_t>(nb::object(type.attr("itemsize")));
  for (nb::handle stride : nb::borrow<nb::object>(given.attr("strides")))
    if (bytes > 0 && nb::cast<std::int64_t>(stride) % bytes != 0)
      return ": numpy.ascontiguousarray(" + name + "), since its rows are not whole numbers apart";
  return "";
}

/// The Python line that makes an array of the argument; empty if there is none.
std::string way_in(nb::handle given, const std::string& name) {
  if (PyList_Check(given.ptr()) || PyTuple_Check(given.ptr())) return ": numpy.asarray(" + name + ")";
  if (is_true(given, "requires_grad")) return ": " + name + ".detach(), since no gradient passes through here";
  if (is_true(given, "is_cuda")) return " in main memory: " + name + ".cpu()";
  if (nb::hasattr(given, "dtype") && nb::hasattr(given.attr("dtype"), "isnative")) return way_in_of_numpy(given, name);
  if (nb::hasattr(given, "__dlpack_device__")) return " in main memory: copy it there first";
  return "";
}

/// Throws TypeError for an argument that is not an array in memory.
Any array_of(nb::handle given, const char* name, const std::string& wanted) {
  Any array;
  if (!nb::try_cast(given, array, false) || !array.is_valid() || array.device_type() != nb::device::cpu::value) {
    throw nb::type_error(
        (std::string(name) + ": " + describe(given) + ", but " + wanted + " is needed" + way_in(given, name)).c_str());
  }
  return array;
}

[[noreturn]] void reject(const char* name, const Any& array, const std::string& wanted,
                         const std::string& remedy = {}) {
  throw std::invalid_argument(std::string(name) + ": an array of " + type_of(array) + ", shape " + shape_of(array) +
                              ", but " + wanted + " is needed" + (remedy.empty() ? "" : ": " + remedy));
}

/// Is every number where the compiler expects one of its type? NumPy's arrays over records and buffers need not be so.
bool is_aligned(const Any& array) {
  return reinterpret_cast<std::uintptr_t>(array.data()) % (array.dtype().bits / 8) == 0;
}

/// One number, aligned or not. offset: in numbers.
template <class Scalar>
Scalar load(const Any& array, std::int64_t offset) {
  Scalar value;
  std::memcpy(&value, static_cast<const std::byte*>(array.data()) + offset * std::int64_t{sizeof value}, sizeof value);
  return value;
}
template <class Scalar>
double at(const Any& array, const std::size_t* index) {
  std::int64_t offset = 0;
  for (std::size_t i = 0; i < array.ndim(); ++i) offset += array.stride(i) * static_cast<std::int64_t>(index[i]);
  return static_cast<double>(load<Scalar>(array, offset));
}
double number(const Any& array, std::size_t i, std::size_t j) {
  const std::size_t index[]{i, j};
  return array.dtype().bits == 32 ? at<float>(array, index) : at<double>(array, index);
}

Any given_rows(nb::handle given, const char* name, std::size_t columns, const char* each) {
  const std::string wanted = "an array of float32 or float64, shape (n, " + std::to_string(columns) + ")" + each + ",";
  Any array = array_of(given, name, wanted);
  if (array.ndim() != 2 || array.shape(1) != columns) reject(name, array, wanted);
  if (!is_float(array)) reject(name, array, wanted, std::string(name) + ".astype(float)");
  return array;
}

}  // namespace

std::string describe(nb::handle object) {
  Any array;
  if (nb::try_cast(object, array, false) && array.is_valid()) {
    return "an array of " + type_of(array) + ", shape " + shape_of(array);
  }
  if (object.is_none()) return "None";
  return "an object of type " + nb::cast<std::string>(nb::str(nb::handle(object.type()).attr("__name__")));
}

namespace {

/// 2882 as "2,882".
std::string with_commas(std::size_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, ",");
  return text;
}

}  // namespace

void require_rows(std::size_t given, std::size_t wanted, const char* name, int columns, const char* of) {
  if (given == wanted) return;
  const std::string by = columns > 0 ? " × " + std::to_string(columns) : "";
  throw std::invalid_argument(std::string(name) + ": " + with_commas(wanted) + by + " expected (" + of + "), " +
                              with_commas(given) + by + " given");
}

void reject_type(nb::handle given, const std::string& name, const std::string& wanted) {
  throw nb::type_error((name + ": " + describe(given) + ", but " + wanted + " is needed").c_str());
}

Positions::Positions(nb::handle given, const char* name) : Positions() {
  read(given, name, 2);
}

Positions Positions::frames(nb::handle given, const char* name) {
  Positions positions;
  positions.read(given, name, 3);
  return positions;
}

Positions::Positions(const Positions& frames, std::size_t frame) : Positions() {
  array_ = frames.array_;
  copy_ = frames.copy_;
  const auto* first = frames.view_.address(0) + static_cast<std::ptrdiff_t>(frame) * frames.frame_stride_;
  const std::size_t stride = static_cast<std::size_t>(frames.view_.address(1) - frames.view_.address(0));
  view_ = frames.view_.is_double()
              ? PositionView::strided(reinterpret_cast<const double*>(first), frames.view_.size(), stride)
              : PositionView::strided(reinterpret_cast<const float*>(first), frames.view_.size(), stride);
}

void Positions::read(nb::handle given, const char* name, std::size_t axes) {
  const std::string wanted = axes == 2 ? "an array of float32 or float64, shape (vertices, 3),"
                                       : "an array of float32 or float64, shape (frames, vertices, 3),";
  array_ = array_of(given, name, wanted);
  if (array_.ndim() != axes || array_.shape(axes - 1) != 3) reject(name, array_, wanted);
  if (!is_float(array_)) reject(name, array_, wanted, std::string(name) + ".astype(float)");
  const std::size_t count = array_.shape(axes - 2);
  const std::int64_t scalar = array_.dtype().bits / 8;
  const bool is_double = scalar == 8;
  if (axes == 3) frame_count_ = array_.shape(0);
  if (array_.stride(axes - 1) == 1 && array_.stride(axes - 2) >= 0 && is_aligned(array_)) {
    const auto stride = static_cast<std::size_t>(array_.stride(axes - 2) * scalar);
    view_ = is_double ? PositionView::strided(static_cast<const double*>(array_.data()), count, stride)
                      : PositionView::strided(static_cast<const float*>(array_.data()), count, stride);
    frame_stride_ = axes == 3 ? array_.stride(0) * scalar : 0;
    return;
  }
  copy_ = std::make_shared<std::vector<Vec3>>();
  copy_->reserve(frame_count_ * count);
  for (std::size_t i = 0; i < frame_count_ * count; ++i) {
    check_signals_at(i);
    double v[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t index[]{axes == 3 ? i / count : i, axes == 3 ? i % count : k, k};
      v[k] = is_double ? at<double>(array_, index) : at<float>(array_, index);
    }
    copy_->push_back({v[0], v[1], v[2]});
  }
  view_ = PositionView(std::span<const Vec3>(copy_->data(), count));
  frame_stride_ = static_cast<std::int64_t>(count * sizeof(Vec3));
}

std::vector<Vec3> points_of(nb::handle given, const char* name) {
  const Any array = given_rows(given, name, 3, "");
  std::vector<Vec3> points;
  points.reserve(array.shape(0));
  for (std::size_t i = 0; i < array.shape(0); ++i) {
    check_signals_at(i);
    points.push_back({number(array, i, 0), number(array, i, 1), number(array, i, 2)});
  }
  return points;
}

std::vector<Sphere> spheres_of(nb::handle given, const char* name) {
  const Any array = given_rows(given, name, 4, ", x y z radius");
  std::vector<Sphere> spheres;
  spheres.reserve(array.shape(0));
  for (std::size_t i = 0; i < array.shape(0); ++i) {
    check_signals_at(i);
    spheres.push_back({{number(array, i, 0), number(array, i, 1), number(array, i, 2)}, number(array, i, 3)});
  }
  return spheres;
}

std::vector<double> numbers_of(nb::handle given, const char* name, std::vector<std::int64_t> axes,
                               std::vector<std::size_t>& shape) {
  std::string wanted = "an array of float32 or float64, shape (";
  for (std::size_t i = 0; i < axes.size(); ++i)
    wanted += (i > 0 ? ", " : "") + (axes[i] < 0 ? std::string("n") : std::to_string(axes[i]));
  wanted += axes.size() == 1 ? ",)," : "),";
  const Any array = array_of(given, name, wanted);
  bool fits = array.ndim() == axes.size();
  for (std::size_t i = 0; fits && i < axes.size(); ++i) {
    fits = axes[i] < 0 || array.shape(i) == static_cast<std::size_t>(axes[i]);
  }
  if (!fits) reject(name, array, wanted);
  if (!is_float(array)) reject(name, array, wanted, std::string(name) + ".astype(float)");
  shape.assign(array.ndim(), 0);
  std::size_t count = 1;
  for (std::size_t i = 0; i < shape.size(); ++i) count *= shape[i] = array.shape(i);
  std::vector<double> numbers;
  numbers.reserve(count);
  std::vector<std::size_t> index(shape.size(), 0);
  for (std::size_t i = 0; i < count; ++i) {
    check_signals_at(i);
    numbers.push_back(array.dtype().bits == 32 ? at<float>(array, index.data()) : at<double>(array, index.data()));
    for (std::size_t axis = index.size(); axis-- > 0 && ++index[axis] == shape[axis];) index[axis] = 0;
  }
  return numbers;
}

namespace {

template <class Integer>
void require_index(Integer value, std::size_t row, const char* name) {
  if (!std::in_range<std::uint32_t>(value)) {
    throw std::invalid_argument(std::string(name) + ": row " + std::to_string(row) + " holds " + std::to_string(value) +
                                ", but indices are 0 to 4294967295");
  }
}

template <class Integer>
void read_integers(const Any& array, const char* name, std::uint32_t* to) {
  const std::size_t columns = array.ndim() == 2 ? array.shape(1) : 1;
  const std::int64_t across = array.ndim() == 2 ? array.stride(1) : 0;
  for (std::size_t i = 0; i < array.shape(0); ++i) {
    check_signals_at(i);
    for (std::size_t k = 0; k < columns; ++k) {
      const auto value =
          load<Integer>(array, array.stride(0) * static_cast<std::int64_t>(i) + across * static_cast<std::int64_t>(k));
      require_index(value, i, name);
      *to++ = static_cast<std::uint32_t>(value);
    }
  }
}

void read_integers(const Any& array, const char* name, const std::string& wanted, std::uint32_t* to) {
  const bool is_signed = is_kind(array, nb::dlpack::dtype_code::Int);
  if (!is_signed && !is_kind(array, nb::dlpack::dtype_code::UInt)) {
    reject(name, array, wanted, std::string(name) + ".astype(numpy.uint32)");
  }
  switch (array.dtype().bits) {
    case 8:
      return is_signed ? read_integers<std::int8_t>(array, name, to) : read_integers<std::uint8_t>(array, name, to);
    case 16:
      return is_signed ? read_integers<std::int16_t>(array, name, to) : read_integers<std::uint16_t>(array, name, to);
    case 32:
      return is_signed ? read_integers<std::int32_t>(array, name, to) : read_integers<std::uint32_t>(array, name, to);
    case 64:
      return is_signed ? read_integers<std::int64_t>(array, name, to) : read_integers<std::uint64_t>(array, name, to);
    default:
      reject(name, array, wanted);
  }
}

}  // namespace

std::vector<std::uint32_t> indices_of(nb::handle given, const char* name) {
  const std::string wanted = "an array of integers, shape (n,),";
  const Any array = array_of(given, name, wanted);
  if (array.ndim() != 1) reject(name, array, wanted);
  std::vector<std::uint32_t> indices(array.shape(0));
  read_integers(array, name, wanted, indices.data());
  return indices;
}

std::vector<std::uint32_t> index_rows_of(nb::handle given, const char* name, std::size_t columns) {
  const std::string wanted = "an array of integers, shape (n, " + std::to_string(columns) + "),";
  const Any array = array_of(given, name, wanted);
  if (array.ndim() != 2 || array.shape(1) != columns) reject(name, array, wanted);
  std::vector<std::uint32_t> indices(array.shape(0) * columns);
  read_integers(array, name, wanted, indices.data());
  return indices;
}

namespace {

constexpr const char* wanted_facets = "an array of integers, shape (facets, 3),";

Any facet_array_of(nb::handle given, const char* name) {
  const std::string wanted = wanted_facets;
  Any array = array_of(given, name, wanted);
  if (array.ndim() == 1 && array.shape(0) > 0 && array.shape(0) % 4 == 0) {
    reject(name, array, wanted,
           "if these are PyVista's padded faces, give " + std::string(name) + ".reshape(-1, 4)[:, 1:]");
  }
  if (array.ndim() != 2 || array.shape(1) != 3) {
    reject(name, array, wanted, array.ndim() == 2 && array.shape(1) == 4 ? "divide quadrangles into triangles" : "");
  }
  return array;
}

std::vector<Facet> copied_facets(const Any& array, const char* name) {
  std::vector<Facet> facets(array.shape(0));
  read_integers(array, name, wanted_facets, reinterpret_cast<std::uint32_t*>(facets.data()));
  return facets;
}

/// Does the array have the bits of facets, should no index be negative?
bool is_packed_facets(const Any& array) {
  const bool is_signed = is_kind(array, nb::dlpack::dtype_code::Int);
  return (is_signed || is_kind(array, nb::dlpack::dtype_code::UInt)) && array.dtype().bits == 32 &&
         array.stride(1) == 1 && (array.stride(0) == 3 || array.shape(0) < 2) && is_aligned(array);
}

}  // namespace

std::vector<Facet> facets_of(nb::handle given, const char* name) {
  return copied_facets(facet_array_of(given, name), name);
}

Facets::Facets(nb::handle given, const char* name) : array_(facet_array_of(given, name)) {
  if (!is_packed_facets(array_)) {
    own_ = copied_facets(array_, name);
    view_ = own_;
    return;
  }
  view_ = {reinterpret_cast<const Facet*>(array_.data()), array_.shape(0)};
  if (!is_kind(array_, nb::dlpack::dtype_code::Int)) return;
  for (std::size_t f = 0; f < view_.size(); ++f) {
    check_signals_at(f);
    for (const std::uint32_t index : view_[f]) require_index(static_cast<std::int32_t>(index), f, name);
  }
}

namespace {

/// Throws ValueError for the first index that names no vertex: `where` its row is, as text.
template <class Where>
void require_vertices(std::span<const Facet> facets, std::size_t vertex_count, const Where& where) {
  for (std::size_t f = 0; f < facets.size(); ++f) {
    check_signals_at(f);
    for (const std::uint32_t vertex : facets[f]) {
      if (vertex >= vertex_count) {
        throw std::invalid_argument(where(f) + " vertex " + std::to_string(vertex) + " of " +
                                    std::to_string(vertex_count));
      }
    }
  }
}

BorrowedMesh mesh_of_arrays(nb::handle given_positions, nb::handle given_facets, const std::string& positions_name,
                            const std::string& facets_name) {
  Positions positions(given_positions, positions_name.c_str());
  Facets facets(given_facets, facets_name.c_str());
  require_vertices(facets.view(), positions.view().size(),
                   [&](std::size_t row) { return facets_name + ": row " + std::to_string(row) + " names"; });
  return {std::move(positions), std::move(facets)};
}

/// Triangles of a meshio.Mesh: of all its blocks, one after the other. A single block is not copied.
BorrowedMesh mesh_of_cells(nb::handle given, const std::string& name) {
  Positions positions(nb::object(given.attr("points")), (name + ".points").c_str());
  std::vector<Facets> blocks;
  for (nb::handle block : given.attr("cells")) {
    const auto type = nb::cast<std::string>(nb::object(block.attr("type")));
    if (type == "vertex" || type == "line") continue;
    if (type != "triangle") {
      throw std::invalid_argument(name + ": a meshio.Mesh with cells of type '" + type +
                                  "', but triangles are needed: take the triangles of its surface");
    }
    blocks.emplace_back(nb::object(block.attr("data")), (name + ".cells").c_str());
  }
  if (blocks.size() != 1) {
    std::vector<Facet> all;
    for (const Facets& block : blocks) all.insert(all.end(), block.view().begin(), block.view().end());
    blocks.clear();
    blocks.emplace_back(std::move(all));
  }
  require_vertices(blocks[0].view(), positions.view().size(), [&](std::size_t) { return name + ".cells:"; });
  return {std::move(positions), std::move(blocks[0])};
}

}  // namespace

std::shared_ptr<const Mesh> BorrowedMesh::kept() const {
  if (mesh_) return mesh_;
  auto copy = std::make_shared<Mesh>();
  copy->positions.reserve(view_.vertex_count());
  for (std::size_t v = 0; v < view_.vertex_count(); ++v) {
    check_signals_at(v);
    copy->positions.push_back(view_.positions[v]);
  }
  copy->facets.assign(view_.facets.begin(), view_.facets.end());
  return copy;
}

BorrowedMesh mesh_of(const MeshGiven& given, const char* name) {
  const nb::handle object = given.object;
  const std::string argument = name;
  if (nb::isinstance<Mesh>(object)) return BorrowedMesh(nb::cast<std::shared_ptr<Mesh>>(object));
  if (PyTuple_Check(object.ptr()) && PyTuple_Size(object.ptr()) == 2)
    return mesh_of_arrays(object[0], object[1], argument + "[0]", argument + "[1]");
  if (nb::hasattr(object, "vertices") && nb::hasattr(object, "faces")) {
    return mesh_of_arrays(nb::object(object.attr("vertices")), nb::object(object.attr("faces")), argument + ".vertices",
                          argument + ".faces");
  }
  if (nb::hasattr(object, "points") && nb::hasattr(object, "cells") && nb::hasattr(object, "cells_dict")) {
    return mesh_of_cells(object, name);
  }
  if (nb::hasattr(object, "points") && nb::hasattr(object, "faces")) {
    const std::string n = name;
    throw nb::type_error((n + ": " + describe(object) + ", whose faces are padded (PyVista); give morula.Mesh(" + n +
                          ".points, " + n + ".triangulate().faces.reshape(-1, 4)[:, 1:])")
                             .c_str());
  }
  throw nb::type_error((std::string(name) + ": " + describe(object) +
                        ", but a mesh is needed: a morula.Mesh, anything with .vertices and .faces (such as "
                        "trimesh.Trimesh), a meshio.Mesh of triangles, or a tuple (positions, facets)")
                           .c_str());
}

}  // namespace morula::python
