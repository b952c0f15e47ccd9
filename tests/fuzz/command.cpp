// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The command line: one argument a line, after a first byte that says whether the files of an example are there. Runs
// in a scratch folder that no argument leads out of. Commands that work long are parsed only.
#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <morula/generators/build.hpp>
#include <string>
#include <vector>

#include "command_line.hpp"
#include "fuzz.hpp"
#include "io/array/npy.hpp"
#include "io/mesh/formats.hpp"
#include "io/tree/formats.hpp"
#include "specimens.hpp"

namespace morula::fuzz {
using namespace detail;
namespace {

namespace fs = std::filesystem;

class Example {
 public:
  Example() {
    silence();
    fs::current_path(folder_.path());
    const Mesh& mesh = specimen_mesh();
    const std::string obj = mesh_bytes(".obj", mesh);
    files_["t.obj"] = obj;
    files_["m/0000.obj"] = files_["m/0001.obj"] = obj;
    files_["t.morula"] = native_bytes(build(mesh, {.method = Method::octree, .branching = 8, .depth = 1}));
    const std::array<double, 12> mode{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 2};
    files_["u.npy"] = npy_bytes(mode, std::array<std::size_t, 3>{1, 4, 3});
    files_["q.npy"] = npy_bytes(std::array{0.0, 0.5}, std::array<std::size_t, 2>{2, 1});
  }
  void require_files(bool there) {
    if (there == there_ && untouched()) return;
    folder_.clear();
    if (there)
      for (const auto& [name, bytes] : files_) folder_.file(name, bytes);
    there_ = there;
    times_ = times();
  }

 private:
  std::map<std::string, fs::file_time_type> times() const {
    std::map<std::string, fs::file_time_type> times;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
      times[entry.path().string()] = entry.last_write_time();
    return times;
  }
  bool untouched() const { return times() == times_; }

  test::ScratchFolder folder_;
  std::map<std::string, std::string> files_;
  std::map<std::string, fs::file_time_type> times_;
  bool there_ = false;
};

std::vector<std::string> arguments(std::string_view text) {
  std::vector<std::string> result{"morula"};
  while (!text.empty() && result.size() < 40) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string argument(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    // An argument as the system passes it ends at the first zero, and here it leads nowhere else.
    argument = argument.c_str();
    std::replace(argument.begin(), argument.end(), '/', '_');
    for (std::size_t at = argument.find(".."); at != std::string::npos; at = argument.find(".."))
      argument.replace(at, 2, "__");
    result.push_back(std::move(argument));
  }
  return result;
}

// Frames, spheres, voxels and threads by the million are allowed, but take their time.
bool has_large_number(const std::string& argument) {
  int digits = 0;
  for (const char c : argument) {
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      if (++digits > 2) return true;
    } else {
      if (digits > 0 && std::isalpha(static_cast<unsigned char>(c)) != 0) return true;
      digits = 0;
    }
  }
  return false;
}

bool works_long(const std::vector<std::string>& arguments, bool has_files) {
  constexpr std::array makers{"sample", "demo", "study"};  // need no files
  for (const char* const command : makers)
    if (arguments.size() > 1 && arguments[1] == command) return true;
  return has_files && std::any_of(arguments.begin(), arguments.end(), has_large_number);
}

}  // namespace
}  // namespace morula::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace morula::fuzz;
  static Example example;
  Bytes in(data, size);
  const bool has_files = in.flag();
  example.require_files(has_files);
  std::vector<std::string> words = arguments(in.rest());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  const int count = static_cast<int>(argv.size());
  argv.push_back(nullptr);
  const int code = morula::cli::command_line(count, argv.data(), true, works_long(words, has_files));
  if (code < 0 || code > 2) found("the command ended with exit code " + std::to_string(code));
  return 0;
}
