// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the native library computes, as hashes that web/tests/bits.test.js compares with those of the modules: one line
// "HASH NAME" per result. Both compute the same scenes by the C interface; this program with the compiler, the
// processor and the word size of this machine. usage: web_oracle            prints the lines
//        web_oracle --time     prints the least time of an update of limb:188 in milliseconds
#include <morula/morula.h>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace {

void must(morula_status status) {
  if (status == MORULA_OK) return;
  std::fprintf(stderr, "%s\n", morula_message());
  std::exit(1);
}

class Hash {
 public:
  Hash& add(const void* bytes, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i)
      value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3u;
    return *this;
  }
  template <class Number>
  Hash& add(const Number& number) {
    return add(&number, sizeof number);
  }
  void print(const std::string& name) const { std::printf("%016" PRIx64 " %s\n", value_, name.c_str()); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

struct Scene {
  morula_mesh* mesh = nullptr;
  morula_model* model = nullptr;
  morula_body* body = nullptr;
  std::size_t vertices = 0;
  std::vector<float> positions{};
};

Scene make(const char* name, int resolution, const char* method, const char* quality) {
  Scene scene;
  must(morula_mesh_sample(name, resolution, &scene.mesh));
  morula_build_options options;
  morula_build_options_init(&options);
  options.method = method, options.quality = quality, options.threads = 1;
  must(morula_build(scene.mesh, &options, &scene.model));
  must(morula_body_create(scene.mesh, scene.model, nullptr, &scene.body));
  scene.vertices = morula_mesh_vertex_count(scene.mesh);
  const double* rest = morula_mesh_positions(scene.mesh);
  scene.positions.assign(rest, rest + 3 * scene.vertices);
  return scene;
}

// Products and sums alone, so that every language computes the same numbers.
void bend(Scene& scene, double amount) {
  const double* rest = morula_mesh_positions(scene.mesh);
  for (std::size_t v = 0; v < scene.vertices; ++v) {
    const double x = rest[3 * v], y = rest[3 * v + 1], z = rest[3 * v + 2];
    scene.positions[3 * v] = static_cast<float>(x + 0.25 * amount * y);
    scene.positions[3 * v + 1] = static_cast<float>(y);
    scene.positions[3 * v + 2] = static_cast<float>(z + amount * x * x);
  }
  must(morula_body_update_float(scene.body, scene.positions.data(), scene.vertices, 0));
}

void print_tree(const std::string& name, const Scene& scene) {
  const std::size_t nodes = morula_model_node_count(scene.model);
  Hash()
      .add(morula_model_spheres(scene.model), nodes * sizeof(morula_sphere))
      .add(morula_model_first_child(scene.model), 4 * nodes)
      .print(name + " tree");
  std::size_t size = 0;
  must(morula_model_to_bytes(scene.model, nullptr, 0, &size));
  std::vector<char> bytes(size);
  must(morula_model_to_bytes(scene.model, bytes.data(), size, &size));
  Hash().add(bytes.data(), size).print(name + " file");
}

void print_updates(const std::string& name, Scene& scene) {
  Hash hash;
  std::vector<morula_sphere> spheres(morula_body_node_count(scene.body));
  for (const double amount : {0.0, 0.125, 0.5, -0.75}) {
    bend(scene, amount);
    must(morula_body_spheres(scene.body, spheres.data()));
    hash.add(spheres.data(), spheres.size() * sizeof(morula_sphere));
  }
  hash.print(name + " updates");
}

void print_rules(const std::string& name, const Scene& scene) {
  for (const char* rules :
       {"wrapped", "approach1", "approach2", "traditional", "weighted", "exact,approach2,wrapped"}) {
    morula_body_options options;
    morula_body_options_init(&options);
    options.rules = rules;
    options.conservative = 1;
    Scene other = scene;
    must(morula_body_create(scene.mesh, scene.model, &options, &other.body));
    print_updates(name + " " + rules, other);
    morula_body_destroy(other.body);
  }
}

void print_skinned(const std::string& name, const Scene& scene) {
  const double* rest = morula_mesh_positions(scene.mesh);
  std::vector<std::uint32_t> bones;
  std::vector<double> weights;
  for (std::size_t v = 0; v < scene.vertices; ++v) {
    bones.insert(bones.end(), {0, 1, 2});
    const double x = rest[3 * v], y = rest[3 * v + 1];
    weights.insert(weights.end(), {1 + x * x, 0.5 + y * y, x < 0 ? 0.0 : 0.25});
  }
  morula_skin* skin = nullptr;
  must(morula_skin_create(scene.vertices, 3, bones.data(), weights.data(), 3, &skin));
  morula_body_options options;
  morula_body_options_init(&options);
  options.rules = "skinned", options.skin = skin;
  morula_body* body = nullptr;
  must(morula_body_create(scene.mesh, scene.model, &options, &body));
  std::vector<morula_sphere> spheres(morula_body_node_count(body));
  Hash hash;
  for (int frame = 0; frame < 4; ++frame) {
    std::vector<double> transforms;
    for (int bone = 0; bone < 3; ++bone)
      for (int k = 0; k < 12; ++k) transforms.push_back((k % 5 == 0 ? 1 : 0) + 0.0625 * frame * (bone - k % 3));
    must(morula_body_update_skinned(body, transforms.data(), 3));
    must(morula_body_spheres(body, spheres.data()));
    hash.add(spheres.data(), spheres.size() * sizeof(morula_sphere));
  }
  hash.print(name + " skinned");
  morula_body_destroy(body);
  morula_skin_destroy(skin);
}

void print_pair(const std::string& name, Scene& a, Scene& b) {
  Hash contacts, crossings, distances;
  morula_contacts* list = nullptr;
  must(morula_contacts_create(&list));
  const double rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (int step = 0; step < 8; ++step) {
    bend(a, 0.0625 * step);
    bend(b, -0.0625 * step);
    const double translation[3] = {0.125 * step, 0.25, 0.1875 * step};
    must(morula_body_set_transform(b.body, rotation, translation));
    morula_contact_options options;
    morula_contact_options_init(&options);
    options.margin = 0.0625;
    if (step % 2 == 1) options.pair_tests = 40 * step;
    must(morula_collide(a.body, b.body, &options, list));
    const morula_contact* found = morula_contacts_data(list);
    for (std::size_t i = 0; i < morula_contacts_count(list); ++i)
      contacts.add(found[i].node_a).add(found[i].node_b).add(found[i].point).add(found[i].normal).add(found[i].depth);
    std::vector<std::uint32_t> pairs(1 << 18);
    std::size_t count = 0;
    must(morula_crossings(a.body, b.body, pairs.data(), pairs.size() / 2, &count));
    crossings.add(pairs.data(), 8 * count);
    morula_distance distance;
    must(morula_distance_of(a.body, b.body, &distance));
    distances.add(distance.lower).add(distance.upper).add(distance.point_a).add(distance.point_b);
  }
  contacts.print(name + " contacts");
  crossings.print(name + " crossings");
  distances.print(name + " distances");
  morula_contacts_destroy(list);
}

void print_points(const std::string& name, Scene& scene) {
  bend(scene, 0.25);
  std::vector<morula_ray> rays;
  std::vector<double> points;
  for (int i = 0; i < 64; ++i) {
    const double u = (i % 8 - 3.5) / 4, v = (i / 8 - 3.5) / 8;
    rays.push_back({{u, v, 4}, {0.0625 * v, 0.03125 * u, -1}, 1e300});
    points.insert(points.end(), {u, v, 0.25 * u * u});
  }
  std::vector<morula_ray_hit> hits(rays.size());
  must(morula_first_hits(scene.body, rays.data(), rays.size(), hits.data()));
  Hash hash;
  for (const morula_ray_hit& hit : hits)
    if (hit.facet != UINT32_MAX) hash.add(hit.facet).add(hit.t).add(hit.point).add(hit.normal);
  hash.print(name + " rays");
  std::vector<morula_location> places(rays.size());
  must(morula_locate(scene.body, points.data(), places.size(), places.data()));
  Hash inside;
  for (const morula_location& at : places) inside.add(at.inside).add(at.on_surface).add(at.winding);
  inside.print(name + " inside");
}

int time() {
  Scene scene = make("limb", 188, "octree", "default");
  double least = 1e300;
  for (int i = 0; i < 300; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    must(morula_body_update_float(scene.body, scene.positions.data(), scene.vertices, 0));
    least =
        std::min(least, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }
  std::printf("%.4f\n", least);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--time") == 0) return time();
  Scene limb = make("limb", 24, "octree", "default"), torus = make("torus", 16, "grid", "default");
  Scene blob = make("blob", 12, "optimized", "draft"), bar = make("bar", 8, "medial", "default");
  for (const auto& [name, scene] :
       {std::pair<const char*, Scene*>{"limb", &limb}, {"torus", &torus}, {"blob", &blob}, {"bar", &bar}}) {
    print_tree(name, *scene);
    print_updates(name, *scene);
  }
  print_rules("limb", limb);
  print_skinned("limb", limb);
  print_pair("limb and torus", limb, torus);
  print_points("torus", torus);
  return 0;
}
