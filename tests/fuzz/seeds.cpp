// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Writes the first inputs of every fuzzer, made of samples: fuzz_seeds FOLDER gives FOLDER/meshes/…, FOLDER/trees/….
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/spheres_file.hpp>
#include <string>
#include <support/scratch_folder.hpp>

#include "../io/gltf_files.hpp"
#include "../io/solid_files.hpp"
#include "io/array/npy.hpp"
#include "io/byte_reader.hpp"
#include "io/mesh/formats.hpp"
#include "io/motion/point_cache.hpp"
#include "io/tree/formats.hpp"
#include "small_bodies.hpp"
#include "specimens.hpp"

namespace morula::fuzz {
using namespace detail;
namespace {

namespace fs = std::filesystem;

class Seeds {
 public:
  Seeds(const fs::path& folder, const char* name, int first = 0) : folder_(folder / name), count_(first) {
    fs::create_directories(folder_);
  }
  fs::path scratch(const char* name) const { return folder_ / name; }
  void add(const std::string& bytes) {
    const std::string number = std::to_string(count_++);
    std::ofstream(folder_ / (std::string(3 - std::min<std::size_t>(3, number.size()), '0') + number), std::ios::binary)
        << bytes;
  }

 private:
  fs::path folder_;
  int count_;
};

std::string big_endian(auto value) {
  std::string bytes;
  store(bytes, value);
  return {bytes.rbegin(), bytes.rend()};
}

void add_meshes(Seeds seeds) {
  for (const test::GltfMaker& file : {test::tetrahedron(), test::bending_arm()}) {
    seeds.add("4" + file.text());
    seeds.add("5" + file.glb());
  }
  Mesh bar = sample_body("bar", 3);
  bar.facets.resize(24);
  for (const Mesh& mesh : {specimen_mesh(), bar}) {
    std::size_t format = '0';
    for (const char* const extension : {".obj", ".off", ".ply"})
      seeds.add(static_cast<char>(format++) + mesh_bytes(extension, mesh));
    std::string text = "2ply\nformat ascii 1.0\ncomment x\nelement vertex " + std::to_string(mesh.vertex_count()) +
                       "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                       std::to_string(mesh.facet_count()) +
                       "\nproperty uchar red\nproperty list uchar int vertex_indices\nend_header\n";
    std::string big = "2ply\nformat binary_big_endian 1.0\nelement vertex " + std::to_string(mesh.vertex_count()) +
                      "\nproperty double x\nproperty float y\nproperty double z\nelement face " +
                      std::to_string(mesh.facet_count()) + "\nproperty list ushort short vertex_index\nend_header\n";
    std::string solid = "3solid a\n", binary = "3" + std::string(80, ' ');
    store(binary, static_cast<std::uint32_t>(mesh.facet_count()));
    const auto line = [](const Vec3& p) {
      return std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    };
    for (const Vec3& p : mesh.positions) {
      text += line(p);
      big += big_endian(p.x) + big_endian(static_cast<float>(p.y)) + big_endian(p.z);
    }
    for (const Facet& f : mesh.facets) {
      text += "255 3";
      big += big_endian(std::uint16_t{3});
      solid += "facet normal 0 0 1\nouter loop\n";
      binary += std::string(12, '\0');
      for (const std::uint32_t v : f) {
        text += " " + std::to_string(v);
        big += big_endian(static_cast<std::int16_t>(v));
        solid += "vertex " + line(mesh.positions[v]);
        for (int axis = 0; axis < 3; ++axis) store(binary, static_cast<float>(mesh.positions[v][axis]));
      }
      text += "\n";
      solid += "endloop\nendfacet\n";
      binary += "xx";
    }
    for (const std::string& bytes : {text, big, solid + "endsolid a\n", binary}) seeds.add(bytes);
  }
  seeds.add("0v 0 0 0 1\nv +1 0 0\nv 1 \\\n1 0\nv 0 1 0 # c\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1 3//1 -1\n");
  // Concave polygons, one that crosses itself, one that touches itself; faces before their vertices.
  seeds.add(
      "0f 2 3 4 1\nf 1 3 2 4\nf 1 2 3 4 1 5 6 7\nv 0 0 0\nv 4 0 0\nv 4 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n");
  seeds.add("0v 0 0 0\rv 1 0 0\rv 0 1 0\rfo 1 2 3\rsurf 0 1 0 1 1\rcall x\rF 1 2 3\r");
  seeds.add("1OFF 4 1\n6\n0 0\n0\n1 0 0 1 1 0\n0 1 0\n4 0 1\n2 3\n");
  seeds.add("1OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2");
  seeds.add(
      "2ply\rformat ascii 1.0\relement vertex 4\rproperty float x\rproperty float y\rproperty float z\relement "
      "tristrips "
      "1\rproperty list int int vertex_indices\rend_header\r0 0 0\r1 0 0\r1 1 0\r0 1 0\r8 0 1 3 2 -1 0 1 2\r");
  seeds.add("3\xef\xbb\xbfsolid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nend loop\nend facet\n");
  seeds.add("3" + stl_bytes(specimen_mesh()) + std::string(3, '\0'));
  test::GltfMaker extended = test::tetrahedron();
  extended.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", {{"TRANSLATION", 0}}}};
  extended.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
  seeds.add("4" + extended.text());
  for (const char* const foreign :
       {"version https://git-lfs.github.com/spec/v1\n", "<!-- --><html>", "\xff\xfev", "{\"asset\": 1}"})
    seeds.add(std::string("1") + foreign);
  seeds.add("1STCNOFF4 1 0\n0 0 0 1 1\n1 0 0 1 1\n1 1 0 1 1\n0 1 0 1 1\n4 0 1 2 3 255 0 0\n");
}

void add_solids(Seeds seeds) {
  const test::Solid solid = test::tetrahedral_cube(1);
  for (const bool binary : {false, true}) {
    seeds.add("6" + test::legacy_vtk(solid, binary));
    seeds.add("9" + test::gmsh_2(solid, binary));
    seeds.add("9" + test::gmsh_4(solid, binary));
    seeds.add("9" + test::gmsh_4_0(solid, binary));
  }
  seeds.add("8" + test::xml_vtu(solid));
  seeds.add("7" + mesh_bytes(".vtp", specimen_mesh()));
}

void add_trees(Seeds seeds) {
  for (const int branching : {2, 8}) {
    const CoveredTree model = build(specimen_mesh(), {.method = Method::octree, .branching = branching, .depth = 1});
    const std::string native = native_bytes(model), text = sph_text("a.sph", model.tree),
                      json = json_tree_text(model.tree);
    for (const char* const bases : {"0123", "4567"}) {
      seeds.add(bases[0] + native);
      seeds.add(bases[1] + native);
      seeds.add(bases[2] + text);
      seeds.add(bases[3] + json);
      const fs::path archive = seeds.scratch("tree.npz"), balls = seeds.scratch("balls.ply");
      write_tree(archive, model.tree);
      write_balls(balls, model.tree.spheres);
      seeds.add(bases[3] + test::bytes_of(archive));
      seeds.add(bases[3] + test::bytes_of(balls));
      fs::remove(archive);
      fs::remove(balls);
    }
  }
}

void add_arrays(Seeds seeds) {
  const std::array<double, 24> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.5, 0, 0, 1, 1, 1, 2, 1, 0, 0, 3, 1};
  const std::string motion = npy_bytes(numbers, std::array<std::size_t, 3>{2, 4, 3});
  // A digit says what it is, modulo 7: "2" is 1, a motion.
  seeds.add("2" + motion);
  seeds.add("3" + motion);
  seeds.add("4" + npy_bytes(numbers, std::array<std::size_t, 2>{12, 2}));
  std::string floats = npy_start("<f4", std::array<std::size_t, 3>{1, 4, 3});
  for (std::size_t i = 0; i < 12; ++i) store(floats, static_cast<float>(numbers[i]));
  seeds.add("2" + floats);
  const Mesh& mesh = specimen_mesh();
  for (const auto& [digit, extension] : {std::pair("5", ".pc2"), std::pair("6", ".mdd")}) {
    for (const std::size_t frames : {1u, 3u}) {
      std::string cache = digit + point_cache_start(extension, mesh.vertex_count(), frames);
      for (std::size_t i = 0; i < frames; ++i) append_point_cache_frame(cache, extension, mesh.positions);
      seeds.add(cache);
    }
  }
  const std::string obj = mesh_bytes(".obj", mesh);
  seeds.add(
      "0x\x1f"
      "frame10.obj\x1f" +
      obj +
      "\x1e"
      "frame9.obj\x1f" +
      obj);
  seeds.add(
      "0frame*.o?j\x1f"
      "frame010.obj\x1f" +
      obj +
      "\x1e"
      "frame10.obj\x1f" +
      obj +
      "\x1e"
      ".hidden.obj\x1f" +
      obj);
  std::string balls = "1\x03";
  for (std::size_t i = 0; i < 12; ++i) store(balls, numbers[i]);
  seeds.add(balls);
}

void add_command_lines(Seeds seeds) {
  for (const char* const words :
       {"build t.obj -o o.morula",
        "build t.obj -o o.sph --method grid --branching 4 --depth 2 --json",
        "build t.obj -o o.json --method medial --reducers merge,expand --optimizer simplex --seed 3 --report",
        "build t.obj -o o.ply --spheres 9 --quality fast --threads 2",
        "build t.obj -o o.morula --max-protrusion 0.5",
        "build t.obj -o o.morula --time-limit 1 --optimizer balance --balance-excess 0.1 --method spawn",
        "measure t.obj t.morula",
        "measure t.obj t.morula --json --grid 32",
        "measure t.obj m --motion m",
        "deform t.obj -o d --bend 90 --frames 3",
        "deform t.obj -o d.npy --twist 45 --stretch 2 --axis x --one-way",
        "deform t.obj -o e --poke --poke-center 0,0,1 --noise 0.1 --noise-wavelength 0.3 --rotate 30 --format ply",
        "update t.obj t.morula m -o s",
        "update t.obj t.morula m -o s.npz --rule 0:exact,1:approach2 --measure",
        "update t.obj t.morula --modes u.npy --coords q.npy -o s.npz --modal-bound shift --rule modal",
        "update t.obj t.morula m -o s --rule weighted --conservative --distance-floor 0.25",
        "collide t.obj t.obj --crossings --budget 10",
        "collide t.obj t.obj --motion-a m --translate-b 0,0.8,0 --budget 200us",
        "view t.obj t.morula m -o v.html",
        "medial t.obj -o b.ply",
        "info t.obj --json",
        "info t.morula --check --mesh t.obj",
        "convert t.morula c.sph",
        "convert t.morula c.json",
        "convert t.obj c.off",
        "sample limb -o l.obj --resolution 9",
        "demo",
        "study -o y",
        "--help",
        "build --help",
        "--version",
        "bild t.obj",
        "build t.obj --metod grid -o x.sph",
        "convert c.sph c.morula --mesh t.obj --sph-origin bbox-center",
        "measure t.obj t.morula --csv o.csv"}) {
    std::string text(words);
    for (char& c : text)
      if (c == ' ') c = '\n';
    seeds.add("0" + text);
    seeds.add("1" + text);
  }
}

std::vector<Mesh> small_meshes() {
  std::vector<Mesh> meshes{specimen_mesh()};
  // A cube whose sides are cut alike, an octahedron, a prism, a plate with two sides, an edge and a point as facets.
  meshes.push_back({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
                    {Facet{0, 2, 1}, Facet{0, 3, 2}, Facet{4, 5, 6}, Facet{4, 6, 7}, Facet{0, 1, 5}, Facet{0, 5, 4},
                     Facet{1, 2, 6}, Facet{1, 6, 5}, Facet{2, 3, 7}, Facet{2, 7, 6}, Facet{3, 0, 4}, Facet{3, 4, 7}}});
  meshes.push_back({{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                    {Facet{0, 2, 4}, Facet{2, 1, 4}, Facet{1, 3, 4}, Facet{3, 0, 4}, Facet{2, 0, 5}, Facet{1, 2, 5},
                     Facet{3, 1, 5}, Facet{0, 3, 5}}});
  meshes.push_back({{{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {0, 0, 1}, {2, 0, 1}, {1, 2, 1}},
                    {Facet{0, 2, 1}, Facet{3, 4, 5}, Facet{0, 1, 4}, Facet{0, 4, 3}, Facet{1, 2, 5}, Facet{1, 5, 4},
                     Facet{2, 0, 3}, Facet{2, 3, 5}}});
  meshes.push_back({{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}},
                    {Facet{0, 1, 4}, Facet{1, 2, 4}, Facet{2, 3, 4}, Facet{3, 0, 4}, Facet{0, 4, 1}, Facet{1, 4, 2}}});
  meshes.push_back({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {Facet{0, 1, 2}, Facet{0, 1, 1}, Facet{3, 3, 3}}});
  Mesh bar = sample_body("bar", 3);
  if (bar.vertex_count() > 32) {
    std::erase_if(bar.facets, [](const Facet& f) { return f[0] >= 32 || f[1] >= 32 || f[2] >= 32; });
    bar.positions.resize(32);
  }
  meshes.push_back(bar);
  return meshes;
}

std::string random_bytes(Random& random, std::size_t count) {
  std::string bytes;
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(random.next());
  return bytes;
}

// The options of build.cpp: method, branching, depth, kind, quality, optimizer, seed; reducers for two methods.
void add_builds(Seeds seeds) {
  for (const Mesh& mesh : small_meshes())
    for (unsigned method = 0; method < all_methods().size(); ++method) {
      std::string options{static_cast<char>(method), 2, 2, 0, 0, 0, 1};
      if (all_methods()[method] == Method::medial) options += '\0';
      if (all_methods()[method] == Method::combined) options += std::string{0, 2};
      seeds.add(options + bytes_of(mesh));
    }
  Random random(1);
  for (int i = 0; i < 20; ++i) seeds.add(random_bytes(random, 120));
}

// Two sides of body.cpp and what happens to them.
void add_bodies(Seeds seeds) {
  Random random(2);
  const std::vector<Mesh> meshes = small_meshes();
  for (const Mesh& mesh : meshes)
    for (unsigned rules = 0; rules < 4; ++rules) {
      std::string a{static_cast<char>(rules), 6, 2, static_cast<char>(rules)};
      if (rules > 0) a += random_bytes(random, rules + 1);
      const std::string b{0, 6, 2};
      seeds.add(a + bytes_of(mesh) + b + bytes_of(meshes[random.next() % meshes.size()]) + random_bytes(random, 60));
    }
}

// The kinds of both bodies of patches.cpp, and how their vertices move.
void add_patches(Seeds seeds) {
  Random random(3);
  for (unsigned a = 0; a < 5; ++a)
    for (unsigned b = 0; b < 5; ++b) {
      const std::string kinds{static_cast<char>(a), static_cast<char>(b)};
      seeds.add(kinds + std::string(12, '\4'));
      for (int i = 0; i < 8; ++i) seeds.add(kinds + random_bytes(random, 60));
    }
}

/// The robots of the library's own tests. Their meshes are not there, so those that need some are refused, until damage
/// takes the need away.
void add_robots(Seeds seeds) {
  for (const char* name : {"arm_description/urdf/arm.urdf", "arm_description/mjcf/arm.xml",
                           "arm_description/sdf/arm.sdf", "gripper_description/urdf/gripper.urdf",
                           "gripper_description/mjcf/gripper.xml", "gripper_description/sdf/gripper.sdf"}) {
    seeds.add(test::bytes_of(fs::path(MORULA_ROBOTS) / name));
  }
  seeds.add("d" + test::bytes_of(fs::path(MORULA_ROBOTS) / "arm_description/meshes/wrist.dae"));
  seeds.add(
      "<mujoco><default><geom size='1'/><default class='c'><joint type='slide' range='0 "
      "1'/></default></default><worldbody>"
      "<body name='a' euler='1 2 3'><geom/><joint pos='1 0 0' ref='1'/><frame pos='1 0 0'><joint class='c'/>"
      "<body childclass='c'><joint type='ball'/><geom type='box' size='1' fromto='0 0 0 1 2 3'/></body></frame>"
      "</body></worldbody></mujoco>");
}

}  // namespace
}  // namespace morula::fuzz

int main(int argc, char** argv) {
  using namespace morula::fuzz;
  if (argc != 2) {
    std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  add_meshes({folder, "meshes"});
  add_solids({folder, "meshes", 100});
  add_trees({folder, "trees"});
  add_arrays({folder, "arrays"});
  add_command_lines({folder, "command"});
  add_builds({folder, "build"});
  add_bodies({folder, "body"});
  add_patches({folder, "patches"});
  add_robots({folder, "robots"});
  return 0;
}
