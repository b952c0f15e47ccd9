// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/paraview/vtp.hpp"

#include <array>
#include <morula/io/whole_output.hpp>
#include <stdexcept>
#include <type_traits>

#include "io/byte_reader.hpp"
#include "io/number_text.hpp"
#include "parallel/interruption.hpp"

namespace morula {
namespace detail {
namespace {

void append_base64(std::string& text, std::string_view bytes) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    poll_interrupt();
    unsigned bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[at + k]) : 0u);
    std::array<char, 4> digits{};
    for (std::size_t k = 0; k < 4; ++k) digits[k] = k <= count ? alphabet[bits >> (18 - 6 * k) & 63u] : '=';
    text.append(digits.data(), digits.size());
  }
}

/// Text that may stand between quotes of an attribute.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '&') {
      result += "&amp;";
    } else if (c == '<') {
      result += "&lt;";
    } else if (c == '"') {
      result += "&quot;";
    } else if (static_cast<unsigned char>(c) >= ' ') {
      result += c;
    }
  }
  return result;
}

/// The element <DataArray>: rows × components numbers of type Value; number i is get(i).
template <class Value, class Get>
void append_array(std::string& text, std::string_view name, std::size_t components, std::size_t count, const Get& get) {
  constexpr std::string_view type = std::is_same_v<Value, double>         ? "Float64"
                                    : std::is_same_v<Value, std::int64_t> ? "Int64"
                                                                          : "Int32";
  std::string bytes;
  bytes.reserve(8 + count * sizeof(Value));
  store(bytes, std::uint64_t{count * sizeof(Value)});
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t i = 0; i < count; ++i) {
    poll_interrupt();
    store(bytes, static_cast<Value>(get(i)));
  }
  text += "        <DataArray type=\"" + std::string(type) + "\" Name=\"" + escaped(name) + "\" NumberOfComponents=\"" +
          std::to_string(components) + "\" format=\"binary\">";
  text.reserve(text.size() + bytes.size() / 3 * 4 + 100);
  append_base64(text, bytes);
  text += "</DataArray>\n";
}

void append_arrays(std::string& text, std::string_view group, const std::vector<VtpArray>& list) {
  text += "      <" + std::string(group) + ">\n";
  for (const VtpArray& a : list) {
    const auto get = [&](std::size_t i) { return a.values[i]; };
    a.whole ? append_array<std::int32_t>(text, a.name, a.components, a.values.size(), get)
            : append_array<double>(text, a.name, a.components, a.values.size(), get);
  }
  text += "      </" + std::string(group) + ">\n";
}

/// Cells with so many corners each; corner i is point_of(i).
template <class Get>
void append_cells(std::string& text, std::string_view group, std::size_t count, std::size_t corners,
                  const Get& point_of) {
  text += "      <" + std::string(group) + ">\n";
  append_array<std::int32_t>(text, "connectivity", 1, count * corners, point_of);
  append_array<std::int64_t>(text, "offsets", 1, count, [&](std::size_t i) { return (i + 1) * corners; });
  text += "      </" + std::string(group) + ">\n";
}

}  // namespace

std::string vtp_text(const VtpData& data) {
  const std::size_t points = data.points.size(), facets = data.facets.size(), vertices = facets == 0 ? points : 0;
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" ";
  text += "header_type=\"UInt64\">\n  <PolyData>\n    <Piece NumberOfPoints=\"" + std::to_string(points) +
          "\" NumberOfVerts=\"" + std::to_string(vertices) +
          "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" + std::to_string(facets) + "\">\n";
  append_arrays(text, "PointData", data.point_arrays);
  append_arrays(text, "CellData", data.facet_arrays);
  text += "      <Points>\n";
  append_array<double>(text, "Points", 3, 3 * points,
                       [&](std::size_t i) { return data.points[i / 3][static_cast<int>(i % 3)]; });
  text += "      </Points>\n";
  append_cells(text, "Verts", vertices, 1, [](std::size_t i) { return i; });
  append_cells(text, "Polys", facets, 3, [&](std::size_t i) { return data.facets[i / 3][i % 3]; });
  text += "    </Piece>\n  </PolyData>\n</VTKFile>\n";
  return text;
}

std::string vtp_mesh_text(const MeshView& mesh) {
  VtpData data;
  data.points = mesh.positions.to_vector();
  data.facets.assign(mesh.facets.begin(), mesh.facets.end());
  return vtp_text(data);
}

}  // namespace detail

void write_vtp(const std::filesystem::path& path, const VtpData& data) {
  const auto check = [](const std::vector<VtpArray>& list, std::size_t rows, const char* what) {
    for (const VtpArray& a : list) {
      if (a.components == 0 || a.values.size() != rows * a.components)
        throw std::invalid_argument("array " + a.name + " has " + std::to_string(a.values.size()) + " numbers for " +
                                    std::to_string(rows) + " " + what);
    }
  };
  check(data.point_arrays, data.points.size(), "points");
  check(data.facet_arrays, data.facets.size(), "facets");
  for (const Facet& facet : data.facets) {
    for (const std::uint32_t v : facet)
      if (v >= data.points.size()) throw std::invalid_argument("a facet refers to a point that is not there");
  }
  write_whole(path, detail::vtp_text(data));
}

void write_pvd(const std::filesystem::path& path, std::span<const PvdEntry> entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const PvdEntry& entry : entries) {
    text += "    <DataSet timestep=\"";
    detail::append_number(text, entry.time);
    text += "\" group=\"\" part=\"0\" file=\"" + detail::escaped(entry.file) + "\"/>\n";
  }
  write_whole(path, text + "  </Collection>\n</VTKFile>\n");
}

}  // namespace morula
