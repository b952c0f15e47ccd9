// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/robot.hpp>
#include <numbers>
#include <unordered_map>

#include "io/mesh/reading.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"
#include "read/xml.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

constexpr int deepest_node = 64;
constexpr std::size_t most_facets = 50'000'000, most_instances = 10'000;

/// x → rows · x + shift: a scene may scale and shear.
struct Affine {
  std::array<Vec3, 3> rows{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 shift{};

  Vec3 linear(const Vec3& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  Vec3 operator()(const Vec3& p) const { return linear(p) + shift; }
  bool mirrors() const { return dot(rows[0], cross(rows[1], rows[2])) < 0; }
};

Affine affine_product(const Affine& a, const Affine& b) {
  Affine result;
  for (int column = 0; column < 3; ++column) {
    const Vec3 v = a.linear({b.rows[0][column], b.rows[1][column], b.rows[2][column]});
    for (int row = 0; row < 3; ++row) result.rows[static_cast<std::size_t>(row)][column] = v[row];
  }
  result.shift = a(b.shift);
  return result;
}

struct Reader {
  const Xml& xml;
  const std::string& part;
  std::unordered_map<std::string, const XMLElement*> by_id{};
  Mesh mesh{};
  detail::MeshReading reading{};
  detail::PolygonReader cutter{reading};
  std::vector<std::uint32_t> polygon{};
  std::size_t instances = 0, elements = 0, faces = 0, holed = 0;
  mutable detail::InterruptPoller poll_interrupt{1u << 14};  // before each number, position and facet

  /// A few nodes that hold each other several times would expand to more than any program can draw.
  void count_instance(const XMLElement& at) {
    if (++instances > most_instances + elements) {
      xml.fail(at, fmt::format("nodes and geometries are shown more than {} times", most_instances + elements));
    }
  }

  bool is_part(const XMLElement& at) const {
    for (const char* attribute : {"name", "id"}) {
      if (const char* own = at.Attribute(attribute); own != nullptr && part == own) return true;
    }
    return false;
  }

  void remember(const XMLElement& at) {
    ++elements;
    if (const char* id = at.Attribute("id")) by_id.emplace(id, &at);
    for (const XMLElement* it = at.FirstChildElement(); it != nullptr; it = it->NextSiblingElement()) remember(*it);
  }

  /// The element that "#name" in an attribute refers to.
  const XMLElement& target(const XMLElement& at, const char* attribute) const {
    const std::string url = xml.text(at, attribute);
    if (url[0] != '#') xml.fail(at, fmt::format("\"{}\" is in another file, which is not read", url));
    const auto found = by_id.find(url.substr(1));
    if (found == by_id.end()) xml.fail(at, fmt::format("there is nothing called \"{}\"", url));
    return *found->second;
  }

  std::vector<double> numbers(const XMLElement& at, std::size_t count = 0) const {
    std::vector<double> values;
    const char* text = at.GetText();
    if ((text != nullptr && !read_numbers(text, values)) || (count != 0 && values.size() != count)) {
      xml.fail(at, fmt::format("<{}> does not hold {} numbers", at.Name(),
                               count == 0 ? std::string("only") : std::to_string(count)));
    }
    return values;
  }

  std::vector<std::size_t> indices(const XMLElement& at) const {
    const std::vector<double> values = numbers(at);
    std::vector<std::size_t> result;
    result.reserve(values.size());
    for (const double value : values) {
      poll_interrupt();
      if (!(value >= 0 && value < 4e9 && value == std::floor(value))) {
        xml.fail(at, fmt::format("<{}> holds {}, which is no index", at.Name(), value));
      }
      result.push_back(static_cast<std::size_t>(value));
    }
    return result;
  }

  static const XMLElement* input(const XMLElement& of, std::string_view semantic) {
    for (const XMLElement* it = of.FirstChildElement("input"); it != nullptr; it = it->NextSiblingElement("input")) {
      const char* name = it->Attribute("semantic");
      if (name != nullptr && name == semantic) return it;
    }
    return nullptr;
  }

  std::vector<Vec3> positions(const XMLElement& vertices) const {
    const XMLElement* at = input(vertices, "POSITION");
    if (at == nullptr) xml.fail(vertices, "vertices have no positions");
    const XMLElement& source = target(*at, "source");
    const XMLElement* array = source.FirstChildElement("float_array");
    if (array == nullptr) xml.fail(source, "a source holds no <float_array>");
    const std::vector<double> values = numbers(*array);
    std::size_t stride = 3, offset = 0;
    if (const XMLElement* technique = source.FirstChildElement("technique_common")) {
      if (const XMLElement* accessor = technique->FirstChildElement("accessor")) {
        const double wide = xml.number(*accessor, "stride", 3), first = xml.number(*accessor, "offset", 0);
        if (!(wide >= 3 && wide <= 1024 && first >= 0 && first < 4e9))
          xml.fail(*accessor, "positions need a stride of 3 or more");
        stride = static_cast<std::size_t>(wide);
        offset = static_cast<std::size_t>(first);
      }
    }
    std::vector<Vec3> result;
    for (std::size_t i = offset; i + 3 <= values.size(); i += stride) {
      poll_interrupt();
      result.push_back({values[i], values[i + 1], values[i + 2]});
    }
    return result;
  }

  void add_facet(const XMLElement& at, std::size_t base, std::size_t count, std::array<std::size_t, 3> corners,
                 bool turned) {
    poll_interrupt();
    for (const std::size_t corner : corners) {
      if (corner >= count) xml.fail(at, fmt::format("there is no vertex {} of {}", corner, count));
    }
    if (turned) std::swap(corners[1], corners[2]);
    if (mesh.facets.size() >= most_facets) xml.fail(at, "there are more than 50 million facets");
    mesh.facets.push_back({static_cast<std::uint32_t>(base + corners[0]), static_cast<std::uint32_t>(base + corners[1]),
                           static_cast<std::uint32_t>(base + corners[2])});
  }

  /// The facets from `first` on are a polygon's, about its first corner: others take their place where these are wrong.
  void cut_polygon(const XMLElement& at, std::size_t first, bool turned) {
    const std::span<Facet> facets = std::span(mesh.facets).subspan(first);
    polygon.assign({facets[0][0], facets[0][turned ? 2 : 1]});
    for (const Facet& f : facets) polygon.push_back(f[turned ? 1 : 2]);
    cutter.cut(mesh.positions, polygon, mesh.facets, first, {faces - 1, static_cast<std::size_t>(at.GetLineNum())});
    if (!turned) return;
    for (Facet& f : facets) std::swap(f[1], f[2]);
  }

  /// Polygons, strips and fans of one element; `base`: where its vertices begin in the mesh.
  void add_primitives(const XMLElement& at, std::size_t base, std::size_t count, bool turned) {
    const std::string_view kind = at.Name();
    const XMLElement* vertex = input(at, "VERTEX");
    if (vertex == nullptr) xml.fail(at, fmt::format("<{}> names no vertices", kind));
    std::size_t stride = 0;
    for (const XMLElement* it = at.FirstChildElement("input"); it != nullptr; it = it->NextSiblingElement("input")) {
      stride = std::max(stride, 1 + static_cast<std::size_t>(std::clamp(xml.number(*it, "offset", 0), 0.0, 1024.0)));
    }
    const auto offset = static_cast<std::size_t>(std::clamp(xml.number(*vertex, "offset", 0), 0.0, 1024.0));
    std::vector<std::size_t> sizes;
    if (const XMLElement* counts = at.FirstChildElement("vcount"); counts != nullptr && kind == "polylist") {
      sizes = indices(*counts);
    }
    const auto corners_in = [&](const XMLElement& p) {
      const std::vector<std::size_t> all = indices(p);
      std::vector<std::size_t> corners;
      for (std::size_t i = offset; i < all.size(); i += stride) corners.push_back(all[i]);
      return corners;
    };
    for (const XMLElement* it = at.FirstChildElement(); it != nullptr; it = it->NextSiblingElement()) {
      // A polygon with holes: its outline, then one <h> a hole.
      const bool has_holes = std::string_view(it->Name()) == "ph";
      const XMLElement* p = has_holes ? it->FirstChildElement("p") : it;
      if (p == nullptr || std::string_view(p->Name()) != "p") continue;
      holed += has_holes && it->FirstChildElement("h") != nullptr ? 1 : 0;
      const std::vector<std::size_t> corners = corners_in(*p);
      const auto fan = [&](std::size_t begin, std::size_t size) {
        for (std::size_t k = 2; k < size; ++k) {
          add_facet(*p, base, count, {corners[begin], corners[begin + k - 1], corners[begin + k]}, turned);
        }
      };
      const auto cut = [&](std::size_t begin, std::size_t size) {
        const std::size_t first = mesh.facets.size();
        fan(begin, size);
        ++faces;
        if (size > 3) cut_polygon(*p, first, turned);
      };
      if (kind == "triangles") {
        for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) fan(i, 3);
      } else if (kind == "polylist") {
        std::size_t begin = 0;
        for (const std::size_t size : sizes) {
          if (size > corners.size() - begin) xml.fail(*p, "polygons have more corners than there are");
          cut(begin, size);
          begin += size;
        }
      } else if (kind == "tristrips") {
        for (std::size_t i = 2; i < corners.size(); ++i) {
          add_facet(*p, base, count, {corners[i - 2], corners[i - 1], corners[i]}, turned != (i % 2 == 1));
        }
      } else if (kind == "polygons") {
        cut(0, corners.size());
      } else {
        fan(0, corners.size());
      }
    }
  }

  void add_geometry(const XMLElement& geometry, const Affine& pose, bool within) {
    count_instance(geometry);
    if (!within && !is_part(geometry)) return;
    const XMLElement* data = geometry.FirstChildElement("mesh");
    if (data == nullptr) return;
    const XMLElement* vertices = data->FirstChildElement("vertices");
    if (vertices == nullptr) xml.fail(*data, "a mesh has no vertices");
    const std::size_t base = mesh.positions.size();
    for (const Vec3& p : positions(*vertices)) {
      poll_interrupt();
      mesh.positions.push_back(pose(p));
    }
    const std::size_t count = mesh.positions.size() - base;
    for (const char* kind : {"triangles", "polylist", "polygons", "tristrips", "trifans"}) {
      for (const XMLElement* at = data->FirstChildElement(kind); at != nullptr; at = at->NextSiblingElement(kind)) {
        add_primitives(*at, base, count, pose.mirrors());
      }
    }
  }

  Affine step(const XMLElement& at) const {
    Affine pose;
    const std::string_view name = at.Name();
    if (name == "matrix") {
      const std::vector<double> m = numbers(at, 16);
      for (std::size_t row = 0; row < 3; ++row) {
        pose.rows[row] = {m[4 * row], m[4 * row + 1], m[4 * row + 2]};
        pose.shift[static_cast<int>(row)] = m[4 * row + 3];
      }
    } else if (name == "translate") {
      const std::vector<double> t = numbers(at, 3);
      pose.shift = {t[0], t[1], t[2]};
    } else if (name == "scale") {
      const std::vector<double> s = numbers(at, 3);
      pose.rows = {Vec3{s[0], 0, 0}, Vec3{0, s[1], 0}, Vec3{0, 0, s[2]}};
    } else if (name == "rotate") {
      const std::vector<double> r = numbers(at, 4);
      pose.rows = RigidTransform::from_axis({r[0], r[1], r[2]}, r[3] * std::numbers::pi / 180).rows;
    }
    return pose;
  }

  void add_node(const XMLElement& node, Affine pose, int depth, bool within) {
    count_instance(node);
    within = within || is_part(node);
    if (depth > deepest_node) xml.fail(node, "nodes are nested more than 64 deep, or in a circle");
    for (const XMLElement* it = node.FirstChildElement(); it != nullptr; it = it->NextSiblingElement()) {
      const std::string_view name = it->Name();
      if (name == "instance_geometry") {
        add_geometry(target(*it, "url"), pose, within);
      } else if (name == "instance_controller") {
        const XMLElement& controller = target(*it, "url");
        if (const XMLElement* skin = controller.FirstChildElement("skin")) {
          add_geometry(target(*skin, "source"), pose, within);
        }
      } else if (name == "instance_node") {
        add_node(target(*it, "url"), pose, depth + 1, within);
      } else if (name == "node") {
        add_node(*it, pose, depth + 1, within);
      } else {
        pose = affine_product(pose, step(*it));
      }
    }
  }
};

}  // namespace

Mesh read_collada(const std::filesystem::path& path, const std::string& part) {
  MeshInfo info;
  return read_collada(path, part, info);
}

Mesh read_collada(const std::filesystem::path& path, const std::string& part, MeshInfo& info) {
  const Xml xml(path, "COLLADA");
  Reader reader{xml, part};
  const bool all = part.empty();
  reader.remember(xml.root());
  Affine units;
  if (const XMLElement* asset = xml.root().FirstChildElement("asset")) {
    if (const XMLElement* unit = asset->FirstChildElement("unit")) {
      const double meter = xml.number(*unit, "meter", 1);
      if (!(meter > 0)) xml.fail(*unit, "a unit is not above 0");
      units.rows = {Vec3{meter, 0, 0}, Vec3{0, meter, 0}, Vec3{0, 0, meter}};
    }
  }
  const XMLElement* scene = xml.root().FirstChildElement("scene");
  const XMLElement* instance = scene == nullptr ? nullptr : scene->FirstChildElement("instance_visual_scene");
  const XMLElement* library = xml.root().FirstChildElement("library_visual_scenes");
  if (instance != nullptr) {
    reader.add_node(reader.target(*instance, "url"), units, 0, all);
  } else if (library != nullptr && library->FirstChildElement("visual_scene") != nullptr) {
    reader.add_node(*library->FirstChildElement("visual_scene"), units, 0, all);
  } else if (const XMLElement* geometries = xml.root().FirstChildElement("library_geometries")) {
    for (const XMLElement* at = geometries->FirstChildElement("geometry"); at != nullptr;
         at = at->NextSiblingElement("geometry")) {
      reader.add_geometry(*at, units, all);
    }
  }
  if (reader.mesh.facets.empty()) {
    throw FileError(
        all ? fmt::format("{}: the scene holds no facets", platform::text_of(path))
            : fmt::format("{}: there is no node or geometry {} with facets", platform::text_of(path), part));
  }
  reader.cutter.finish("polygon");
  if (reader.holed > 0)
    reader.reading.info.notes.push_back(detail::counted(reader.holed, "polygon") +
                                        (reader.holed == 1 ? " has" : " have") +
                                        " holes, which are filled; export triangles to keep them");
  info = std::move(reader.reading.info);
  return std::move(reader.mesh);
}

}  // namespace morula::robot
