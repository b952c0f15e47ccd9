// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/gltf/accessors.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "io/byte_reader.hpp"
#include "parallel/interruption.hpp"

namespace morula::gltf {
using namespace detail;
namespace {

std::size_t width_of(int type) {
  return type == TINYGLTF_TYPE_SCALAR ? 1 : type == TINYGLTF_TYPE_VEC3 ? 3 : type == TINYGLTF_TYPE_VEC4 ? 4 : 16;
}

// Counts and offsets are signed in tinygltf before 2.9.
template <class Number>
bool is_negative(Number number) {
  if constexpr (std::is_signed_v<Number>) return number < 0;
  return false;
}

}  // namespace

double Accessors::Strided::number(std::size_t i, std::size_t k, bool normalized) const {
  const char* const at = reinterpret_cast<const char*>(first + i * stride + k * size);
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized ? std::max(load<std::int8_t>(at) / 127.0, -1.0) : load<std::int8_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<std::uint8_t>(at) / (normalized ? 255.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? std::max(load<std::int16_t>(at) / 32767.0, -1.0) : load<std::int16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(at) / (normalized ? 65535.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(at);
    default:
      return static_cast<double>(load<float>(at));
  }
}

std::vector<double> Accessors::numbers(int index, int type, const std::string& owner) const {
  const morula_tinygltf::Accessor& a = at(index, owner);
  if (a.type != type) document_.fail(owner + " has an accessor of another type than it needs");
  const std::size_t width = width_of(type);
  std::vector<double> values;
  // The limit counts numbers, because the same bytes may be read many times, and sparse accessors have numbers without
  // bytes.
  if (a.count > (most_numbers_ - numbers_) / width)
    document_.fail(owner + " brings more numbers than a file of this size can mean");
  numbers_ += a.count * width;
  if (a.bufferView >= 0) {
    const Strided from = strided(a.bufferView, a.byteOffset, a.componentType, width, a.count, true, owner);
    values.reserve(a.count * width);
    InterruptPoller poll_interrupt(1u << 14);
    for (std::size_t i = 0; i < a.count; ++i) {
      poll_interrupt();
      for (std::size_t k = 0; k < width; ++k) values.push_back(from.number(i, k, a.normalized));
    }
  } else {
    resize_interruptibly(values, a.count * width);
  }
  if (a.sparse.isSparse) replace_sparse(a, width, values, owner);
  InterruptPoller poll_interrupt(1u << 16);
  for (const double value : values) {
    poll_interrupt();
    if (!std::isfinite(value)) document_.fail(owner + " has a number that is not finite");
  }
  return values;
}

std::vector<Vec3> Accessors::vectors(int index, const std::string& owner) const {
  const std::vector<double> values = numbers(index, TINYGLTF_TYPE_VEC3, owner);
  std::vector<Vec3> vectors;
  vectors.reserve(values.size() / 3);
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t i = 0; i < values.size(); i += 3) {
    poll_interrupt();
    vectors.push_back({values[i], values[i + 1], values[i + 2]});
  }
  return vectors;
}

std::vector<std::uint32_t> Accessors::indices(int index, int type, const std::string& owner) const {
  const morula_tinygltf::Accessor& a = at(index, owner);
  if (a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    document_.fail(owner + " has numbers that are no unsigned integers");
  std::vector<std::uint32_t> result;
  if (a.normalized) document_.fail(owner + " has normalized numbers, which are no indices");
  const std::vector<double> values = numbers(index, type, owner);
  result.reserve(values.size());
  InterruptPoller poll_interrupt(1u << 16);
  for (const double value : values) {
    poll_interrupt();
    result.push_back(static_cast<std::uint32_t>(value));
  }
  return result;
}

const morula_tinygltf::Accessor& Accessors::at(int index, const std::string& owner) const {
  if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size())
    document_.fail(owner + " refers to accessor " + std::to_string(index) + " of " +
                   std::to_string(model_.accessors.size()));
  return model_.accessors[static_cast<std::size_t>(index)];
}

std::size_t Accessors::size_of(int type, const std::string& owner) const {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      document_.fail(owner + " has numbers of a type that glTF does not know");
  }
}

Accessors::Strided Accessors::strided(int view_index, std::uint64_t offset, int type, std::size_t width,
                                      std::uint64_t count, bool may_have_stride, const std::string& owner) const {
  if (view_index < 0 || static_cast<std::size_t>(view_index) >= model_.bufferViews.size())
    document_.fail(owner + " refers to buffer view " + std::to_string(view_index) + " of " +
                   std::to_string(model_.bufferViews.size()));
  const morula_tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(view_index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
    document_.fail(owner + " refers to buffer " + std::to_string(view.buffer) + " of " +
                   std::to_string(model_.buffers.size()));
  const std::vector<unsigned char>& buffer = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
  const std::size_t size = size_of(type, owner);
  const std::uint64_t group = size * width;
  const std::uint64_t stride = may_have_stride && view.byteStride != 0 ? view.byteStride : group;
  const std::uint64_t length = view.byteLength;
  if (stride < group) document_.fail(owner + " has groups of numbers that overlap: its stride is too short");
  // The comparison cannot overflow.
  const bool view_fits = view.byteOffset <= buffer.size() && length <= buffer.size() - view.byteOffset;
  const bool fits =
      view_fits &&
      (count == 0 || (offset <= length && group <= length - offset && count - 1 <= (length - offset - group) / stride));
  if (!fits) document_.fail(owner + " lies outside its buffer; it was cut short, or its counts are wrong");
  return {buffer.data() + view.byteOffset + (count == 0 ? 0 : offset), static_cast<std::size_t>(stride), type, size};
}

void Accessors::replace_sparse(const morula_tinygltf::Accessor& a, std::size_t width, std::vector<double>& values,
                               const std::string& owner) const {
  if (is_negative(a.sparse.count) || is_negative(a.sparse.indices.byteOffset) ||
      is_negative(a.sparse.values.byteOffset))
    document_.fail(owner + " has a negative count or offset");
  const int type = a.sparse.indices.componentType;
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    document_.fail(owner + " has sparse indices that are no unsigned integers");
  const auto count = static_cast<std::uint64_t>(a.sparse.count);
  const Strided where = strided(a.sparse.indices.bufferView, static_cast<std::uint64_t>(a.sparse.indices.byteOffset),
                                type, 1, count, false, owner);
  const Strided from = strided(a.sparse.values.bufferView, static_cast<std::uint64_t>(a.sparse.values.byteOffset),
                               a.componentType, width, count, false, owner);
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t i = 0; i < count; ++i) {
    poll_interrupt();
    const auto target = static_cast<std::size_t>(where.number(i, 0, false));
    if (target >= a.count)
      document_.fail(owner + " replaces number " + std::to_string(target) + " of " + std::to_string(a.count));
    for (std::size_t k = 0; k < width; ++k) values[target * width + k] = from.number(i, k, a.normalized);
  }
}

}  // namespace morula::gltf
