// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// XML with messages that name file and line. No entities are expanded: a document that declares them is rejected.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <morula/geometry/rigid_transform.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "parallel/interruption.hpp"

namespace morula::robot {

/// Throws FileError "FILE:LINE: …".
[[noreturn]] void fail_at(const std::filesystem::path& file, int line, const std::string& text);

/// What a program makes of a file.
struct XmlText {
  std::string bytes;
};

class Xml {
 public:
  /// Throws FileError: unreadable, broken, larger than 64 MiB, or with entities.
  explicit Xml(const std::filesystem::path& file);
  /// Parses text in place of the file, which messages name.
  Xml(const std::filesystem::path& file, XmlText text);
  /// The same for another root element.
  Xml(const std::filesystem::path& file, std::string_view root);

  const std::filesystem::path& file() const { return file_; }
  tinyxml2::XMLDocument& document() { return document_; }
  const tinyxml2::XMLElement& root() const { return *document_.RootElement(); }

  [[noreturn]] void fail(const tinyxml2::XMLElement& at, const std::string& text) const;
  /// Throws where it is missing.
  std::string text(const tinyxml2::XMLElement& at, const char* attribute) const;
  /// A number; `fallback` if it is missing. Throws for text that is no finite number.
  double number(const tinyxml2::XMLElement& at, const char* attribute, double fallback) const;
  double number(const tinyxml2::XMLElement& at, const char* attribute) const;
  Vec3 vector(const tinyxml2::XMLElement& at, const char* attribute, const Vec3& fallback) const;
  /// Numbers that were read in spite of how they are written.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void parse(std::string bytes);
  std::vector<double> numbers_meant(const tinyxml2::XMLElement& at, const char* attribute, const std::string& value,
                                    std::size_t count) const;

  std::filesystem::path file_;
  tinyxml2::XMLDocument document_;
  mutable std::vector<std::string> notes_;
  mutable detail::InterruptPoller poll_interrupt_{256};  // whenever an attribute is looked at
};

/// Reads finite numbers separated by blanks; fails if there is other text among them.
bool read_numbers(std::string_view text, std::vector<double>& numbers);

/// By roll, pitch, yaw about the fixed axes x, y, z, as in URDF and SDF.
RigidTransform from_roll_pitch_yaw(const Vec3& angles, const Vec3& translation);
Vec3 roll_pitch_yaw(const RigidTransform& pose);
/// First a, then b on top: x → a(b(x)).
RigidTransform composed(const RigidTransform& a, const RigidTransform& b);

}  // namespace morula::robot
