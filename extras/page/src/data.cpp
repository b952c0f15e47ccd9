// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "data.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace morula::page {
namespace {

constexpr double last_place = 65535.0;

std::int32_t place(double value, double origin, double step) {
  const double steps = (value - origin) / step;
  return std::isfinite(steps) ? static_cast<std::int32_t>(std::lround(std::clamp(steps, 0.0, last_place))) : 0;
}

}  // namespace

std::array<std::int32_t, 3> Quantization::operator()(const Vec3& p) const {
  return {place(p.x, origin.x, step.x), place(p.y, origin.y, step.y), place(p.z, origin.z, step.z)};
}

Quantization quantization(std::span<const Facet> facets, std::span<const std::vector<Vec3>> frames) {
  Box box;
  for (const std::vector<Vec3>& frame : frames) {
    for (const Facet& facet : facets) {
      for (const std::uint32_t vertex : facet) box.add(frame[vertex]);
    }
  }
  const auto step = [](double low, double high) { return high > low ? (high - low) / last_place : 1.0; };
  return {box.lower, {step(box.lower.x, box.upper.x), step(box.lower.y, box.upper.y), step(box.lower.z, box.upper.z)}};
}

void PackedBytes::add_varint(std::int64_t value) {
  std::uint64_t rest = (static_cast<std::uint64_t>(value) << 1) ^ (value < 0 ? ~std::uint64_t{0} : 0);
  for (; rest >= 0x80; rest >>= 7) bytes_ += static_cast<char>((rest & 0x7f) | 0x80);
  bytes_ += static_cast<char>(rest);
}

void PackedBytes::add_float(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  for (unsigned shift = 0; shift < 32; shift += 8) bytes_ += static_cast<char>((bits >> shift) & 0xff);
}

void PackedBytes::add_uint16(std::uint16_t value) {
  bytes_ += static_cast<char>(value & 0xff);
  bytes_ += static_cast<char>(value >> 8);
}

void pack_facets(PackedBytes& out, std::span<const Facet> facets) {
  std::int64_t previous = 0;
  for (const Facet& facet : facets) {
    out.add_varint(static_cast<std::int64_t>(facet[0]) - previous);
    out.add_varint(static_cast<std::int64_t>(facet[1]) - facet[0]);
    out.add_varint(static_cast<std::int64_t>(facet[2]) - facet[0]);
    previous = facet[0];
  }
}

void pack_positions(PackedBytes& out, const Quantization& grid, std::span<const std::vector<Vec3>> frames) {
  if (frames.empty()) return;
  std::vector<std::array<std::int32_t, 3>> last(frames.front().size(), std::array<std::int32_t, 3>{});
  for (const std::vector<Vec3>& frame : frames) {
    std::array<std::int32_t, 3> moved_before{};
    for (std::size_t vertex = 0; vertex < frame.size(); ++vertex) {
      const std::array<std::int32_t, 3> now = grid(frame[vertex]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t moved = now[axis] - last[vertex][axis];
        out.add_varint(moved - moved_before[axis]);
        moved_before[axis] = moved;
      }
      last[vertex] = now;
    }
  }
}

void pack_spheres(PackedBytes& out, const Vec3& origin, std::span<const Sphere> spheres) {
  for (const Sphere& sphere : spheres) {
    const Vec3 center = sphere.center - origin;
    for (const double value : {center.x, center.y, center.z, sphere.radius}) out.add_float(static_cast<float>(value));
  }
}

void pack_contacts(PackedBytes& out, const Vec3& origin, std::span<const PageContact> contacts) {
  for (const PageContact& contact : contacts) {
    const Vec3 p = contact.point - origin, n = contact.normal;
    for (const double value : {p.x, p.y, p.z, n.x, n.y, n.z, contact.depth}) out.add_float(static_cast<float>(value));
  }
}

void pack_patches(PackedBytes& out, const Vec3& origin, const PagePatches& patches) {
  for (const PagePatches::Patch& patch : patches.patches)
    for (const PagePatchFacet& part : patch.facets) {
      out.add_uint16(static_cast<std::uint16_t>(part.facet & 0xffffu));
      out.add_uint16(static_cast<std::uint16_t>(part.facet >> 16));
      out.add_uint16(static_cast<std::uint16_t>(std::lround(std::clamp(part.share, 0.0, 1.0) * 65535)));
    }
  for (const std::array<Vec3, 2>& segment : patches.curves)
    for (const Vec3& end : segment) {
      const Vec3 p = end - origin;
      for (const double value : {p.x, p.y, p.z}) out.add_float(static_cast<float>(value));
    }
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::uint32_t checksum(std::string_view bytes) {
  std::uint32_t state = 0x811c9dc5u;
  for (const char byte : bytes) state = (state ^ static_cast<unsigned char>(byte)) * 0x01000193u;
  return state;
}

}  // namespace morula::page
