// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/grains/clump.hpp>
#include <morula/query/signed_distance.hpp>
#include <numbers>
#include <sstream>
#include <support/meshes.hpp>
#include <support/parity.hpp>

namespace morula {
namespace {

ClumpOptions quick(ClumpKind kind, std::size_t spheres) {
  return {.kind = kind, .spheres = spheres, .quality = Quality::draft, .candidates = 400};
}

/// What a code of single precision reads.
Sphere narrowed(const Sphere& s) {
  return {Vec3(Vec3f(s.center)), static_cast<float>(s.radius)};
}

/// Whether each sample of the surface and each of its corners, which spheres often just reach, is in a sphere.
bool covers_in_float(const Mesh& mesh, const std::vector<Sphere>& spheres) {
  std::vector<Vec3> points;
  for (const SurfacePoint& sample : sample_surface(mesh, 3000, 9)) points.push_back(sample.point);
  for (const Facet& facet : mesh.facets) {
    for (const std::uint32_t v : facet) points.push_back(mesh.positions[v]);
  }
  return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return std::any_of(spheres.begin(), spheres.end(),
                       [&](const Sphere& s) { return distance(narrowed(s).center, p) <= narrowed(s).radius; });
  });
}

TEST(Clump, covers_every_kind_of_mesh_with_no_more_spheres_than_asked_for) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    const Clump clump = fit_clump(named.mesh, quick(ClumpKind::cover, 6));
    EXPECT_TRUE(clump.proven) << named.name;
    EXPECT_EQ(clump.uncovered_distance, 0) << named.name;
    EXPECT_LE(clump.spheres.size(), 6u) << named.name;
    EXPECT_TRUE(covers_in_float(named.mesh, clump.spheres)) << named.name;
  }
}

TEST(Clump, inner_spheres_stay_inside_and_fill_more_the_more_there_are) {
  Random random(3);
  for (const std::string body : {"limb", "torus", "blob", "tool"}) {
    const Mesh mesh = sample_body(body, 16);
    const SignedDistance object(mesh);
    double missed = 1e300;
    for (const std::size_t count : {1u, 4u, 16u}) {
      const Clump clump = fit_clump(mesh, quick(ClumpKind::inner, count));
      EXPECT_TRUE(clump.proven) << body;
      EXPECT_EQ(clump.protrusion_max, 0) << body;
      ASSERT_LE(clump.spheres.size(), count);
      for (const Sphere& ball : clump.spheres) {
        EXPECT_EQ(object.protrusion_bound(narrowed(ball)), 0) << body;
        for (int i = 0; i < 20; ++i) {
          const Vec3 direction = normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
          EXPECT_TRUE(test::parity_inside(mesh, ball.center + ball.radius * direction)) << body;
        }
      }
      ASSERT_TRUE(clump.missed_volume.has_value());
      EXPECT_LT(*clump.missed_volume, missed) << body << " " << count;
      missed = *clump.missed_volume;
      EXPECT_LT(clump.solid.volume, *clump.object_volume);
    }
  }
}

TEST(Clump, one_inner_sphere_of_a_ball_is_nearly_the_ball) {
  const Clump clump = fit_clump(test::icosphere(3, 2.0, {5, 6, 7}), quick(ClumpKind::inner, 1));
  ASSERT_EQ(clump.spheres.size(), 1u);
  EXPECT_LT(distance(clump.spheres[0].center, {5, 6, 7}), 0.02);
  EXPECT_NEAR(clump.spheres[0].radius, 2.0, 0.02);
  EXPECT_NEAR(clump.mass(), 1000 * 4 * std::numbers::pi * 8 / 3, 0.03 * clump.mass());
}

TEST(Clump, inner_spheres_need_an_inside) {
  EXPECT_THROW(fit_clump(test::grid_plate(4), quick(ClumpKind::inner, 4)), std::invalid_argument);
  EXPECT_THROW(fit_clump(sample_body("bar", 4), {.kind = ClumpKind::inner, .min_radius = 0.6}), std::invalid_argument);
  EXPECT_TRUE(fit_clump(test::inverted(sample_body("bar", 4)), quick(ClumpKind::inner, 4)).proven);
}

TEST(Clump, radii_keep_their_limits) {
  const Mesh mesh = sample_body("limb", 16);
  ClumpOptions options = quick(ClumpKind::cover, 4);
  options.max_radius = 0.3;
  const Clump small = fit_clump(mesh, options);
  EXPECT_TRUE(small.proven);
  EXPECT_GT(small.spheres.size(), 4u);
  EXPECT_FALSE(small.notes.empty());
  for (const Sphere& s : small.spheres) EXPECT_LE(s.radius, 0.3);
  options.max_radius.reset();
  options.min_radius = 0.8;
  for (const Sphere& s : fit_clump(mesh, options).spheres) EXPECT_GE(s.radius, 0.8);
  options = quick(ClumpKind::inner, 64);
  options.min_radius = 0.2;
  options.max_radius = 0.25;
  for (const Sphere& s : fit_clump(mesh, options).spheres) {
    EXPECT_GE(s.radius, 0.2);
    EXPECT_LE(s.radius, 0.25);
  }
}

TEST(Clump, as_few_as_a_protrusion_needs) {
  const Mesh mesh = sample_body("limb", 16);
  ClumpOptions options = quick(ClumpKind::cover, 0);
  options.max_protrusion = 0.1;
  const Clump clump = fit_clump(mesh, options);
  EXPECT_LE(clump.protrusion_max, 0.1 + 1e-4);
  EXPECT_GT(clump.spheres.size(), 1u);
}

TEST(Clump, principal_axes_diagonalize_the_tensor_and_turn_with_the_mesh) {
  // The oracle: the tensor turned by the rows has the moments on its diagonal and nothing beside it.
  Mesh mesh = sample_body("tool", 16);
  const RigidTransform pose = RigidTransform::from_axis({1, 2, 3}, 0.7, {4, -5, 6});
  for (Vec3& p : mesh.positions) p = pose(p);
  const Clump clump = fit_clump(mesh, quick(ClumpKind::cover, 8));
  const auto [xx, xy, xz, yy, yz, zz] = clump.solid.inertia;
  const std::array<Vec3, 3> tensor{Vec3{xx, xy, xz}, Vec3{xy, yy, yz}, Vec3{xz, yz, zz}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 a = clump.principal.rows[static_cast<std::size_t>(i)],
                 b = clump.principal.rows[static_cast<std::size_t>(j)];
      const double entry = dot(a, Vec3{dot(tensor[0], b), dot(tensor[1], b), dot(tensor[2], b)});
      EXPECT_NEAR(entry, i == j ? clump.principal_inertia[i] : 0, 1e-9 * zz);
    }
  }
  EXPECT_LT(deviation_from_rigid(clump.principal), 1e-12);
  EXPECT_LT(length(clump.principal(clump.solid.center)), 1e-12);
}

TEST(Clump, same_bits_for_any_number_of_workers_and_what_makes_no_sense_is_refused) {
  const Mesh mesh = sample_body("limb", 16);
  Workers three(3);
  for (const ClumpKind kind : {ClumpKind::cover, ClumpKind::inner}) {
    const Clump one = fit_clump(mesh, quick(kind, 8)), many = fit_clump(mesh, quick(kind, 8), three);
    EXPECT_EQ(one.spheres, many.spheres);
    EXPECT_EQ(one.solid.inertia, many.solid.inertia);
  }
  EXPECT_THROW(fit_clump(mesh, {.spheres = 0}), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, {.min_radius = 2, .max_radius = 1}), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, {.max_radius = 0}), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, {.max_protrusion = 0}), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, {.min_radius = -1}), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, {.density = 0}), std::invalid_argument);
  EXPECT_THROW(fit_clump(mesh, {.kind = ClumpKind::inner, .max_protrusion = 1}), std::invalid_argument);
  EXPECT_THROW(fit_clump(Mesh{}, {}), std::invalid_argument);
}

// What each format's reader does with a text, written from its rules and from nothing of ours.

struct Read {
  std::vector<Sphere> spheres;
  std::vector<double> inertia;
  double volume = 0, size = 0;
  std::string name;
};

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

double number(const std::string& word) {
  std::size_t used = 0;
  const double value = std::stod(word, &used);
  EXPECT_EQ(used, word.size()) << word;
  return value;
}

/// A line is cut at #, empty ones are skipped, then four numbers; &, $ and quotes would be read as something else.
Read read_liggghts(const std::string& text) {
  Read read;
  EXPECT_EQ(text.find_first_of("&$\"'"), std::string::npos);
  for (const std::string& line : lines_of(text)) {
    const std::vector<std::string> words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (words.size() != 4) throw std::runtime_error("not four numbers: " + line);
    read.spheres.push_back({{number(words[0]), number(words[1]), number(words[2])}, number(words[3])});
  }
  return read;
}

/// Lines that begin with # are skipped; the first word of any other is looked at, so none may be empty.
Read read_yade(const std::string& text) {
  Read read;
  for (const std::string& line : lines_of(text)) {
    const std::vector<std::string> words = words_of(line);
    if (words.at(0).at(0) == '#') continue;
    EXPECT_EQ(words.at(4), "0");
    read.spheres.push_back({{number(words[0]), number(words[1]), number(words[2])}, number(words[3])});
  }
  return read;
}

/// A header that names the columns, in any order; every other line has as many cells.
Read read_chrono(const std::string& text) {
  Read read;
  std::vector<std::string> header;
  for (const std::string& line : lines_of(text)) {
    std::istringstream stream(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (header.empty()) {
      header = cells;
      continue;
    }
    if (cells.size() != header.size()) throw std::runtime_error("columns");
    std::map<std::string, double> row;
    for (std::size_t i = 0; i < cells.size(); ++i) row[header[i]] = number(cells[i]);
    read.spheres.push_back({{row.at("x"), row.at("y"), row.at("z")}, row.at("r")});
  }
  return read;
}

/// A keyword begins a line; its value is on the next line that does not begin with //, whatever that is.
Read read_kratos(const std::string& text) {
  Read read;
  Vec3 center;
  const std::vector<std::string> lines = lines_of(text);
  std::size_t at = 0;
  const auto next = [&] {
    while (lines.at(at).rfind("//", 0) == 0) ++at;
    return words_of(lines.at(at++));
  };
  const auto begins = [](const std::string& line, const char* word) { return line.rfind(word, 0) == 0; };
  bool has_center = false;
  while (at < lines.size()) {
    const std::string line = lines[at++];
    if (begins(line, "//")) continue;
    if (begins(line, "Name")) read.name = next().at(0);
    if (begins(line, "Begin centers_and_radii")) {
      for (; !begins(lines.at(at), "End centers_and_radii"); ++at) {
        const std::vector<std::string> words = words_of(lines[at]);
        read.spheres.push_back({{number(words.at(0)), number(words.at(1)), number(words.at(2))}, number(words.at(3))});
      }
    }
    if (begins(line, "Particle_center_and_diameter")) {
      const std::vector<std::string> words = next();
      center = {number(words.at(0)), number(words.at(1)), number(words.at(2))};
      has_center = true;
    }
    if (begins(line, "Size")) read.size = number(next().at(0));
    if (begins(line, "Volume")) read.volume = number(next().at(0));
    if (begins(line, "Inertia per unit mass")) {
      for (int i = 0; i < 3; ++i) read.inertia.push_back(number(next().at(0)));
    }
  }
  EXPECT_TRUE(has_center);
  for (Sphere& s : read.spheres) s.center -= center;
  return read;
}

std::string text_of(const Clump& clump, const std::string& format, const std::string& name = "stone") {
  for (const ClumpFormat& known : clump_formats()) {
    if (known.name == format) return known.text(clump, name);
  }
  throw std::runtime_error("no format " + format);
}

class ClumpFiles : public testing::Test {
 protected:
  static const Clump& clump() {
    static const Clump made = [] {
      Mesh mesh = sample_body("limb", 16);
      const RigidTransform pose = RigidTransform::from_axis({3, 1, 2}, 0.5, {10, -20, 30});
      for (Vec3& p : mesh.positions) p = pose(p);
      ClumpOptions options = quick(ClumpKind::cover, 7);
      options.density = 2650;
      return fit_clump(mesh, options);
    }();
    return made;
  }
  static void expect_about_center(const std::vector<Sphere>& read) {
    ASSERT_EQ(read.size(), clump().spheres.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].center, clump().spheres[i].center - clump().solid.center);
      EXPECT_EQ(read[i].radius, clump().spheres[i].radius);
    }
  }
  /// In principal axes: the union's mass, asked anew, must lie at the origin with a diagonal tensor.
  static void expect_principal(const std::vector<Sphere>& read) {
    ASSERT_EQ(read.size(), clump().spheres.size());
    const UnionMass mass = converged_union_mass(read).solid;
    EXPECT_NEAR(mass.volume, clump().solid.volume, 5e-4 * mass.volume);
    EXPECT_LT(length(mass.center), 1e-3);
    for (const std::size_t mixed : {1, 2, 4}) EXPECT_NEAR(mass.inertia[mixed], 0, 2e-3 * mass.inertia[5]);
    const std::array<std::size_t, 3> diagonal{0, 3, 5};
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(mass.inertia[diagonal[static_cast<std::size_t>(axis)]], clump().principal_inertia[axis],
                  2e-3 * mass.inertia[5]);
    }
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].radius, clump().spheres[i].radius);
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_NEAR(distance(read[i].center, read[k].center),
                    distance(clump().spheres[i].center, clump().spheres[k].center), 1e-12);
      }
    }
  }
};

TEST_F(ClumpFiles, liggghts_reads_spheres_about_the_center_of_mass) {
  const std::string text = text_of(clump(), "liggghts");
  expect_about_center(read_liggghts(text).spheres);
  EXPECT_NE(text.find("nspheres 7 mass "), std::string::npos);
}

TEST_F(ClumpFiles, yade_reads_one_clump_about_the_center_of_mass) {
  expect_about_center(read_yade(text_of(clump(), "yade")).spheres);
}

TEST_F(ClumpFiles, chrono_reads_principal_axes) {
  expect_principal(read_chrono(text_of(clump(), "chrono")).spheres);
}

TEST_F(ClumpFiles, kratos_reads_principal_axes_volume_and_inertia) {
  const Read read = read_kratos(text_of(clump(), "kratos", "my stone"));
  expect_principal(read.spheres);
  EXPECT_EQ(read.name, "my_stone");
  EXPECT_EQ(read.volume, clump().solid.volume);
  ASSERT_EQ(read.inertia.size(), 3u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(read.inertia[static_cast<std::size_t>(axis)] * read.volume, clump().principal_inertia[axis],
                1e-12 * clump().principal_inertia[axis]);
  }
  double reach = 0;
  for (const Sphere& s : read.spheres) reach = std::max(reach, length(s.center) + s.radius);
  EXPECT_NEAR(read.size, 2 * reach, 1e-12 * reach);
}

}  // namespace
}  // namespace morula
