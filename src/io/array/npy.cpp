// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/array/npy.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <morula/io/mesh_file.hpp>
#include <numeric>
#include <optional>
#include <vector>

#include "io/byte_reader.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

constexpr std::string_view npy_magic = "\x93NUMPY";

// The header is a Python dictionary of three entries, such as
// {'descr': '<f4', 'fortran_order': False, 'shape': (25, 100, 3), }
struct Dictionary {
  std::string descr, fortran_order, shape;  // as written, quotes and brackets included
};

class DictionaryParser {
 public:
  DictionaryParser(const std::string& file, std::string_view text) : file_(file), text_(text) {}

  Dictionary parse() {
    Dictionary result;
    take('{');
    while (!next_is('}')) {
      const std::string key = value();
      take(':');
      std::string* const place = key == "'descr'"           ? &result.descr
                                 : key == "'fortran_order'" ? &result.fortran_order
                                 : key == "'shape'"         ? &result.shape
                                                            : nullptr;
      if (!place) fail();
      *place = value();
      if (!next_is('}')) take(',');
    }
    return result;
  }

 private:
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  bool next_is(char c) {
    skip_blanks();
    return at_ < text_.size() && text_[at_] == c;
  }
  void take(char c) {
    if (!next_is(c)) fail();
    ++at_;
  }
  // A quoted string, a bracketed list or a word; double quotes become single ones.
  std::string value() {
    skip_blanks();
    const std::size_t begin = at_;
    int depth = 0;
    char quote = 0;
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (quote) {
        if (c == quote) quote = 0;
      } else if (c == '\'' || c == '"') {
        quote = c;
      } else if (c == '(' || c == '[') {
        ++depth;
      } else if (depth > 0 && (c == ')' || c == ']')) {
        --depth;
      } else if (depth == 0 && (c == ',' || c == ':' || c == '}' || c == ' ' || c == '\n')) {
        break;
      }
    }
    if (at_ == begin || quote || depth > 0) fail();
    std::string result(text_.substr(begin, at_ - begin));
    std::replace(result.begin(), result.end(), '"', '\'');
    return result;
  }
  [[noreturn]] void fail() const {
    throw FileError(file_ + ": the .npy header " + in_quotes(text_) + " is malformed; save the array again");
  }

  const std::string& file_;
  std::string_view text_;
  std::size_t at_ = 0;
};

// The numbers of a tuple; none if it holds other text. Python 2 wrote 25L for 25.
std::vector<std::uint64_t> tuple(std::string_view text) {
  std::vector<std::uint64_t> numbers;
  if (text.size() < 2 || text.front() != '(' || text.back() != ')') return {};
  text = text.substr(1, text.size() - 2);
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (text.empty()) return numbers;
    std::uint64_t number = 0;
    const std::from_chars_result parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    if (parsed.ec != std::errc()) return {};
    text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
    if (!text.empty() && text[0] == 'L') text.remove_prefix(1);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (!text.empty() && text[0] != ',') return {};
    if (!text.empty()) text.remove_prefix(1);
    numbers.push_back(number);
  }
}

// Whether the product of the shape is `count`. It divides instead of multiplying, so that no number overflows.
bool holds(const std::vector<std::uint64_t>& shape, std::uint64_t count) {
  if (std::count(shape.begin(), shape.end(), std::uint64_t{0}) > 0) return count == 0;
  for (const std::uint64_t size : shape) {
    if (count % size != 0) return false;
    count /= size;
  }
  return count == 1;
}

struct TypeName {
  NpyType type;
  std::string_view descr;
  bool is_integer;
};
constexpr std::array type_names{
    TypeName{NpyType::float32, "'<f4'", false}, TypeName{NpyType::float64, "'<f8'", false},
    TypeName{NpyType::int32, "'<i4'", true},    TypeName{NpyType::uint32, "'<u4'", true},
    TypeName{NpyType::int64, "'<i8'", true},    TypeName{NpyType::uint64, "'<u8'", true},
};

std::optional<NpyType> type_of(std::string_view descr, bool integers) {
  for (const TypeName& name : type_names)
    if (name.descr == descr && name.is_integer == integers) return name.type;
  return std::nullopt;
}

// The order of axes that gives these sizes, as text for NumPy: ".transpose(0, 2, 1)". Empty if no order does, or if the
// axes are in that order already. Reshaping such an array would scramble its numbers.
std::string transposition(const std::vector<std::uint64_t>& shape, const std::vector<std::uint64_t>& sizes) {
  if (shape.size() != sizes.size() || shape.size() < 2) return {};
  std::vector<std::size_t> axes(shape.size());
  std::iota(axes.begin(), axes.end(), std::size_t{0});
  const auto fit = [&] {
    for (std::size_t i = 0; i < axes.size(); ++i)
      if (sizes[i] != 0 && shape[axes[i]] != sizes[i]) return false;
    return true;
  };
  if (fit()) return {};
  // Orders are tried in ascending order, so that the axes in front stay where they are if that is possible.
  while (std::next_permutation(axes.begin(), axes.end())) {
    if (!fit()) continue;
    if (axes.size() == 2) return ".T";
    std::string text = ".transpose(";
    for (std::size_t i = 0; i < axes.size(); ++i) text += (i > 0 ? ", " : "") + std::to_string(axes[i]);
    return text + ")";
  }
  return {};
}

void require_shape(const std::string& file, const NpyArray& array, const NpyShape& needed) {
  const auto but = [&](std::string_view words) {
    return file + ": the array's shape is " + array.shape_text + ", but " + std::string(words) + " is needed";
  };
  const std::string problem = but(needed.words);
  if (array.shape.size() != needed.sizes.size())
    throw FileError(problem + "; save an array with these axes, in this order");
  std::string line = transposition(array.shape, needed.sizes);
  const bool last_fits = needed.sizes.back() == 0 || array.shape.back() == needed.sizes.back();
  if (line.empty() && !last_fits) {
    // The array may belong to another mesh, but the last axis shows the order.
    std::vector<std::uint64_t> last(needed.sizes.size(), 0);
    last.back() = needed.sizes.back();
    line = transposition(array.shape, last);
    if (line.empty())
      throw FileError(but(needed.known_words.empty() ? needed.words : needed.known_words) +
                      "; save an array with these axes, in this order");
  }
  if (!line.empty())
    throw FileError(but(needed.known_words.empty() ? needed.words : needed.known_words) +
                    "; the axes are in another order, so transpose it: numpy.save(FILE, array" + line + ")");
}

template <class Value>
std::string array_bytes(std::string_view descr, std::span<const Value> values, std::span<const std::size_t> shape) {
  std::string bytes = npy_start(descr, shape);
  bytes.reserve(bytes.size() + values.size_bytes());
  InterruptPoller poll_interrupt(1u << 16);
  for (const Value value : values) {
    poll_interrupt();
    store(bytes, value);
  }
  return bytes;
}

struct Header {
  Dictionary dictionary;
  std::size_t data_offset;
};

Header read_header(const ByteSource& source) {
  const std::string file = platform::text_of(source.name());
  const std::uintmax_t size = source.size();
  constexpr std::size_t longest_start =
      12 + 65536;  // the limit of version 1; longer headers belong to tables with many columns
  const std::string start = source.read(0, std::min<std::uintmax_t>(size, longest_start));
  ByteReader in(source.name(), start, std::endian::little);
  if (start.substr(0, npy_magic.size()) != npy_magic) in.fail("not a NumPy file; write one with numpy.save");
  in.skip(npy_magic.size(), "the .npy header");
  const int version = in.read<std::uint8_t>("the .npy header");
  in.skip(1, "the .npy header");
  if (version < 1 || version > 3)
    in.fail("version " + std::to_string(version) + " of the .npy format is not read; 1, 2 and 3 are");
  const std::size_t length =
      version == 1 ? in.read<std::uint16_t>("the .npy header") : in.read<std::uint32_t>("the .npy header");
  const std::size_t begin = start.size() - in.bytes_left();
  in.skip(length, "the .npy header");
  const std::string_view text = std::string_view(start).substr(begin, length);
  return {DictionaryParser(file, text).parse(), begin + length};
}

}  // namespace

std::size_t npy_dimensions(const ByteSource& source) {
  return tuple(read_header(source).dictionary.shape).size();
}

NpyArray read_npy_header(const ByteSource& source, const NpyShape& needed) {
  const std::string file = platform::text_of(source.name());
  const auto [dictionary, data_offset] = read_header(source);
  NpyArray array;
  const std::optional<NpyType> type = type_of(dictionary.descr, needed.integers);
  if (!type)
    throw FileError(file + ": the array's type is " + in_quotes(dictionary.descr) +
                    (needed.integers ? ", but '<i4' or '<i8' is needed; save array.astype('<i4')"
                                     : ", but '<f4' or '<f8' is needed; save array.astype('<f8')"));
  array.type = *type;
  if (dictionary.fortran_order != "False")
    throw FileError(file + ": the array is in Fortran order; save numpy.ascontiguousarray(array)");
  array.shape = tuple(dictionary.shape);
  array.shape_text = in_quotes(dictionary.shape);
  require_shape(file, array, needed);
  array.data_offset = data_offset;

  const std::uint64_t data = source.size() - array.data_offset;
  if (data % array.scalar_size() != 0 || !holds(array.shape, data / array.scalar_size()))
    throw FileError(file + ": " + std::to_string(data) + " bytes follow the header, which is not what shape " +
                    array.shape_text + " takes; the file was cut short, or holds more than one array");
  return array;
}

std::vector<double> read_npy_values(const ByteSource& source, const NpyArray& array, std::uint64_t first,
                                    std::size_t count) {
  const std::size_t scalar = array.scalar_size();
  const std::string bytes = source.read(array.data_offset + first * scalar, count * scalar);
  std::vector<double> values;
  values.reserve(count);
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t i = 0; i < count; ++i) {
    poll_interrupt();
    const char* const at = bytes.data() + i * scalar;
    values.push_back(array.type == NpyType::float64 ? load<double>(at) : static_cast<double>(load<float>(at)));
  }
  return values;
}

std::vector<std::uint32_t> read_npy_indices(const ByteSource& source, const NpyArray& array, const std::string& what,
                                            bool minus_one_is_none) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  const std::string bytes = source.read(array.data_offset, source.size() - array.data_offset);
  const std::size_t scalar = array.scalar_size();
  std::vector<std::uint32_t> values(bytes.size() / scalar);
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t i = 0; i < values.size(); ++i) {
    poll_interrupt();
    const char* const at = bytes.data() + i * scalar;
    std::int64_t value = 0;
    if (array.type == NpyType::int32) value = load<std::int32_t>(at);
    if (array.type == NpyType::uint32) value = load<std::uint32_t>(at);
    if (array.type == NpyType::int64) value = load<std::int64_t>(at);
    if (array.type == NpyType::uint64)
      value = static_cast<std::int64_t>(std::min<std::uint64_t>(load<std::uint64_t>(at), std::uint64_t{1} << 62));
    if (value == -1 && minus_one_is_none) {
      values[i] = none;
    } else if (value < 0 || value >= none) {
      throw FileError(platform::text_of(source.name()) + ": number " + std::to_string(i) + " of " + what + " is " +
                      std::to_string(value) + ", which is no index");
    } else {
      values[i] = static_cast<std::uint32_t>(value);
    }
  }
  return values;
}

std::string npy_start(std::string_view descr, std::span<const std::size_t> shape) {
  std::string dictionary = "{'descr': '" + std::string(descr) + "', 'fortran_order': False, 'shape': (";
  for (std::size_t i = 0; i < shape.size(); ++i) dictionary += (i > 0 ? ", " : "") + std::to_string(shape[i]);
  dictionary += shape.size() == 1 ? ",), }" : "), }";
  // Blanks and a newline at the end bring the data to a multiple of 64 bytes, as the format requires.
  constexpr std::size_t before = 10;
  while ((before + dictionary.size() + 1) % 64 != 0) dictionary += ' ';
  dictionary += '\n';
  std::string bytes(npy_magic);
  bytes += '\x01';
  bytes += '\x00';
  store(bytes, static_cast<std::uint16_t>(dictionary.size()));
  return bytes + dictionary;
}

std::string npy_bytes(std::span<const double> values, std::span<const std::size_t> shape) {
  return array_bytes("<f8", values, shape);
}

std::string npy_bytes(std::span<const std::int32_t> values, std::span<const std::size_t> shape) {
  return array_bytes("<i4", values, shape);
}

}  // namespace morula::detail
