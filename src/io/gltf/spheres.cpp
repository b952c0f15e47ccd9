// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <morula/geometry/mesh.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/whole_output.hpp>
#include <stdexcept>

#include "io/byte_reader.hpp"
#include "io/number_text.hpp"
#include "platform/path_text.hpp"

namespace morula {
namespace detail {
namespace {

/// An icosahedron whose facets are cut into four twice, with corners on the unit sphere and outward facets.
Mesh unit_ball() {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  Mesh ball{{{-1, g, 0},
             {1, g, 0},
             {-1, -g, 0},
             {1, -g, 0},
             {0, -1, g},
             {0, 1, g},
             {0, -1, -g},
             {0, 1, -g},
             {g, 0, -1},
             {g, 0, 1},
             {-g, 0, -1},
             {-g, 0, 1}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (Vec3& p : ball.positions) p = normalized(p);
  for (int round = 0; round < 2; ++round) {
    std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(ball.vertex_count()));
      if (is_new) ball.positions.push_back(normalized(ball.positions[a] + ball.positions[b]));
      return entry->second;
    };
    std::vector<Facet> facets;
    for (const Facet& f : ball.facets) {
      const std::uint32_t ab = middle(f[0], f[1]), bc = middle(f[1], f[2]), ca = middle(f[2], f[0]);
      for (const Facet& part : {Facet{f[0], ab, ca}, Facet{f[1], bc, ab}, Facet{f[2], ca, bc}, Facet{ab, bc, ca}}) {
        facets.push_back(part);
      }
    }
    ball.facets = std::move(facets);
  }
  return ball;
}

std::string numbers(std::span<const double> values) {
  std::string text = "[";
  for (const double value : values) {
    if (text.size() > 1) text += ',';
    append_number(text, static_cast<float>(value));
  }
  return text + ']';
}

/// A binary chunk and the accessors of its data.
class Chunk {
 public:
  std::size_t begin(std::size_t count, std::string_view type, int component, const std::string& bounds = {}) {
    accessors_ += (accessors_.empty() ? "" : ",") + std::string("{\"bufferView\":0,\"byteOffset\":") +
                  std::to_string(bytes.size()) + ",\"componentType\":" + std::to_string(component) +
                  ",\"count\":" + std::to_string(count) + ",\"type\":\"" + std::string(type) + "\"" + bounds + "}";
    return count_++;
  }
  const std::string& accessors() const { return accessors_; }

  std::string bytes;

 private:
  std::string accessors_;
  std::size_t count_ = 0;
};

constexpr int float_type = 5126, short_type = 5123;

void store_vector(std::string& bytes, const Vec3& v) {
  for (int axis = 0; axis < 3; ++axis) store(bytes, static_cast<float>(v[axis]));
}

constexpr std::uint64_t most_bytes = std::uint64_t{1} << 31;

void require_writable(const std::filesystem::path& path, std::span<const std::vector<Sphere>> frames,
                      double frames_per_second) {
  if (frames.empty() || frames[0].empty()) throw std::invalid_argument("there are no spheres to write");
  if (!(frames_per_second > 0 && std::isfinite(frames_per_second)))
    throw std::invalid_argument("frames_per_second is not above 0");
  const std::size_t count = frames[0].size();
  for (const std::vector<Sphere>& frame : frames) {
    if (frame.size() != count) throw std::invalid_argument("frames have different numbers of spheres");
    for (const Sphere& s : frame)
      if (!(std::max(max_norm(s.center), s.radius) <= static_cast<double>(std::numeric_limits<float>::max())) ||
          !is_finite(s.center))
        throw std::invalid_argument("a sphere has a number that no float holds");
  }
  if (frames.size() > most_bytes / (24 * std::uint64_t{count} + 4))
    throw FileError(platform::text_of(path) + ": " + std::to_string(frames.size()) + " frames of " +
                    std::to_string(count) + " spheres do not fit into 2 GiB; write fewer frames, or a coarser level");
}

/// The nodes of all spheres, as JSON, and the animation of these nodes if there are several frames.
struct Nodes {
  std::string nodes, roots, samplers, channels;
};

Nodes add_nodes(Chunk& chunk, std::span<const std::vector<Sphere>> frames, double frames_per_second) {
  Nodes made;
  std::size_t times = 0;
  const bool moves = frames.size() > 1;
  if (moves) {
    const std::array last{static_cast<double>(frames.size() - 1) / frames_per_second};
    times = chunk.begin(frames.size(), "SCALAR", float_type, ",\"min\":[0],\"max\":" + numbers(last));
    for (std::size_t f = 0; f < frames.size(); ++f)
      store(chunk.bytes, static_cast<float>(static_cast<double>(f) / frames_per_second));
  }
  for (std::size_t i = 0; i < frames[0].size(); ++i) {
    const Sphere& s = frames[0][i];
    const std::string comma = i == 0 ? "" : ",";
    made.nodes += comma + "{\"name\":\"sphere " + std::to_string(i) +
                  "\",\"mesh\":0,\"translation\":" + numbers(std::array{s.center.x, s.center.y, s.center.z}) +
                  ",\"scale\":" + numbers(std::array{s.radius, s.radius, s.radius}) + "}";
    made.roots += comma + std::to_string(i);
    if (!moves) continue;
    const auto animate = [&](const char* what, std::size_t sampler, const auto& value) {
      const std::size_t output = chunk.begin(frames.size(), "VEC3", float_type);
      for (const std::vector<Sphere>& frame : frames) store_vector(chunk.bytes, value(frame[i]));
      made.samplers += (sampler == 0 ? "" : ",") + std::string("{\"input\":") + std::to_string(times) +
                       ",\"output\":" + std::to_string(output) + ",\"interpolation\":\"LINEAR\"}";
      made.channels += (sampler == 0 ? "" : ",") + std::string("{\"sampler\":") + std::to_string(sampler) +
                       ",\"target\":{\"node\":" + std::to_string(i) + ",\"path\":\"" + what + "\"}}";
    };
    animate("translation", 2 * i, [](const Sphere& sphere) { return sphere.center; });
    animate("scale", 2 * i + 1, [](const Sphere& sphere) { return Vec3{sphere.radius, sphere.radius, sphere.radius}; });
  }
  return made;
}

/// A .glb of two chunks. Throws FileError if it would be too large.
std::string glb(const std::filesystem::path& path, const std::string& json, const std::string& binary) {
  const std::uint64_t size = 12 + 8 + json.size() + 8 + binary.size();
  if (size > most_bytes) throw FileError(platform::text_of(path) + ": would be larger than 2 GiB; write fewer frames");
  std::string file = "glTF";
  store(file, std::uint32_t{2});
  store(file, static_cast<std::uint32_t>(size));
  store(file, static_cast<std::uint32_t>(json.size()));
  file += "JSON" + json;
  store(file, static_cast<std::uint32_t>(binary.size()));
  return file + std::string("BIN\0", 4) + binary;
}

}  // namespace
}  // namespace detail

using namespace detail;

void write_gltf_spheres(const std::filesystem::path& path, std::span<const std::vector<Sphere>> frames,
                        double frames_per_second) {
  require_writable(path, frames, frames_per_second);
  Chunk chunk;
  const Mesh ball = unit_ball();
  const std::size_t positions =
      chunk.begin(ball.vertex_count(), "VEC3", float_type, ",\"min\":[-1,-1,-1],\"max\":[1,1,1]");
  for (const Vec3& p : ball.positions) store_vector(chunk.bytes, p);
  const std::size_t indices = chunk.begin(3 * ball.facet_count(), "SCALAR", short_type);
  for (const Facet& f : ball.facets)
    for (const std::uint32_t v : f) store(chunk.bytes, static_cast<std::uint16_t>(v));

  const Nodes made = add_nodes(chunk, frames, frames_per_second);
  chunk.bytes.resize((chunk.bytes.size() + 3) / 4 * 4, '\0');

  std::string json =
      "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Morula\"},\"scene\":0,\"scenes\":[{\"nodes\":[" + made.roots +
      "]}],\"nodes\":[" + made.nodes +
      "],\"meshes\":[{\"name\":\"ball\",\"primitives\":[{\"attributes\":{\"POSITION\":" + std::to_string(positions) +
      ",\"NORMAL\":" + std::to_string(positions) + "},\"indices\":" + std::to_string(indices) + "}]}],";
  if (frames.size() > 1)
    json += "\"animations\":[{\"name\":\"motion\",\"samplers\":[" + made.samplers + "],\"channels\":[" + made.channels +
            "]}],";
  json += "\"accessors\":[" + chunk.accessors() +
          "],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,\"byteLength\":" + std::to_string(chunk.bytes.size()) +
          "}],\"buffers\":[{\"byteLength\":" + std::to_string(chunk.bytes.size()) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  write_whole(path, glb(path, json, chunk.bytes));
}

}  // namespace morula
