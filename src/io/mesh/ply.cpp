// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "io/byte_reader.hpp"
#include "io/mesh/formats.hpp"
#include "io/mesh/ply_header.hpp"
#include "io/text_scanner.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

// Rows of a text PLY: one line each.
class TextRows {
 public:
  TextRows(TextScanner& in) : in_(in) {}
  void begin_row(std::uint64_t row, const PlyElement& element) {
    element_ = &element;
    in_.require_line(row, element.count, "rows of element " + in_quotes(element.name));
  }
  double value(PlyType type, std::string_view what) {
    return is_integer(type) ? static_cast<double>(in_.integer(what)) : in_.number(what);
  }
  void skip(PlyType, std::uint64_t count) {
    for (std::uint64_t k = 0; k < count; ++k)
      if (in_.word().empty()) in_.fail("the line ends inside the row of element " + in_quotes(element_->name));
  }
  void end_row() { in_.require_line_end("the last property of element " + in_quotes(element_->name)); }
  void end_file() {
    if (in_.next_line())
      in_.fail(in_quotes(in_.word()) + " follows the last element; correct the counts in the header");
  }
  std::uint64_t bytes_left() const { return in_.bytes_left(); }
  std::size_t line() const { return in_.line(); }
  [[noreturn]] void fail(const std::string& problem) const { in_.fail(problem); }

 private:
  TextScanner& in_;
  const PlyElement* element_ = nullptr;
};

class BinaryRows {
 public:
  BinaryRows(ByteReader in) : in_(in) {}
  void begin_row(std::uint64_t row, const PlyElement& element) {
    poll_interrupt_();
    row_ = row;
    element_ = &element;
  }
  double value(PlyType type, std::string_view what) {
    if (byte_size(type) > in_.bytes_left()) cut_short();
    switch (type) {
      case PlyType::int8:
        return in_.read<std::int8_t>(what);
      case PlyType::uint8:
        return in_.read<std::uint8_t>(what);
      case PlyType::int16:
        return in_.read<std::int16_t>(what);
      case PlyType::uint16:
        return in_.read<std::uint16_t>(what);
      case PlyType::int32:
        return in_.read<std::int32_t>(what);
      case PlyType::uint32:
        return in_.read<std::uint32_t>(what);
      case PlyType::float32:
        return finite(in_.read<float>(what), what);
      case PlyType::float64:
        return finite(in_.read<double>(what), what);
    }
    return 0;
  }
  void skip(PlyType type, std::uint64_t count) {
    if (count > in_.bytes_left() / byte_size(type)) cut_short();
    in_.skip(count * byte_size(type), element_->name);
  }
  void end_row() {}
  void end_file() {
    if (in_.bytes_left() > 0)
      in_.fail(std::to_string(in_.bytes_left()) + " bytes follow the last element; correct the counts in the header");
  }
  std::uint64_t bytes_left() const { return in_.bytes_left(); }
  std::size_t line() const { return 0; }
  [[noreturn]] void fail(const std::string& problem) const { in_.fail(problem); }

 private:
  [[noreturn]] void cut_short() const {
    in_.fail("the file ends inside row " + std::to_string(row_) + " of " + std::to_string(element_->count) +
             " of element " + in_quotes(element_->name) + "; it was cut short, or its counts are wrong");
  }
  double finite(double number, std::string_view what) const {
    if (!std::isfinite(number))
      in_.fail(std::string(what) + " is not finite; remove or repair it where the file was made");
    return number;
  }

  ByteReader in_;
  // mutant looks-ply-read: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt_{4096};
  std::uint64_t row_ = 0;
  const PlyElement* element_ = nullptr;
};

// The shortest row in bytes; in text each value takes a digit and a separator.
std::uint64_t shortest_row(const PlyElement& element, bool is_text) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties)
    bytes += is_text ? 2 : byte_size(property.is_list ? property.count_type : property.type);
  return bytes;
}

// The text of any number that a file gives as a count.
std::string shown_count(double count) {
  constexpr double most = 0x1p62;
  if (std::isnan(count)) return "no number of";
  return std::to_string(static_cast<std::int64_t>(std::clamp(count, -most, most)));
}

template <class Rows>
std::uint64_t list_length(Rows& rows, const PlyProperty& property) {
  const double length = rows.value(property.count_type, "a list's length");
  // A list's entries take at least a byte each: so no length can exceed the rest of the file.
  if (!(length >= 0 && length <= static_cast<double>(rows.bytes_left())))
    rows.fail("a list of property " + in_quotes(property.name) + " claims " + shown_count(length) + " entries, but " +
              std::to_string(rows.bytes_left()) + " bytes are left; it was cut short, or the length is wrong");
  return static_cast<std::uint64_t>(length);
}

// The name of radii of balls; meshes ignore them.
constexpr std::string_view radius_name = "radius";

// radii: radii of balls; null for a mesh.
template <class Rows>
void read_vertices(Rows& rows, const PlyElement& element, Mesh& mesh, std::vector<double>* radii) {
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.begin_row(row, element);
    Vec3 position;
    for (const PlyProperty& property : element.properties) {
      if (property.is_list)
        rows.skip(property.type, list_length(rows, property));
      else if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        position[property.name[0] - 'x'] = rows.value(property.type, "a coordinate");
      else if (radii != nullptr && property.name == radius_name)
        radii->push_back(rows.value(property.type, "a radius"));
      else
        rows.skip(property.type, 1);
    }
    rows.end_row();
    mesh.positions.push_back(position);
  }
}

std::string missing_vertex(double index, std::uint64_t vertex_count, const std::string& owner) {
  return owner + " refers to vertex " + std::to_string(static_cast<std::int64_t>(index)) + ", but the file has " +
         std::to_string(vertex_count) + " vertices, counted from 0";
}

template <class Rows>
void read_faces(Rows& rows, const PlyElement& element, std::uint64_t vertex_count, FaceReader& face) {
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.begin_row(row, element);
    for (const PlyProperty& property : element.properties) {
      if (!property.is_list) {
        rows.skip(property.type, 1);
        continue;
      }
      const std::uint64_t length = list_length(rows, property);
      if (!is_vertex_list(property)) {
        rows.skip(property.type, length);
        continue;
      }
      if (length < 3)
        rows.fail("a face has " + std::to_string(length) + " corners, fewer than 3; remove it or complete it");
      face.begin();
      for (std::uint64_t k = 0; k < length; ++k) {
        const double vertex = rows.value(property.type, "a vertex index");
        if (vertex < 0 || vertex >= static_cast<double>(vertex_count))
          rows.fail(missing_vertex(vertex, vertex_count, "a face"));
        face.add(static_cast<std::uint32_t>(vertex));
      }
      face.end(rows.line());
    }
    rows.end_row();
  }
}

// Every other triangle of a strip is reversed.
template <class Rows>
void read_strips(Rows& rows, const PlyElement& element, std::uint64_t vertex_count, Mesh& mesh) {
  InterruptPoller poll_interrupt(4096);  // one row holds all strips
  for (std::uint64_t row = 0; row < element.count; ++row) {
    rows.begin_row(row, element);
    for (const PlyProperty& property : element.properties) {
      const std::uint64_t length = property.is_list ? list_length(rows, property) : 1;
      if (!is_vertex_list(property)) {
        rows.skip(property.type, length);
        continue;
      }
      std::array<std::uint32_t, 2> last{};
      std::uint64_t corners = 0;
      for (std::uint64_t k = 0; k < length; ++k) {
        poll_interrupt();
        const double index = rows.value(property.type, "a vertex index");
        if (index < 0) {
          corners = 0;
          continue;
        }
        if (index >= static_cast<double>(vertex_count)) rows.fail(missing_vertex(index, vertex_count, "a strip"));
        const auto vertex = static_cast<std::uint32_t>(index);
        if (corners >= 2 && corners % 2 == 0) mesh.facets.push_back({last[0], last[1], vertex});
        if (corners >= 2 && corners % 2 == 1) mesh.facets.push_back({last[1], last[0], vertex});
        last = {last[1], vertex};
        ++corners;
      }
    }
    rows.end_row();
  }
}

template <class Rows>
Mesh read_elements(Rows rows, const PlyHeader& header, MeshReading& reading, std::vector<double>* radii = nullptr) {
  Mesh mesh;
  FaceReader face(mesh, reading);
  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;  // its rows take no space
    const std::uint64_t at_most = rows.bytes_left() / shortest_row(element, header.is_text) + 1;
    if (element.name == "vertex") {
      mesh.positions.reserve(std::min(element.count, at_most));
      read_vertices(rows, element, mesh, radii);
    } else if (element.name == "face") {
      mesh.facets.reserve(std::min(element.count, at_most));
      read_faces(rows, element, header.vertex_count, face);
    } else if (element.name == strips_name) {
      read_strips(rows, element, header.vertex_count, mesh);
    } else {
      for (std::uint64_t row = 0; row < element.count; ++row) {
        rows.begin_row(row, element);
        for (const PlyProperty& property : element.properties)
          rows.skip(property.type, property.is_list ? list_length(rows, property) : 1);
        rows.end_row();
      }
    }
  }
  rows.end_file();
  face.finish();
  return mesh;
}

}  // namespace

Mesh read_ply(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  TextScanner in = ply_scanner(path, bytes);
  const PlyHeader header = read_ply_header(in);
  if (header.is_text) return read_elements(TextRows(in), header, reading);
  const std::string_view data = in.after_line();
  return read_elements(BinaryRows(ByteReader(path, data, header.order, bytes.size() - data.size())), header, reading);
}

bool holds_balls(const PlyHeader& header) {
  bool has_radius = false;
  for (const PlyElement& element : header.elements) {
    if (element.name == "face" && element.count > 0) return false;
    if (element.name != "vertex") continue;
    const auto is_radius = [](const PlyProperty& p) { return p.name == radius_name && !p.is_list; };
    has_radius = std::count_if(element.properties.begin(), element.properties.end(), is_radius) == 1;
  }
  return has_radius;
}

std::vector<Sphere> read_ply_balls(const std::filesystem::path& path, std::string_view bytes) {
  TextScanner in = ply_scanner(path, bytes);
  const PlyHeader header = read_ply_header(in);
  if (!holds_balls(header))
    throw FileError(platform::text_of(path) +
                    ": holds no balls: these are vertices with a property 'radius', without faces");
  std::vector<double> radii;
  Mesh centers;
  MeshReading reading;
  if (header.is_text) {
    centers = read_elements(TextRows(in), header, reading, &radii);
  } else {
    const std::string_view data = in.after_line();
    centers = read_elements(BinaryRows(ByteReader(path, data, header.order, bytes.size() - data.size())), header,
                            reading, &radii);
  }
  std::vector<Sphere> balls(centers.positions.size());
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    poll_interrupt();
    balls[i] = {centers.positions[i], radii[i]};
    if (!(radii[i] >= 0))
      throw FileError(platform::text_of(path) + ": ball " + std::to_string(i) + " has a negative radius");
  }
  return balls;
}

std::string ply_bytes(const MeshView& mesh) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertex_count()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(mesh.facet_count()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + mesh.vertex_count() * 24 + mesh.facet_count() * 13);
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i) {
    poll_interrupt();
    for (int axis = 0; axis < 3; ++axis) store(bytes, mesh.positions[i][axis]);
  }
  for (const Facet& f : mesh.facets) {
    poll_interrupt();
    store(bytes, std::uint8_t{3});
    for (const std::uint32_t v : f) store(bytes, v);
  }
  return bytes;
}

}  // namespace morula::detail
