// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/io/file_reference.hpp>

#include "platform/path_text.hpp"

namespace morula {

namespace fs = std::filesystem;

namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

int hexadecimal(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// %00 is not decoded: the system would read the name only up to there, a name other than the checked one.
std::string decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hexadecimal(text[i + 1]) : -1;
    const int low = high < 0 ? -1 : hexadecimal(text[i + 2]);
    // mutant reference-zero-byte: `0 || 16 * high + low == 0` -> `0`
    if (low < 0 || 16 * high + low == 0) {
      result += text[i];
      continue;
    }
    result += static_cast<char>(16 * high + low);
    i += 2;
  }
  return result;
}

/// The length of "scheme" in "scheme://…"; 0 if the text begins with none.
std::size_t scheme_length(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size() && (is_letter(text[end]) || (end > 0 && std::string_view("0123456789+-.").find(text[end]) !=
                                                                       std::string_view::npos))) {
    ++end;
  }
  // A single letter is a drive.
  return end > 1 && text.substr(end).starts_with("://") ? end : 0;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

std::vector<std::string> distinct(std::string first, std::string second) {
  std::vector<std::string> all{std::move(first)};
  if (second != all[0]) all.push_back(std::move(second));
  for (std::string& path : all) {
    if (begins_with_drive(path)) std::replace(path.begin(), path.end(), '\\', '/');
  }
  return all;
}

std::vector<std::string> paths_of_file_uri(std::string_view rest) {
  constexpr std::string_view host = "localhost";
  if (lower_case(rest.substr(0, host.size() + 1)) == "localhost/") rest.remove_prefix(host.size());
  if (rest.size() > 1 && rest[0] == '/' && begins_with_drive(rest.substr(1))) rest.remove_prefix(1);
  return distinct(decoded(rest), std::string(rest));
}

/// The path with links resolved, as far as it exists.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  // mutant roots-links-not-resolved: `weakly_canonical ... error), error)` -> `absolute(path, error).lexically_normal()`
  fs::path result = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? fs::path() : result;
}

bool is_below(const fs::path& file, const fs::path& folder) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  // mutant roots-any-folder: `== folder.end` -> `!= folder.begin`
  return end == folder.end();
}

}  // namespace

bool begins_with_drive(std::string_view path) {
  return path.size() >= 3 && is_letter(path[0]) && path[1] == ':' && (path[2] == '/' || path[2] == '\\');
}

FileReference parse_file_reference(std::string_view text) {
  if (const std::size_t length = scheme_length(text); length > 0) {
    std::string scheme = lower_case(text.substr(0, length));
    const std::string_view rest = text.substr(length + 3);
    if (scheme == "file") return {"", paths_of_file_uri(rest)};
    return {std::move(scheme), distinct(decoded(rest), std::string(rest))};
  }
  if (lower_case(text.substr(0, 6)) == "file:/") return {"", paths_of_file_uri(text.substr(5))};
  return {"", distinct(std::string(text), decoded(text))};
}

fs::path referenced_file(std::string_view text, const fs::path& folder) {
  const FileReference reference = parse_file_reference(text);
  if (!reference.scheme.empty()) return folder / platform::path_of(text);
  for (const std::string& path : reference.paths) {
    std::error_code error;
    fs::path file = folder / platform::path_of(path);
    if (fs::exists(file, error)) return file;
  }
  return folder / platform::path_of(reference.paths[0]);
}

FileRoots::FileRoots(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) add(folder);
}

void FileRoots::add(const fs::path& folder) {
  fs::path plain = resolved(folder.empty() ? fs::path(".") : folder);
  // A slash at the end means an empty name behind it, which no file has.
  if (!plain.has_filename() && plain.has_relative_path()) plain = plain.parent_path();
  if (plain.empty() || std::find(folders_.begin(), folders_.end(), plain) != folders_.end()) return;
  folders_.push_back(std::move(plain));
}

bool FileRoots::hold(const fs::path& file) const {
  const fs::path plain = resolved(file);
  return !plain.empty() &&
         std::any_of(folders_.begin(), folders_.end(), [&](const fs::path& folder) { return is_below(plain, folder); });
}

std::optional<std::string> FileRoots::refusal(const fs::path& file, std::string_view option) const {
  std::error_code error;
  if (hold(file) || !fs::exists(file, error)) return std::nullopt;
  std::string folders;
  for (std::size_t i = 0; i < folders_.size(); ++i) {
    folders += (i == 0 ? "" : i + 1 == folders_.size() ? " and " : ", ") + platform::text_of(folders_[i]);
  }
  const fs::path plain = resolved(file);
  const bool is_link = plain != fs::absolute(file, error).lexically_normal();
  return (is_link ? "leads to " + platform::text_of(plain) + ", which lies outside " : "lies outside ") +
         (folders.empty() ? "all folders that are there" : folders) + "; allow its folder with " + std::string(option) +
         " " + platform::text_of(fs::is_directory(plain, error) ? plain : plain.parent_path());
}

}  // namespace morula
