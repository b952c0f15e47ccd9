// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions, modes, their coordinates, point caches, and files of balls and spheres. The first byte says which, the
// others are the file: a .npy, .pc2 or .mdd, or a folder's files one after another, or the numbers that are written.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>

#include "fuzz.hpp"
#include "io/byte_reader.hpp"
#include "io/mesh/formats.hpp"
#include "io/motion/array_motion.hpp"
#include "io/motion/point_cache.hpp"
#include "specimens.hpp"

namespace morula::fuzz {
using namespace detail;
namespace {

constexpr const char* name_of(std::size_t what) {
  return what == 4 ? "motion.pc2" : what == 5 ? "motion.mdd" : "array.npy";
}

const test::ScratchFolder& scratch() {
  static const test::ScratchFolder folder;
  return folder;
}

void read_motion(const ByteSource& source) {
  const std::size_t vertices = specimen_mesh().vertex_count();
  const NpyArray array = motion_array(source, vertices);
  for (std::size_t i = 0; i < std::min<std::size_t>(array.shape[0], 8); ++i) {
    const std::vector<Vec3> positions = motion_frame(source, array, vertices, i);
    require(positions.size() == vertices, "a frame has another number of vertices");
    for (const Vec3& p : positions) require(is_finite(p), "a frame was read that is not finite");
  }
}

void read_modal_model(const ByteSource& source) {
  const Modes modes = modes_of(source, specimen_mesh());
  require(modes.displacements.size() == modes.mode_count * modes.vertex_count, "modes have other sizes than they say");
  for (const Vec3& u : modes.displacements) require(is_finite(u), "modes were read that are not finite");
}

void read_modal_coordinates(const ByteSource& source) {
  const ModalCoordinates motion = coordinates_of(source, 2);
  require(motion.frame_count() * motion.mode_count == motion.coordinates.size(), "coordinates of half a frame");
  for (const double q : motion.coordinates) require(std::isfinite(q), "coordinates were read that are not finite");
}

void read_point_cache(const ByteSource& source) {
  const std::shared_ptr<const FrameSource> cache = open_point_cache(source, specimen_mesh());
  require(cache->frame_count() > 0, "a point cache without frames was opened");
  require(cache->vertex_count() == specimen_mesh().vertex_count(), "a point cache of another mesh was opened");
  const std::size_t last = cache->frame_count() - 1;
  for (std::size_t i = 0; i <= last; i += std::max<std::size_t>(1, last / 7)) {
    const std::vector<Vec3> positions = cache->frame(i);
    require(positions.size() == cache->vertex_count(), "a frame has another number of vertices");
    for (const Vec3& p : positions) require(is_finite(p), "a frame was read that is not finite");
  }
}

// PATTERN '\x1f' NAME '\x1f' CONTENTS '\x1e' NAME …: at most four files; the pattern x means the folder itself.
void read_folder(std::string_view bytes) {
  scratch().clear();
  const auto part = [&](char end) {
    const std::size_t length = std::min(bytes.find(end), bytes.size());
    const std::string_view text = bytes.substr(0, length);
    bytes.remove_prefix(std::min(length + 1, bytes.size()));
    return text;
  };
  const auto plain = [](std::string name) {
    // A message repeats the name, as it is.
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || static_cast<unsigned char>(c) < ' '; }, '_');
    if (name.size() > 100) name.resize(100);
    return name.empty() || name == "." || name == ".." ? "x" + name : name;
  };
  const std::string pattern = plain(std::string(part('\x1f')));
  for (int n = 0; n < 4 && !bytes.empty(); ++n) {
    const std::string name = plain(std::string(part('\x1f')));
    scratch().file(name, part('\x1e'));
  }
  const Motion motion(pattern == "x" ? scratch().path() : scratch().path() / pattern, specimen_mesh());
  for (std::size_t i = 0; i < motion.frame_count(); ++i) {
    require(!motion.frame_name(i).empty(), "a frame without a name");
    for (const Vec3& p : motion.frame(i)) require(is_finite(p), "a frame was read that is not finite");
  }
}

// Numbers of any kind are written so that they read back, or refused.
void write_balls_and_spheres(Bytes in) {
  std::vector<Sphere> balls(in.below(20));
  for (Sphere& s : balls) s = {{in.float64(), in.float64(), in.float64()}, in.float64()};
  const std::filesystem::path path = scratch().path() / "balls.ply";
  try {
    write_balls(path, balls);
  } catch (const std::invalid_argument&) {
    return;
  }
  const std::string bytes = test::bytes_of(path);
  MeshReading reading;
  const Mesh mesh = read_ply(path, bytes, reading);
  require(mesh.vertex_count() == balls.size(), "balls that were written read back as another number");
  for (std::size_t i = 0; i < balls.size(); ++i)
    require(std::memcmp(&mesh.positions[i], &balls[i].center, sizeof(Vec3)) == 0, "a ball read back elsewhere");

  SphereTree tree;
  tree.append_level({}, std::array{Sphere{{0, 0, 0}, 1}});
  if (balls.empty()) return;
  SphereFramesWriter writer(scratch().path() / "spheres.npz", tree, balls.size());
  for (const Sphere& s : balls) writer.write(std::span(&s, 1));
  writer.finish();
  // The first file of the archive is the array, as it is.
  const std::string archive = test::bytes_of(scratch().path() / "spheres.npz");
  const std::string_view name = "spheres.npy";
  const std::string_view rest = std::string_view(archive).substr(30 + name.size());
  for (std::size_t i = 0; i < balls.size(); ++i)
    require(load<double>(rest.data() + 128 + i * sizeof(Sphere)) == balls[i].center.x,
            "a sphere was written elsewhere");
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace morula::fuzz;
  Bytes in(data, size);
  const std::size_t what = in.below(7);
  if (what == 0) {
    write_balls_and_spheres(in);
    return 0;
  }
  const MemoryMeter memory;
  try {
    const morula::detail::ByteSource source(name_of(what), in.rest());
    if (what == 1) read_motion(source);
    if (what == 2) read_modal_model(source);
    if (what == 3) read_modal_coordinates(source);
    if (what == 4 || what == 5) read_point_cache(source);
    if (what == 6) read_folder(in.rest());
  } catch (const morula::FileError& error) {
    require_good_message(error.what(), what == 6 ? scratch().path().string() : name_of(what));
  }
  memory.require_modest(size);
  return 0;
}
