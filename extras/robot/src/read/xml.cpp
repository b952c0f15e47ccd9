// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/xml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <morula/geometry/reproducible.hpp>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <utility>

#include "io/whole_file.hpp"
#include "platform/decimal.hpp"
#include "platform/path_text.hpp"

namespace morula::robot {

namespace {

constexpr std::uintmax_t most_bytes = 64u << 20;

std::string bytes_of(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw SystemFileError(file, "there is no such file", ENOENT);
  if (!std::filesystem::is_regular_file(file, error)) {
    throw FileError(fmt::format("{}: is not a file; name the robot's description", platform::text_of(file)));
  }
  if (std::filesystem::file_size(file, error) > most_bytes) {
    throw FileError(
        fmt::format("{}: is larger than 64 MiB, which no description of a robot is", platform::text_of(file)));
  }
  std::ifstream stream(file, std::ios::binary);
  std::string bytes;
  while (stream.peek() != std::ifstream::traits_type::eof()) {
    detail::check_interrupt();
    const std::size_t before = bytes.size();
    bytes.resize(before + detail::bytes_per_look);
    stream.read(bytes.data() + before, detail::bytes_per_look);
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !stream.eof())
    throw FileError(fmt::format("{}: cannot be read; look at its permissions", platform::text_of(file)));
  return bytes;
}

int line_of(std::string_view bytes, std::size_t at) {
  return 1 + static_cast<int>(std::count(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

const char* number_hint(std::string_view value) {
  if (value.find("${") != value.npos || value.find("$(") != value.npos) return "; run xacro on the file first";
  return value.find(',') != value.npos ? "; write decimals with a point, and numbers apart by blanks" : "";
}

/// "mismatched element" of XML_ERROR_MISMATCHED_ELEMENT.
std::string error_text(std::string_view name) {
  for (const std::string_view prefix : {"XML_ERROR_", "XML_"}) {
    if (!name.starts_with(prefix)) continue;
    name.remove_prefix(prefix.size());
    break;
  }
  std::string text;
  for (const char c : name) text += c == '_' ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/// Apart by blanks, or by commas: one between every two.
bool read_numbers_with_commas(std::string_view text, std::vector<double>& numbers) {
  if (text.find(',') == text.npos) return read_numbers(text, numbers);
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::size_t before = numbers.size();
    if (!read_numbers(text.substr(begin, end - begin), numbers) || numbers.size() != before + 1) return false;
    begin = end + 1;
  }
  return true;
}

}  // namespace

void fail_at(const std::filesystem::path& file, int line, const std::string& text) {
  // Names may hold anything; a message is one line.
  std::string plain = text;
  for (char& c : plain) {
    if (static_cast<unsigned char>(c) < ' ') c = '?';
  }
  throw FileError(fmt::format("{}:{}: {}", platform::text_of(file), line, plain));
}

Xml::Xml(const std::filesystem::path& file) : file_(file) {
  parse(bytes_of(file));
}

Xml::Xml(const std::filesystem::path& file, XmlText text) : file_(file) {
  parse(std::move(text.bytes));
}

void Xml::parse(std::string bytes) {
  const std::filesystem::path& file = file_;
  // Programs in C may also write the terminating 0 of their text.
  while (!bytes.empty() && bytes.back() == '\0') bytes.pop_back();
  if (const std::size_t at = bytes.find("<!ENTITY"); at != std::string::npos) {
    fail_at(file, line_of(bytes, at),
            "entities are declared, and none are expanded here: write out what they stand for");
  }
  if (const std::size_t at = bytes.find('\0'); at != std::string::npos) {
    fail_at(file, line_of(bytes, at), "is not text: it has a byte of value 0");
  }
  if (document_.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
    fail_at(file, std::max(1, document_.ErrorLineNum()),
            fmt::format("is not well-formed XML: {}", error_text(document_.ErrorName())));
  }
  if (document_.RootElement() == nullptr) throw FileError(fmt::format("{}: holds no element", platform::text_of(file)));
}

Xml::Xml(const std::filesystem::path& file, std::string_view root) : Xml(file) {
  if (this->root().Name() != root) {
    fail(this->root(), fmt::format("begins with <{}>, not with <{}>", this->root().Name(), root));
  }
}

void Xml::fail(const tinyxml2::XMLElement& at, const std::string& text) const {
  fail_at(file_, at.GetLineNum(), text);
}

std::string Xml::text(const tinyxml2::XMLElement& at, const char* attribute) const {
  poll_interrupt_();
  const char* value = at.Attribute(attribute);
  if (value == nullptr || *value == '\0') fail(at, fmt::format("<{}> has no {}", at.Name(), attribute));
  return value;
}

/// The meaning of numbers in forms that only certain readers accept: with a comma between every two, or as an
/// environment variable with a default value. None if it is ambiguous: "1,5 2,5 3,5" are three numbers with decimal
/// commas or six without, and among too many numbers the intended ones are unknown.
std::vector<double> Xml::numbers_meant(const tinyxml2::XMLElement& at, const char* attribute, const std::string& value,
                                       std::size_t count) const {
  std::string plain = value;
  constexpr std::string_view variable = "$(optenv ";
  if (plain.starts_with(variable) && plain.ends_with(")")) {
    const std::size_t blank = plain.find(' ', variable.size());
    plain = blank == plain.npos ? "" : plain.substr(blank, plain.size() - blank - 1);
  }
  std::vector<double> numbers;
  if (!read_numbers_with_commas(plain, numbers) || numbers.size() != count) return {};
  std::string taken;
  for (const double number : numbers) taken += fmt::format("{}{}", taken.empty() ? "" : " ", number);
  notes_.push_back(
      fmt::format("{}=\"{}\" of <{}> (line {}) is read as {}", attribute, value, at.Name(), at.GetLineNum(), taken));
  return numbers;
}

double Xml::number(const tinyxml2::XMLElement& at, const char* attribute) const {
  std::vector<double> numbers;
  const std::string value = text(at, attribute);
  if (!read_numbers(value, numbers) || numbers.size() != 1) numbers = numbers_meant(at, attribute, value, 1);
  if (numbers.size() != 1) {
    fail(at, fmt::format("{}=\"{}\" of <{}> is no number{}", attribute, value, at.Name(), number_hint(value)));
  }
  return numbers[0];
}

double Xml::number(const tinyxml2::XMLElement& at, const char* attribute, double fallback) const {
  return at.Attribute(attribute) == nullptr ? fallback : number(at, attribute);
}

Vec3 Xml::vector(const tinyxml2::XMLElement& at, const char* attribute, const Vec3& fallback) const {
  poll_interrupt_();
  const char* value = at.Attribute(attribute);
  if (value == nullptr) return fallback;
  std::vector<double> numbers;
  if (!read_numbers(value, numbers) || numbers.size() != 3) numbers = numbers_meant(at, attribute, value, 3);
  if (numbers.size() != 3) {
    fail(at, fmt::format("{}=\"{}\" of <{}> is not three numbers{}", attribute, value, at.Name(), number_hint(value)));
  }
  return {numbers[0], numbers[1], numbers[2]};
}

bool read_numbers(std::string_view text, std::vector<double>& numbers) {
  const char* at = text.data();
  const char* const end = at + text.size();
  detail::InterruptPoller poll_interrupt(4096);
  for (;;) {
    poll_interrupt();
    while (at != end && is_blank(*at)) ++at;
    if (at == end) return true;
    if (*at == '+' && at + 1 != end && at[1] != '-') ++at;
    double value = 0;
    const std::from_chars_result read = platform::read_number(at, end, value);
    if (read.ec == std::errc::result_out_of_range && read.ptr != at) {
      // Too small for a double is 0, as in every reader; too large is no number.
      const std::string_view word(at, static_cast<std::size_t>(read.ptr - at));
      if (word.find("e-") == std::string_view::npos && word.find("E-") == std::string_view::npos) return false;
      value = 0;
    } else if (read.ec != std::errc()) {
      return false;
    }
    if (!std::isfinite(value) || (read.ptr != end && !is_blank(*read.ptr))) return false;
    numbers.push_back(value);
    at = read.ptr;
  }
}

RigidTransform from_roll_pitch_yaw(const Vec3& angles, const Vec3& translation) {
  const SinCos x = sin_cos(angles.x), y = sin_cos(angles.y), z = sin_cos(angles.z);
  return {.rows = {Vec3{z.cos * y.cos, z.cos * y.sin * x.sin - z.sin * x.cos, z.cos * y.sin * x.cos + z.sin * x.sin},
                   Vec3{z.sin * y.cos, z.sin * y.sin * x.sin + z.cos * x.cos, z.sin * y.sin * x.cos - z.cos * x.sin},
                   Vec3{-y.sin, y.cos * x.sin, y.cos * x.cos}},
          .translation = translation};
}

Vec3 roll_pitch_yaw(const RigidTransform& pose) {
  const auto& r = pose.rows;
  const double across = std::sqrt(r[0].x * r[0].x + r[1].x * r[1].x);
  const double pitch = angle_of(-r[2].x, across);
  // Straight up or down only the difference of the other two counts.
  if (across < 1e-12) return {angle_of(-r[1].z, r[1].y), pitch, 0};
  return {angle_of(r[2].y, r[2].z), pitch, angle_of(r[1].x, r[0].x)};
}

RigidTransform composed(const RigidTransform& a, const RigidTransform& b) {
  RigidTransform result;
  for (int column = 0; column < 3; ++column) {
    const Vec3 turned = a.rotate({b.rows[0][column], b.rows[1][column], b.rows[2][column]});
    for (int row = 0; row < 3; ++row) result.rows[static_cast<std::size_t>(row)][column] = turned[row];
  }
  result.translation = a(b.translation);
  return result;
}

}  // namespace morula::robot
