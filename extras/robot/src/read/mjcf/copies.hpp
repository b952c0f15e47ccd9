// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// <frame> and <replicate>: the poses of their contents, and the names of these in each copy.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "read/mjcf/values.hpp"

namespace morula::robot {

struct MjcfCopy {
  const tinyxml2::XMLElement* of;  ///< <replicate>
  int number;
};

struct MjcfName {
  std::string text;
  std::vector<MjcfCopy> copies{};  ///< copies that contain the element, from the outermost on
};

class MjcfNames {
 public:
  /// Adds a name as written, and as in its copy. Returns false if it exists already.
  bool add(const std::string& written, const MjcfName& name);
  /// The names that a reference means: the element of that name, or all copies of it.
  std::vector<MjcfName> of(const std::string& written) const;

 private:
  std::set<std::string> all_;
  std::map<std::string, std::vector<MjcfName>> copies_;
};

class MjcfCopies {
 public:
  MjcfCopies(const MjcfFiles& files, const MjcfValues& values) : files_(files), values_(values) {}

  static bool is_frame(std::string_view kind) { return kind == "frame" || kind == "replicate"; }

  /// Calls visit(pose) for a <frame>, and for each copy that a <replicate> makes.
  template <class Visit>
  void each(const tinyxml2::XMLElement& at, const Visit& visit) {
    if (std::string_view(at.Name()) == "frame") return visit(values_.pose({at}));
    const Series series(files_, values_, at);
    const std::string around = suffix_;
    Vec3 place;
    for (int i = 0; i < series.count; ++i) {
      // MuJoCo turns each by its number times euler, and puts it an offset away from the one before, in the axes of
      // that.
      RigidTransform pose = values_.turn_by_euler(static_cast<double>(i) * series.angles);
      pose.translation = place;
      place = pose(series.offset);
      suffix_ = series.suffix(i) + around;
      copies_.push_back({&at, i});
      visit(pose);
      copies_.pop_back();
    }
    suffix_ = around;
  }

  /// The text that the names of visited elements get appended.
  const std::string& suffix() const { return suffix_; }
  /// The name of an element; empty if it has none.
  std::string name_of(const tinyxml2::XMLElement& at) const;
  MjcfName name(const std::string& text) const { return {text, copies_}; }

  /// Has to be called once for each visited element: rejects a small file that expands to too many elements.
  void count(const tinyxml2::XMLElement& at);

  /// The pairs that an element with two names means: for elements of one <replicate>, the pairs within one copy.
  std::vector<std::pair<std::string, std::string>> pairs(const tinyxml2::XMLElement& at,
                                                         const std::vector<MjcfName>& some,
                                                         const std::vector<MjcfName>& others);

 private:
  struct Series {
    int count;
    Vec3 offset, angles;
    std::string separator;
    Series(const MjcfFiles& files, const MjcfValues& values, const tinyxml2::XMLElement& at);
    /// The suffix of a copy, with as many digits as the count has.
    std::string suffix(int number) const;
  };

  const MjcfFiles& files_;
  const MjcfValues& values_;
  std::string suffix_;
  std::vector<MjcfCopy> copies_;
  std::size_t counted_ = 0, compared_ = 0;
};

}  // namespace morula::robot
