// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/motion/point_cache.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/byte_reader.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

constexpr std::string_view pc2_mark("POINTCACHE2\0", 12);
constexpr double frames_per_second = 30;

class PointCache final : public FrameSource {
 public:
  PointCache(ByteSource source, const MeshView& mesh)
      : source_(std::move(source)),
        facets_(mesh.facets.begin(), mesh.facets.end()),
        vertex_count_(mesh.vertex_count()) {
    const bool is_pc2 = lower_extension(source_.name()) == ".pc2";
    const std::uint64_t size = source_.size();
    const std::uint64_t header = is_pc2 ? 32 : 8;
    if (size < header) fail("the file ends inside its header; it was cut short");
    const std::string bytes = source_.read(0, header);
    std::uint64_t points = 0;
    if (is_pc2) {
      if (bytes.substr(0, pc2_mark.size()) != pc2_mark) fail("a point cache begins with 'POINTCACHE2'");
      if (const auto version = load<std::int32_t>(bytes.data() + 12); version != 1)
        fail("version " + std::to_string(version) + " is not read; write version 1");
      order_ = std::endian::little;
      points = count(bytes, 16, "points");
      frame_count_ = count(bytes, 28, "frames");
      begin_ = header;
    } else {
      order_ = std::endian::big;
      frame_count_ = count(bytes, 0, "frames");
      points = count(bytes, 4, "points");
      begin_ = header + 4 * std::uint64_t{frame_count_};  // the time of every frame
    }
    if (frame_count_ == 0) fail("the cache has no frames");
    if (points != vertex_count_)
      fail("the cache has " + std::to_string(points) + " points, but the mesh has " + std::to_string(vertex_count_) +
           " vertices");
    // Both are below 2³¹, so no product overflows: 2⁶⁵ bytes would need more frames than the size test allows.
    const std::uint64_t frame_bytes = 12 * std::uint64_t{vertex_count_};
    if (size < begin_ || (size - begin_) / frame_bytes != frame_count_ || (size - begin_) % frame_bytes != 0)
      fail("counts " + std::to_string(frame_count_) + " frames of " + std::to_string(points) + " points, but has " +
           std::to_string(size) + " bytes; it was cut short, or its counts are wrong");
  }
  std::size_t frame_count() const override { return frame_count_; }
  const std::vector<Facet>& facets() const override { return facets_; }
  std::size_t vertex_count() const override { return vertex_count_; }
  std::vector<Vec3> frame(std::size_t i) const override {
    const std::uint64_t frame_bytes = 12 * std::uint64_t{vertex_count_};
    const std::string bytes = source_.read(begin_ + i * frame_bytes, frame_bytes);
    std::vector<Vec3> positions(vertex_count_);
    InterruptPoller poll_interrupt(1u << 16);
    for (std::size_t v = 0; v < vertex_count_; ++v) {
      poll_interrupt();
      for (int axis = 0; axis < 3; ++axis)
        positions[v][axis] = load<float>(bytes.data() + 12 * v + 4 * static_cast<std::size_t>(axis), order_);
      if (!is_finite(positions[v]))
        fail("frame " + std::to_string(i) + ": vertex " + std::to_string(v) +
             " has a coordinate that is not finite; repair it where the cache was made");
    }
    return positions;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw FileError(platform::text_of(source_.name()) + ": " + problem);
  }
  std::uint32_t count(const std::string& bytes, std::size_t at, const char* what) const {
    const auto value = load<std::int32_t>(bytes.data() + at, order_);
    if (value < 0) fail("has " + std::to_string(value) + " " + what + ", less than none");
    return static_cast<std::uint32_t>(value);
  }

  ByteSource source_;
  std::vector<Facet> facets_;
  std::size_t vertex_count_;
  std::size_t frame_count_ = 0;
  std::uint64_t begin_ = 0;
  std::endian order_ = std::endian::little;
};

template <class Value>
void store_big(std::string& bytes, Value value) {
  store(bytes, value);
  std::reverse(bytes.end() - static_cast<std::ptrdiff_t>(sizeof value), bytes.end());
}

}  // namespace

bool is_point_cache(std::string_view extension) {
  return extension == ".pc2" || extension == ".mdd";
}

std::shared_ptr<const FrameSource> open_point_cache(const ByteSource& source, const MeshView& mesh) {
  return std::make_shared<PointCache>(source, mesh);
}

std::string point_cache_start(std::string_view extension, std::size_t vertex_count, std::size_t frame_count) {
  constexpr std::size_t most = std::numeric_limits<std::int32_t>::max();
  if (vertex_count > most || frame_count > most)
    throw std::invalid_argument("a point cache holds no more than 2147483647 vertices and frames");
  const auto points = static_cast<std::int32_t>(vertex_count), frames = static_cast<std::int32_t>(frame_count);
  std::string bytes;
  if (extension == ".pc2") {
    bytes = pc2_mark;
    store(bytes, std::int32_t{1});
    store(bytes, points);
    store(bytes, 0.0f);  // the first frame
    store(bytes, 1.0f);  // frames from one to the next
    store(bytes, frames);
    return bytes;
  }
  store_big(bytes, frames);
  store_big(bytes, points);
  for (std::size_t i = 0; i < frame_count; ++i)
    store_big(bytes, static_cast<float>(static_cast<double>(i) / frames_per_second));
  return bytes;
}

void append_point_cache_frame(std::string& bytes, std::string_view extension, std::span<const Vec3> positions) {
  InterruptPoller poll_interrupt(1u << 16);
  for (const Vec3& p : positions) {
    poll_interrupt();
    if (max_norm(p) > static_cast<double>(std::numeric_limits<float>::max()))
      throw std::invalid_argument("a coordinate is too large for the single precision of a point cache; write .npy");
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = static_cast<float>(p[axis]);
      extension == ".pc2" ? store(bytes, value) : store_big(bytes, value);
    }
  }
}

}  // namespace morula::detail
