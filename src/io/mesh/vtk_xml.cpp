// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// VTK's XML files, .vtp and .vtu: inline and appended, text, base64 and raw, plain or packed by zlib.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>

#include "io/array/inflate.hpp"
#include "io/byte_reader.hpp"
#include "io/mesh/cells.hpp"
#include "io/mesh/formats.hpp"
#include "io/paraview/vtp.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/decimal.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {
namespace {

constexpr std::string_view blanks = " \t\r\n";

/// A tag of the file.
struct Tag {
  std::string_view name;
  std::map<std::string_view, std::string_view> attributes;
  bool closes = false, empty = false;
  std::size_t begin = 0, end = 0;  // range of its text in the file
  std::string_view operator[](std::string_view key) const {
    const auto found = attributes.find(key);
    return found == attributes.end() ? std::string_view() : found->second;
  }
};

/// Tags one after the other: the part of XML that VTK writes, without entities and document types.
class Tags {
 public:
  Tags(std::filesystem::path path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {}

  [[noreturn]] void fail(const std::string& problem) const { fail_at(at_, problem); }
  [[noreturn]] void fail_at(std::size_t place, const std::string& problem) const {
    const std::string_view before = bytes_.substr(0, place);
    throw FileError(platform::text_of(path_) + ":" +
                    std::to_string(1 + std::count(before.begin(), before.end(), '\n')) + ": " + problem);
  }

  /// Returns false at the end of the file.
  bool next(Tag& tag) {
    for (;;) {
      at_ = bytes_.find('<', at_);
      if (at_ == bytes_.npos) {
        at_ = bytes_.size();
        return false;
      }
      if (skip("<!--", "-->") || skip("<?", "?>")) continue;
      if (bytes_.substr(at_, 2) == "<!") fail("document types and entities are not read; save the file without them");
      break;
    }
    tag = {};
    tag.begin = at_++;
    tag.closes = at_ < bytes_.size() && bytes_[at_] == '/';
    if (tag.closes) ++at_;
    tag.name = word();
    if (tag.name.empty()) fail("a tag has no name");
    for (;;) {
      step_over_blanks();
      if (at_ >= bytes_.size()) cut_short();
      if (bytes_[at_] == '>') break;
      if (bytes_[at_] == '/' && bytes_.substr(at_ + 1, 1) == ">") {
        tag.empty = true;
        ++at_;
        break;
      }
      const std::string_view key = word();
      step_over_blanks();
      if (key.empty() || at_ >= bytes_.size() || bytes_[at_] != '=') fail("a tag is not well formed");
      ++at_;
      step_over_blanks();
      const char quote = at_ < bytes_.size() ? bytes_[at_] : '\0';
      if (quote != '"' && quote != '\'') fail("the value of " + in_quotes(key) + " is not in quotes");
      const std::size_t close = bytes_.find(quote, at_ + 1);
      if (close == bytes_.npos) cut_short();
      tag.attributes[key] = bytes_.substr(at_ + 1, close - at_ - 1);
      at_ = close + 1;
    }
    tag.end = ++at_;
    return true;
  }
  /// The text between the tag and the next one.
  std::string_view text_after(const Tag& tag) const {
    return bytes_.substr(tag.end, std::min(bytes_.find('<', tag.end), bytes_.size()) - tag.end);
  }
  std::string_view rest_after(const Tag& tag) const { return bytes_.substr(tag.end); }
  [[noreturn]] void cut_short() const { fail_at(bytes_.size(), "the file ends inside a tag; it was cut short"); }

 private:
  void step_over_blanks() {
    while (at_ < bytes_.size() && blanks.find(bytes_[at_]) != blanks.npos) ++at_;
  }
  std::string_view word() {
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && blanks.find(bytes_[at_]) == blanks.npos && bytes_[at_] != '>' && bytes_[at_] != '/' &&
           bytes_[at_] != '=')
      ++at_;
    return bytes_.substr(begin, at_ - begin);
  }
  bool skip(std::string_view begin, std::string_view end) {
    if (bytes_.substr(at_, begin.size()) != begin) return false;
    const std::size_t found = bytes_.find(end, at_ + begin.size());
    if (found == bytes_.npos) cut_short();
    at_ = found + end.size();
    return true;
  }

  std::filesystem::path path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// Bytes of an array, raw or decoded from base64. Every four characters are decoded by themselves, so padding may occur
/// inside, as it does if a header and its data were encoded one after the other.
class Stream {
 public:
  Stream(std::string_view text, bool base64) : text_(text), base64_(base64) {}

  /// None if fewer bytes are left, or the text is no base64.
  std::optional<std::string> take(std::uint64_t count) {
    if (!base64_) {
      if (count > text_.size()) return std::nullopt;
      std::string bytes(text_.substr(0, static_cast<std::size_t>(count)));
      text_.remove_prefix(bytes.size());
      return bytes;
    }
    if (count > ready_.size() + text_.size()) return std::nullopt;
    while (ready_.size() < count) {
      if (!decode()) return std::nullopt;
    }
    std::string bytes = ready_.substr(0, static_cast<std::size_t>(count));
    ready_.erase(0, bytes.size());
    return bytes;
  }

 private:
  /// Decodes more bytes; returns false if there are none. Other arrays may follow in the same text, and then text that
  /// is no base64.
  bool decode() {
    check_interrupt();
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    // It decodes many groups at once, because each call moves the rest once.
    for (int groups = 0; groups < 4096; ++groups) {
      std::string_view ahead = text_;
      std::array<int, 4> values{};
      for (int& value : values) {
        while (!ahead.empty() && blanks.find(ahead[0]) != blanks.npos) ahead.remove_prefix(1);
        if (ahead.empty()) return groups > 0;
        const std::size_t found = alphabet.find(ahead[0]);
        if (found == alphabet.npos && ahead[0] != '=') return groups > 0;
        value = ahead[0] == '=' ? -1 : static_cast<int>(found);
        ahead.remove_prefix(1);
      }
      if (values[0] < 0 || values[1] < 0 || (values[2] < 0 && values[3] >= 0)) return groups > 0;
      text_ = ahead;
      const unsigned bits = static_cast<unsigned>(values[0]) << 18 | static_cast<unsigned>(values[1]) << 12 |
                            static_cast<unsigned>(std::max(0, values[2])) << 6 |
                            static_cast<unsigned>(std::max(0, values[3]));
      ready_ += static_cast<char>(bits >> 16);
      if (values[2] >= 0) ready_ += static_cast<char>(bits >> 8);
      if (values[3] >= 0) ready_ += static_cast<char>(bits);
    }
    return true;
  }

  std::string_view text_;
  bool base64_;
  std::string ready_;
};

enum class Kind { real, whole };

class XmlReader {
 public:
  XmlReader(const std::filesystem::path& path, std::string_view bytes, std::string_view type)
      : tags_(path, bytes), type_(type) {}

  Mesh read(MeshReading& reading) {
    Tag tag;
    if (!tags_.next(tag) || tag.name != "VTKFile" || tag.closes)
      tags_.fail("the file does not begin with <VTKFile>; legacy files end in .vtk");
    if (tag["type"] != type_)
      tags_.fail("holds " + in_quotes(tag["type"]) + ", not " + std::string(type_) + "; its extension should say so");
    read_how(tag);
    find_appended();
    while (tags_.next(tag)) {
      if (tag.name == "AppendedData") break;
      if (tag.closes) {
        if (tag.name == "Piece") finish_piece();
        if (tag.name == group_) group_ = {};
        if (tag.name == "VTKFile") break;
        continue;
      }
      if (tag.name == "Piece") {
        if (in_piece_) tags_.fail("a <Piece> inside a <Piece>");
        in_piece_ = true;
        arrays_.clear();
        point_count_ = count(tag, "NumberOfPoints");
        cell_count_ = tag["NumberOfCells"].empty() ? 0 : count(tag, "NumberOfCells");
        if (tag.empty) finish_piece();
      } else if (is_group(tag.name)) {
        group_ = tag.empty ? std::string_view() : tag.name;
      } else if (tag.name == "DataArray" && in_piece_ && !group_.empty()) {
        arrays_[std::string(group_) + "/" + (group_ == "Points" ? "" : std::string(tag["Name"]))] = tag;
      }
    }
    if (in_piece_) tags_.fail("the file ends inside a <Piece>; it was cut short");
    if (!has_piece_) tags_.fail("the file has no <Piece>; it was cut short");
    mesh_.facets = surface_.facets(mesh_.positions, reading);
    return std::move(mesh_);
  }

 private:
  static bool is_group(std::string_view name) {
    return name == "Points" || name == "Cells" || name == "Polys" || name == "Strips" || name == "Verts" ||
           name == "Lines";
  }

  void read_how(const Tag& tag) {
    const std::string_view order = tag["byte_order"], header = tag["header_type"], packer = tag["compressor"];
    if (order == "BigEndian") {
      order_ = std::endian::big;
    } else if (!order.empty() && order != "LittleEndian") {
      tags_.fail("byte order " + in_quotes(order) + " is not known");
    }
    if (header == "UInt64") {
      header_size_ = 8;
    } else if (!header.empty() && header != "UInt32") {
      tags_.fail("headers of type " + in_quotes(header) + " are not read");
    }
    is_packed_ = !packer.empty();
    if (is_packed_ && packer != "vtkZLibDataCompressor")
      tags_.fail("data packed by " + in_quotes(packer) + " are not read; save them with zlib or not packed");
  }

  /// Appended data come last, but earlier tags refer to them.
  void find_appended() {
    Tags ahead = tags_;
    Tag tag;
    while (ahead.next(tag)) {
      if (tag.name != "AppendedData" || tag.closes) continue;
      appended_base64_ = tag["encoding"] != "raw";
      const std::string_view rest = ahead.rest_after(tag);
      const std::size_t begin = rest.find_first_not_of(blanks);
      if (begin == rest.npos || rest[begin] != '_') ahead.fail("appended data do not begin with an underscore");
      appended_ = rest.substr(begin + 1);
      has_appended_ = true;
      return;
    }
  }

  std::uint64_t count(const Tag& tag, std::string_view key) const { return whole(tag, key, tag[key]); }
  std::uint64_t whole(const Tag& tag, std::string_view key, std::string_view text) const {
    std::uint64_t value = 0;
    while (!text.empty() && blanks.find(text.front()) != blanks.npos) text.remove_prefix(1);
    while (!text.empty() && blanks.find(text.back()) != blanks.npos) text.remove_suffix(1);
    const std::from_chars_result read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size())
      tags_.fail_at(tag.begin, std::string(key) + " is " + in_quotes(text) + ", not a number of things");
    return value;
  }

  /// The bytes of an array that is not text; `most`: the number of bytes that the caller needs at most.
  std::string bytes_of(const Tag& tag, std::uint64_t most) const {
    const std::string name = in_quotes(tag["Name"].empty() ? std::string_view("Points") : tag["Name"]);
    const auto damaged = [&](const std::string& how) { tags_.fail_at(tag.begin, "array " + name + ": " + how); };
    const bool is_appended = tag["format"] == "appended";
    std::string_view text = tags_.text_after(tag);
    if (is_appended) {
      if (!has_appended_) damaged("refers to appended data, but the file has none; it was cut short");
      const std::uint64_t offset = whole(tag, "the offset", tag["offset"]);
      if (offset > appended_.size()) damaged("begins after the end of the appended data; the file was cut short");
      text = appended_.substr(static_cast<std::size_t>(offset));
    }
    Stream stream(text, !is_appended || appended_base64_);
    const auto take = [&](std::uint64_t size) {
      std::optional<std::string> bytes = stream.take(size);
      if (!bytes) damaged("its data end too early, or are not of its encoding; the file was cut short");
      return std::move(*bytes);
    };
    const auto header = [&] {
      const std::string bytes = take(header_size_);
      return header_size_ == 8 ? load<std::uint64_t>(bytes.data(), order_)
                               : std::uint64_t{load<std::uint32_t>(bytes.data(), order_)};
    };
    if (!is_packed_) {
      const std::uint64_t size = header();
      if (size > most) damaged("has " + std::to_string(size) + " bytes, more than its " + std::to_string(most));
      return take(size);
    }
    const std::uint64_t blocks = header(), block_size = header(), last = header();
    if (blocks > text.size() / header_size_) damaged("claims " + std::to_string(blocks) + " packed blocks");
    std::vector<std::uint64_t> sizes;
    for (std::uint64_t i = 0; i < blocks; ++i) sizes.push_back(header());
    std::string bytes;
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t size = i + 1 == blocks && last != 0 ? last : block_size;
      if (size > most || bytes.size() > most - size) damaged("unpacks to more than its " + std::to_string(most));
      const std::optional<std::string> block = inflate_zlib(take(sizes[i]), static_cast<std::size_t>(size));
      if (!block) damaged("block " + std::to_string(i) + " of its packed data is damaged");
      bytes += *block;
    }
    return bytes;
  }

  template <class Value>
  void load_all(std::string_view bytes, std::vector<double>& values) const {
    InterruptPoller poll_interrupt(1u << 16);
    for (std::size_t at = 0; at + sizeof(Value) <= bytes.size(); at += sizeof(Value)) {
      poll_interrupt();
      values.push_back(static_cast<double>(load<Value>(bytes.data() + at, order_)));
    }
  }

  /// At most `most` numbers. Integers are below 2⁵³, or their users reject them.
  std::vector<double> numbers(const Tag& tag, std::uint64_t most) const {
    std::vector<double> values;
    const std::string name = in_quotes(tag["Name"].empty() ? std::string_view("Points") : tag["Name"]);
    if (tag["format"] == "ascii") {
      const std::string_view text = tags_.text_after(tag);
      InterruptPoller poll_interrupt(1u << 14);
      for (std::size_t at = 0;;) {
        poll_interrupt();
        at = text.find_first_not_of(blanks, at);
        if (at == text.npos) break;
        const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
        double value = 0;
        const std::from_chars_result read = platform::read_number(text.data() + at, text.data() + end, value);
        if (read.ec != std::errc() || read.ptr != text.data() + end)
          tags_.fail_at(tag.end + at, in_quotes(text.substr(at, end - at)) + " in array " + name + " is not a number");
        if (values.size() == most)
          tags_.fail_at(tag.begin, "array " + name + " has more than its " + std::to_string(most) + " numbers");
        values.push_back(value);
        at = end;
      }
      return values;
    }
    if (tag["format"] != "binary" && tag["format"] != "appended")
      tags_.fail_at(tag.begin, "array " + name + " is written as " + in_quotes(tag["format"]) + ", which is not read");
    const std::string_view type = tag["type"];
    constexpr std::uint64_t cap = std::numeric_limits<std::uint64_t>::max() / 8;
    const auto read = [&]<class Value>(Value) {
      load_all<Value>(bytes_of(tag, std::min(most, cap) * sizeof(Value)), values);
      return values;
    };
    if (type == "Float32") return read(float{});
    if (type == "Float64") return read(double{});
    if (type == "Int8") return read(std::int8_t{});
    if (type == "UInt8") return read(std::uint8_t{});
    if (type == "Int16") return read(std::int16_t{});
    if (type == "UInt16") return read(std::uint16_t{});
    if (type == "Int32") return read(std::int32_t{});
    if (type == "UInt32") return read(std::uint32_t{});
    if (type == "Int64") return read(std::int64_t{});
    if (type == "UInt64") return read(std::uint64_t{});
    tags_.fail_at(tag.begin, "array " + name + " has numbers of type " + in_quotes(type) + ", which are not read");
  }

  const Tag* array(const std::string& name) const {
    const auto found = arrays_.find(name);
    return found == arrays_.end() ? nullptr : &found->second;
  }

  void finish_piece() {
    if (!in_piece_) tags_.fail("</Piece> without <Piece>");
    in_piece_ = false;
    has_piece_ = true;
    const std::uint64_t first = mesh_.vertex_count();
    if (point_count_ > std::numeric_limits<std::uint32_t>::max() - first) tags_.fail("more points than 32 bits count");
    if (point_count_ > 0) {
      const Tag* const points = array("Points/");
      if (points == nullptr) tags_.fail("a <Piece> has points, but no array of them");
      const std::string_view components = (*points)["NumberOfComponents"];
      if (components != "3")
        tags_.fail_at(points->begin, "points of " + in_quotes(components) + " components; they need 3");
      const std::vector<double> values = numbers(*points, 3 * point_count_);
      if (values.size() != 3 * point_count_)
        tags_.fail_at(points->begin, "the array of points has " + std::to_string(values.size()) + " numbers, not the " +
                                         std::to_string(3 * point_count_) + " of " + std::to_string(point_count_) +
                                         " points");
      InterruptPoller poll_interrupt(1u << 16);
      for (std::size_t i = 0; i < values.size(); i += 3) {
        poll_interrupt();
        const Vec3 p{values[i], values[i + 1], values[i + 2]};
        if (!is_finite(p))
          tags_.fail_at(points->begin, "point " + std::to_string(i / 3) +
                                           " is not finite; remove or repair it where the file was made");
        mesh_.positions.push_back(p);
      }
    }
    if (type_ == "PolyData") {
      add_lists("Polys", {CellShape::polygon, 0}, first);
      add_lists("Strips", {CellShape::strip, 0}, first);
    } else if (cell_count_ > 0) {
      add_lists("Cells", {}, first);
    }
  }

  void add_lists(const std::string& group, CellType type, std::uint64_t first) {
    const Tag* const offsets = array(group + "/offsets");
    const Tag* const corners = array(group + "/connectivity");
    const Tag* const types = array(group + "/types");
    const bool needs_types = group == "Cells";
    if (offsets == nullptr && corners == nullptr && !needs_types) return;
    if (offsets == nullptr || corners == nullptr || (needs_types && types == nullptr))
      tags_.fail("cells need the arrays connectivity and offsets" + std::string(needs_types ? " and types" : ""));
    const std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();
    const std::vector<double> ends = numbers(*offsets, needs_types ? cell_count_ : no_limit);
    const std::vector<double> kinds = needs_types ? numbers(*types, cell_count_) : std::vector<double>();
    if (needs_types && (ends.size() != cell_count_ || kinds.size() != cell_count_))
      tags_.fail_at(offsets->begin, "a <Piece> of " + std::to_string(cell_count_) + " cells has " +
                                        std::to_string(ends.size()) + " offsets and " + std::to_string(kinds.size()) +
                                        " types");
    const std::vector<double> points = numbers(*corners, no_limit);
    std::vector<std::uint32_t> cell;
    std::size_t begin = 0;
    InterruptPoller poll_interrupt(1u << 14);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      poll_interrupt();
      if (!(ends[i] >= static_cast<double>(begin) && ends[i] <= static_cast<double>(points.size())) ||
          ends[i] != std::floor(ends[i]))
        tags_.fail_at(offsets->begin, "offset " + std::to_string(i) + " is out of place; offsets go up to " +
                                          std::to_string(points.size()) + ", the points of all cells");
      const auto end = static_cast<std::size_t>(ends[i]);
      cell.clear();
      for (std::size_t k = begin; k < end; ++k) {
        if (!(points[k] >= 0 && points[k] < static_cast<double>(point_count_)) || points[k] != std::floor(points[k]))
          tags_.fail_at(corners->begin, "cell " + std::to_string(i) + " refers to a point that is not among the " +
                                            std::to_string(point_count_) + " of its <Piece>, counted from 0");
        cell.push_back(static_cast<std::uint32_t>(first + static_cast<std::uint64_t>(points[k])));
      }
      begin = end;
      if (needs_types &&
          (!(kinds[i] >= 0 && kinds[i] < 256) || !vtk_cell_type(static_cast<std::uint64_t>(kinds[i]), type)))
        tags_.fail_at(types->begin,
                      "cell " + std::to_string(i) + " is of a type that is not read; save linear or quadratic cells");
      const std::size_t least = type.corners != 0 ? type.corners : type.shape == CellShape::none ? 0 : 3;
      if (cell.size() < least)
        tags_.fail_at(offsets->begin, "cell " + std::to_string(i) + " has " + std::to_string(cell.size()) +
                                          " points, fewer than " + std::to_string(least));
      surface_.add(type, cell);
    }
  }

  Tags tags_;
  std::string_view type_;
  std::endian order_ = std::endian::little;
  std::size_t header_size_ = 4;
  bool is_packed_ = false, appended_base64_ = false, has_appended_ = false, in_piece_ = false, has_piece_ = false;
  std::string_view appended_, group_;
  std::map<std::string, Tag> arrays_;
  std::uint64_t point_count_ = 0, cell_count_ = 0;
  Mesh mesh_;
  CellSurface surface_;
};

}  // namespace

Mesh read_vtp(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  return XmlReader(path, bytes, "PolyData").read(reading);
}

std::string vtp_bytes(const MeshView& mesh) {
  return vtp_mesh_text(mesh);
}

Mesh read_vtu(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  return XmlReader(path, bytes, "UnstructuredGrid").read(reading);
}

}  // namespace morula::detail
