// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clumps in the formats of discrete element codes. Each writer's comment gives the requirements of its reader.
#include <algorithm>
#include <array>
#include <charconv>
#include <morula/grains/clump.hpp>

namespace morula {

namespace {

/// The fewest digits that read back as the same bits, never "-0".
std::string digits(double value) {
  char text[64];
  const auto written = std::to_chars(text, text + sizeof text, value == 0 ? 0.0 : value);
  return {text, written.ptr};
}

std::string row(const Vec3& center, double radius, char between) {
  std::string text;
  for (const double value : {center.x, center.y, center.z}) text += digits(value) + between;
  return text + digits(radius);
}

Vec3 about_center(const Clump& clump, const Vec3& p) {
  return p - clump.solid.center;
}

std::array<double, 6> inertia(const Clump& clump) {
  std::array<double, 6> result = clump.solid.inertia;
  for (double& entry : result) entry *= clump.density;
  return result;
}

/// A line of a comment for spheres that leave surface uncovered; "" for all others.
std::string distance_line(const Clump& clump, const std::string& comment) {
  if (!(clump.within > 0)) return "";
  return comment + " every point of the surface lies within " + digits(clump.within) + " of a sphere\n";
}

std::string joined(std::span<const double> values, const char* between) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : between) + digits(value);
  return text;
}

/// `fix particletemplate/multisphere … spheres file`: x y z r per line; text after # is skipped. Quotes, $ and & have a
/// meaning in its reader, even in comments.
std::string liggghts_text(const Clump& clump, std::string_view /*name*/) {
  std::string text = "# x y z radius about the center of mass\n";
  text += "# nspheres " + std::to_string(clump.spheres.size()) + " mass " + digits(clump.mass()) + " inertia_tensor " +
          joined(inertia(clump), " ") + " use_density\n" + distance_line(clump, "#");
  for (const Sphere& s : clump.spheres) text += row(about_center(clump, s.center), s.radius, ' ') + '\n';
  return text;
}

/// `ymport.textClumps`: x y z r and the number of the clump; lines that begin with # are skipped, empty ones are an
/// error.
std::string yade_text(const Clump& clump, std::string_view /*name*/) {
  std::string text = "#format x_y_z_r_clumpId\n";
  text += "# about the center of mass; volume " + digits(clump.solid.volume) + "\n" + distance_line(clump, "#");
  for (const Sphere& s : clump.spheres) text += row(about_center(clump, s.center), s.radius, ' ') + " 0\n";
  return text;
}

/// DEM-Engine's `LoadClumpType`: columns x, y, z, r by the names in the first line; no comments. It reads the numbers
/// as relative to the center of mass, along principal axes, and gets mass and moments from its caller.
std::string chrono_text(const Clump& clump, std::string_view /*name*/) {
  std::string text = "x,y,z,r\n";
  for (const Sphere& s : clump.spheres) text += row(clump.principal(s.center), s.radius, ',') + '\n';
  return text;
}

/// `.clu`: a keyword, its value on the very next line; lines that begin with // are skipped anywhere. A name is one
/// word. The reader subtracts the center and reads the three moments as moments along x, y and z. It scales a clump by
/// Size.
std::string kratos_text(const Clump& clump, std::string_view name) {
  std::string word(name.empty() ? "clump" : name);
  for (char& c : word) {
    if (static_cast<unsigned char>(c) <= ' ' || c == '/') c = '_';
  }
  double reach = 0;
  std::string rows;
  for (const Sphere& s : clump.spheres) {
    const Vec3 center = clump.principal(s.center);
    reach = std::max(reach, length(center) + s.radius);
    rows += row(center, s.radius, ' ') + '\n';
  }
  const double volume = clump.solid.volume;
  std::string text = "// Spheres about the center of mass, along principal axes\n" + distance_line(clump, "//");
  text += "\nName\n" + word + "\n\n";
  text += "Begin centers_and_radii\n" + rows + "End centers_and_radii\n\n";
  text += "Particle_center_and_diameter\n" + row({}, 2 * reach, ' ') + "\n\n";
  text += "Size\n" + digits(2 * reach) + "\n\nVolume\n" + digits(volume) + "\n\nInertia per unit mass\n";
  for (int axis = 0; axis < 3; ++axis) text += digits(volume > 0 ? clump.principal_inertia[axis] / volume : 0) + '\n';
  return text;
}

std::string list(const Vec3& v) {
  return '[' + joined(std::array{v.x, v.y, v.z}, ", ") + ']';
}

std::string json_text(const Clump& clump, std::string_view /*name*/) {
  std::string text = "{\n  \"format\": \"morula-clump\",\n  \"version\": 1,\n  \"kind\": \"";
  text += name(clump.kind);
  text += std::string("\",\n  \"proven\": ") + (clump.proven ? "true" : "false");
  if (clump.kind == ClumpKind::cover) text += ",\n  \"within\": " + digits(clump.within);
  text += ",\n  \"density\": " + digits(clump.density) + ",\n  \"mass\": " + digits(clump.mass()) +
          ",\n  \"volume\": " + digits(clump.solid.volume) + ",\n  \"center_of_mass\": " + list(clump.solid.center) +
          ",\n  \"inertia\": [" + joined(inertia(clump), ", ") + "],\n  \"principal_axes\": [";
  for (std::size_t i = 0; i < 3; ++i) text += (i == 0 ? "" : ", ") + list(clump.principal.rows[i]);
  text += "],\n  \"principal_moments\": " + list(clump.density * clump.principal_inertia) + ",\n  \"spheres\": [\n";
  for (std::size_t i = 0; i < clump.spheres.size(); ++i) {
    const Sphere& s = clump.spheres[i];
    text += "    {\"center\": " + list(s.center) + ", \"radius\": " + digits(s.radius) +
            (i + 1 < clump.spheres.size() ? "},\n" : "}\n");
  }
  return text + "  ]\n}\n";
}

constexpr std::array formats{
    ClumpFormat{"liggghts", "", "LIGGGHTS, fix particletemplate/multisphere", "the mesh's, about the center of mass",
                liggghts_text},
    ClumpFormat{"yade", "", "Yade, ymport.textClumps", "the mesh's, about the center of mass", yade_text},
    ClumpFormat{"chrono", ".csv", "Chrono's DEM-Engine, LoadClumpType", "principal ones about the center of mass",
                chrono_text},
    ClumpFormat{"kratos", ".clu", "Kratos, DEM clusters", "principal ones about the center of mass", kratos_text},
    ClumpFormat{"json", ".json", "scripts; all figures with the spheres", "the mesh's", json_text},
};

}  // namespace

std::span<const ClumpFormat> clump_formats() {
  return formats;
}

}  // namespace morula
