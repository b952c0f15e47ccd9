// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <support/meshes.hpp>

namespace morula::test {

namespace fs = std::filesystem;

void expect_file_error(const fs::path& path, std::size_t line, const std::string& fragment,
                       const std::function<void()>& action) {
  try {
    action();
    ADD_FAILURE() << path << " was accepted";
  } catch (const FileError& error) {
    const std::string what = error.what();
    const std::string start = path.string() + ":" + (line > 0 ? std::to_string(line) + ": " : " ");
    EXPECT_EQ(what.substr(0, start.size()), start) << what;
    EXPECT_NE(what.find(fragment), what.npos) << what << "\ndoes not say: " << fragment;
  } catch (const std::exception& error) {
    ADD_FAILURE() << path << ": not a FileError: " << error.what();
  }
}

std::vector<double> awkward_numbers() {
  using limits = std::numeric_limits<double>;
  return {0.0,
          -0.0,
          1.0,
          0.1,
          -1.0 / 3,
          limits::max(),
          limits::lowest(),
          limits::min(),
          -limits::denorm_min(),
          std::nextafter(1.0, 2.0),
          1e22,
          123456789012345678.0,
          6.02214076e23,
          std::nextafter(1e-5, 1.0)};
}

Mesh awkward_mesh() {
  Mesh mesh = box_mesh({-0.0, -1.0 / 3, 1e-300}, {0.1, std::nextafter(1.0, 2.0), 1234567.890123456}, 2);
  const std::vector<double> numbers = awkward_numbers();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    mesh.positions.push_back({numbers[i], numbers[(i + 1) % numbers.size()], numbers[(i + 2) % numbers.size()]});
  // Unused at the front too: indices have to be kept.
  mesh.positions.insert(mesh.positions.begin(), Vec3{7, 8, 9});
  for (Facet& f : mesh.facets) f = {f[0] + 1, f[1] + 1, f[2] + 1};
  return mesh;
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same_bits(const Mesh& a, const Mesh& b) {
  // == takes −0 for 0; the hash does not.
  return a.positions == b.positions && a.facets == b.facets && mesh_hash(a) == mesh_hash(b);
}

bool same_bits(const SphereTree& a, const SphereTree& b) {
  return a.spheres == b.spheres && a.first_child == b.first_child && a.child_count == b.child_count &&
         a.parent == b.parent && a.level_begin == b.level_begin && a.branching == b.branching && a.nested == b.nested &&
         tree_hash(a) == tree_hash(b);
}

bool same_bits(const Cover& a, const Cover& b) {
  for (std::size_t i = 0; i < std::min(a.cut_points.size(), b.cut_points.size()); ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (!same_bits(a.cut_points[i].weight[k], b.cut_points[i].weight[k])) return false;
  return a.vertex_count == b.vertex_count && a.facet_count == b.facet_count && a.cut_points == b.cut_points &&
         a.patch_facet == b.patch_facet && a.corner_begin == b.corner_begin && a.corners == b.corners &&
         a.region_begin == b.region_begin && a.region_end == b.region_end;
}

bool same_bits(const BuildReport& a, const BuildReport& b) {
  if (a.growth.size() != b.growth.size()) return false;
  for (std::size_t i = 0; i < a.growth.size(); ++i)
    if (a.growth[i].grown != b.growth[i].grown || !same_bits(a.growth[i].largest_factor, b.growth[i].largest_factor) ||
        !same_bits(a.growth[i].largest_growth, b.growth[i].largest_growth))
      return false;
  return a.method == b.method && a.branching == b.branching && a.depth == b.depth && a.seed == b.seed &&
         a.mesh_hash == b.mesh_hash && a.early_leaves == b.early_leaves && a.leftover_patches == b.leftover_patches &&
         a.dropped_spheres == b.dropped_spheres && a.notes == b.notes;
}

void expect_all_refused(const std::vector<HostileFile>& files,
                        const std::function<void(const std::filesystem::path&)>& read) {
  const ScratchFolder folder;
  for (const HostileFile& hostile : files) {
    SCOPED_TRACE(hostile.name + ": " + hostile.bytes.substr(0, 200));
    const std::filesystem::path path = folder.file(hostile.name, hostile.bytes);
    expect_file_error(path, hostile.line, hostile.fragment, [&] { read(path); });
  }
}

const Mesh& one_facet() {
  static const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  return mesh;
}

Mesh small_mesh() {
  return box_mesh({-1, -1, -1}, {1, 1, 1}, 3);
}

CoveredTree small_built(const Mesh& mesh) {
  SphereTree tree;
  tree.append_level({}, std::vector<Sphere>{{{-0.0, 0, 0}, 1.75}});
  std::vector<Sphere> octants;
  for (int k = 0; k < 8; ++k) octants.push_back({{k & 1 ? 0.5 : -0.5, k & 2 ? 0.5 : -0.5, k & 4 ? 0.5 : -0.5}, 0.9});
  tree.append_level(std::vector<std::uint32_t>{8}, octants);
  tree.append_level(std::vector<std::uint32_t>{0, 0, 0, 2, 0, 0, 0, 0},
                    std::vector<Sphere>{{{0.5, 0.5, -0.8}, 0.75}, {{0.5, 0.5, -0.2}, 0.75}});
  return cover(mesh, tree);
}

CommaLocale::CommaLocale() {
  struct Commas : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  before_ = std::locale::global(std::locale(std::locale::classic(), new Commas));
}

std::string resealed(std::string morula) {
  const std::string size = raw(std::uint64_t{morula.size()});
  morula.replace(16, 8, size);
  std::uint64_t fnv1a = 0xcbf29ce484222325u;
  for (std::size_t i = 0; i + 8 < morula.size(); ++i)
    fnv1a = (fnv1a ^ static_cast<unsigned char>(morula[i])) * 0x100000001b3u;
  return morula.replace(morula.size() - 8, 8, raw(fnv1a));
}

}  // namespace morula::test
