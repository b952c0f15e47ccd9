// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/paraview/vtp.hpp"

#include <morula/io/whole_output.hpp>
#include <stdexcept>

#include "io/byte_reader.hpp"
#include "io/number_text.hpp"
#include "parallel/interruption.hpp"

namespace morula {
namespace detail {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  AskNowAndThen ask_now_and_then(1u << 16);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    ask_now_and_then();
    unsigned bits = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? alphabet[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
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

template <class Value, class Get>
std::string numbers(std::size_t count, const Get& get) {
  std::string bytes;
  bytes.reserve(8 + count * sizeof(Value));
  store(bytes, std::uint64_t{count * sizeof(Value)});
  AskNowAndThen ask_now_and_then(1u << 16);
  for (std::size_t i = 0; i < count; ++i) {
    ask_now_and_then();
    store(bytes, static_cast<Value>(get(i)));
  }
  return base64(bytes);
}

std::string array(std::string_view type, std::string_view name, std::size_t components, const std::string& data) {
  return "        <DataArray type=\"" + std::string(type) + "\" Name=\"" + escaped(name) + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\" format=\"binary\">" + data + "</DataArray>\n";
}

std::string arrays(std::string_view group, const std::vector<VtpArray>& list) {
  std::string text = "      <" + std::string(group) + ">\n";
  for (const VtpArray& a : list) {
    const auto get = [&](std::size_t i) { return a.values[i]; };
    text += a.whole ? array("Int32", a.name, a.components, numbers<std::int32_t>(a.values.size(), get))
                    : array("Float64", a.name, a.components, numbers<double>(a.values.size(), get));
  }
  return text + "      </" + std::string(group) + ">\n";
}

std::string cells(std::string_view group, std::size_t count, std::size_t corners, const std::string& connectivity) {
  return "      <" + std::string(group) + ">\n" + array("Int32", "connectivity", 1, connectivity) +
         array("Int64", "offsets", 1, numbers<std::int64_t>(count, [&](std::size_t i) { return (i + 1) * corners; })) +
         "      </" + std::string(group) + ">\n";
}

}  // namespace

std::string vtp_text(const VtpData& data) {
  const std::size_t points = data.points.size(), facets = data.facets.size(), vertices = facets == 0 ? points : 0;
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" ";
  text += "header_type=\"UInt64\">\n  <PolyData>\n    <Piece NumberOfPoints=\"" + std::to_string(points) +
          "\" NumberOfVerts=\"" + std::to_string(vertices) +
          "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"" + std::to_string(facets) + "\">\n";
  text += arrays("PointData", data.point_arrays) + arrays("CellData", data.facet_arrays);
  text +=
      "      <Points>\n" +
      array("Float64", "Points", 3,
            numbers<double>(3 * points, [&](std::size_t i) { return data.points[i / 3][static_cast<int>(i % 3)]; })) +
      "      </Points>\n";
  text += cells("Verts", vertices, 1, numbers<std::int32_t>(vertices, [](std::size_t i) { return i; }));
  text += cells("Polys", facets, 3,
                numbers<std::int32_t>(3 * facets, [&](std::size_t i) { return data.facets[i / 3][i % 3]; }));
  return text + "    </Piece>\n  </PolyData>\n</VTKFile>\n";
}

std::string vtp_mesh_text(const MeshView& mesh) {
  VtpData data;
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i) data.points.push_back(mesh.positions[i]);
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
