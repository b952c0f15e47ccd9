// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "small_yaml.hpp"

#include <regex>
#include <stdexcept>
#include <vector>

namespace morula::test {
namespace {

using nlohmann::json;

struct Line {
  std::size_t indent;
  std::string text;
};

[[noreturn]] void fail(const std::string& text) {
  throw std::runtime_error("yaml: " + text);
}

json scalar(const std::string& text) {
  static const std::regex floats("[-+]?([0-9]+\\.[0-9]*|\\.[0-9]+)([eE][-+][0-9]+)?"), integers("[-+]?(0|[1-9][0-9]*)");
  if (text.empty() || text == "~" || text == "null") return nullptr;
  if (text == "true" || text == "false") return text == "true";
  if (std::regex_match(text, floats)) return std::stod(text);
  if (std::regex_match(text, integers)) return std::stoll(text);
  return text;
}

/// One value from `at` on: quoted, a list or map in brackets, or plain up to one of `ends`.
json flow(const std::string& text, std::size_t& at, const std::string& ends) {
  const auto blanks = [&] {
    while (at < text.size() && text[at] == ' ') ++at;
  };
  blanks();
  if (at < text.size() && text[at] == '"') {
    std::size_t end = at + 1;
    while (end < text.size() && text[end] != '"') end += text[end] == '\\' ? 2 : 1;
    if (end >= text.size()) fail("open quotes in " + text);
    const json value = json::parse(text.substr(at, end + 1 - at));
    at = end + 1;
    blanks();
    return value;
  }
  if (at < text.size() && (text[at] == '[' || text[at] == '{')) {
    const bool map = text[at] == '{';
    const char close = map ? '}' : ']';
    json value = map ? json::object() : json::array();
    ++at;
    for (blanks(); at < text.size() && text[at] != close; blanks()) {
      json entry = flow(text, at, map ? ":" : ",]");
      if (map) {
        if (at >= text.size() || text[at] != ':') fail("no colon in " + text);
        ++at;
        if (value.contains(entry.get<std::string>())) fail("a key twice in " + text);
        value[entry.get<std::string>()] = flow(text, at, ",}");
      } else {
        value.push_back(entry);
      }
      if (at < text.size() && text[at] == ',') ++at;
    }
    if (at >= text.size()) fail("open brackets in " + text);
    ++at;
    blanks();
    return value;
  }
  const std::size_t begin = at;
  while (at < text.size() && ends.find(text[at]) == std::string::npos) ++at;
  std::string plain = text.substr(begin, at - begin);
  while (!plain.empty() && plain.back() == ' ') plain.pop_back();
  return scalar(plain);
}

json whole_flow(const std::string& text) {
  std::size_t at = 0;
  json value = flow(text, at, "");
  if (at != text.size()) fail("something behind a value: " + text);
  return value;
}

class Parser {
 public:
  explicit Parser(const std::string& text) {
    std::size_t begin = 0;
    while (begin < text.size()) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      std::string line = text.substr(begin, end - begin);
      begin = end + 1;
      const std::size_t indent = line.find_first_not_of(' ');
      if (indent == std::string::npos || line[indent] == '#') continue;
      if (line.find('\t') != std::string::npos) fail("a tab in " + line);
      lines_.push_back({indent, line.substr(indent)});
    }
  }

  json document() {
    if (lines_.empty()) return nullptr;
    json value = block(lines_[0].indent);
    if (at_ != lines_.size()) fail("bad indentation: " + lines_[at_].text);
    return value;
  }

 private:
  json block(std::size_t indent) {
    if (lines_[at_].text.rfind("- ", 0) == 0) return list(indent);
    if (lines_[at_].text[0] == '[' || lines_[at_].text[0] == '{') return whole_flow(lines_[at_++].text);
    json value = json::object();
    while (at_ < lines_.size() && lines_[at_].indent == indent && lines_[at_].text.rfind("- ", 0) != 0) {
      const std::string text = lines_[at_].text;
      std::size_t at = 0;
      const json key = flow(text, at, ":");
      if (!key.is_string() || at >= text.size() || text[at] != ':') fail("no key in " + text);
      if (value.contains(key.get<std::string>())) fail("a key twice: " + text);
      const std::size_t rest = text.find_first_not_of(' ', at + 1);
      ++at_;
      if (rest != std::string::npos) {
        value[key.get<std::string>()] = whole_flow(text.substr(rest));
      } else if (at_ < lines_.size() && (lines_[at_].indent > indent ||
                                         (lines_[at_].indent == indent && lines_[at_].text.rfind("- ", 0) == 0))) {
        value[key.get<std::string>()] = block(lines_[at_].indent);
      } else {
        value[key.get<std::string>()] = nullptr;
      }
    }
    return value;
  }

  json list(std::size_t indent) {
    json value = json::array();
    while (at_ < lines_.size() && lines_[at_].indent == indent && lines_[at_].text.rfind("- ", 0) == 0) {
      // What stands behind the dash is a block of its own, two columns further in.
      lines_[at_].indent += 2;
      lines_[at_].text.erase(0, 2);
      value.push_back(block(indent + 2));
    }
    return value;
  }

  std::vector<Line> lines_;
  std::size_t at_ = 0;
};

}  // namespace

json parse_yaml(const std::string& text) {
  return Parser(text).document();
}

}  // namespace morula::test
