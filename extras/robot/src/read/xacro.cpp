// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/xacro.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "parallel/interruption.hpp"

extern char** environ;

namespace morula::robot {

namespace {

constexpr std::size_t most_output_bytes = 64u << 20, most_message_bytes = 500;

/// Whether an attribute has a value that xacro replaces. $(optenv …) alone is read without it.
bool has_expression(const tinyxml2::XMLElement& at) {
  for (const tinyxml2::XMLAttribute* a = at.FirstAttribute(); a != nullptr; a = a->Next()) {
    const std::string_view value = a->Value();
    if (value.find("${") != value.npos || value.find("$(arg ") != value.npos || value.find("$(find ") != value.npos)
      return true;
  }
  return false;
}

const tinyxml2::XMLElement* find_below(const tinyxml2::XMLElement& at, bool is_declared) {
  // Every element once, without recursion: nesting is limited by the parser only.
  const tinyxml2::XMLNode* node = &at;
  while (node != nullptr) {
    if (const tinyxml2::XMLElement* element = node->ToElement()) {
      if (std::string_view(element->Name()).starts_with("xacro:") || (is_declared && has_expression(*element)))
        return element;
    }
    if (node->FirstChild() != nullptr) {
      node = node->FirstChild();
      continue;
    }
    while (node != &at && node->NextSibling() == nullptr) node = node->Parent();
    node = node == &at ? nullptr : node->NextSibling();
  }
  return nullptr;
}

/// A pipe whose ends other programs do not inherit, and which closes itself.
class Pipe {
 public:
  Pipe() {
    if (::pipe(ends_.data()) != 0) throw std::runtime_error(fmt::format("no pipe: {}", std::strerror(errno)));
    for (const int end : ends_) ::fcntl(end, F_SETFD, FD_CLOEXEC);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close(0);
    close(1);
  }
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close(std::size_t end) {
    if (ends_[end] >= 0) ::close(ends_[end]);
    ends_[end] = -1;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

/// A program that was started; it is ended, and waited for, at the latest with this object.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    wait();
  }
  /// The exit status as of waitpid().
  int wait() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = -1;
    return status;
  }

 private:
  pid_t id_;
};

/// Reads both pipes to their ends.
void read_all(Pipe& out, Pipe& err, std::string& text, std::string& message, const std::filesystem::path& file) {
  std::array<pollfd, 2> polled{pollfd{out.read_end(), POLLIN, 0}, pollfd{err.read_end(), POLLIN, 0}};
  std::vector<char> buffer(1u << 16);
  while (polled[0].fd >= 0 || polled[1].fd >= 0) {
    detail::check_interrupt();
    if (::poll(polled.data(), polled.size(), 100) < 0) continue;
    for (std::size_t k = 0; k < 2; ++k) {
      if (polled[k].fd < 0 || polled[k].revents == 0) continue;
      const ssize_t count = ::read(polled[k].fd, buffer.data(), buffer.size());
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (count <= 0) {
        polled[k].fd = -1;
        continue;
      }
      std::string& to = k == 0 ? text : message;
      const std::size_t most = k == 0 ? most_output_bytes : most_output_bytes / 64;
      if (to.size() + static_cast<std::size_t>(count) > most) {
        if (k == 1) continue;
        throw FileError(fmt::format("{}: xacro makes more than 64 MiB of it", file.string()));
      }
      to.append(buffer.data(), static_cast<std::size_t>(count));
    }
  }
}

/// The lines of a message as one, cut at a length.
std::string one_line(const std::string& message) {
  std::string line;
  for (const char c : message) {
    const bool blank = static_cast<unsigned char>(c) <= ' ';
    if (!blank || (!line.empty() && line.back() != ' ')) line += blank ? ' ' : c;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  if (line.size() > most_message_bytes) line = line.substr(0, most_message_bytes) + " …";
  return line;
}

/// A program that ended.
struct Run {
  int not_started = 0;  // the error where it could not be started
  int status = 0;       // as of waitpid()
  std::string text, message;
  bool succeeded() const { return not_started == 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0; }
};

/// Runs xacro on the file, with these options of its own and the arguments of the file.
Run run_xacro(const std::vector<std::string>& own, const std::filesystem::path& file, const ReadOptions& options) {
  std::vector<std::string> words{options.xacro};
  words.insert(words.end(), own.begin(), own.end());
  words.push_back(std::filesystem::absolute(file).string());
  words.insert(words.end(), options.xacro_arguments.begin(), options.xacro_arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  Run run;
  Pipe out, err;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.write_end(), 1);
  posix_spawn_file_actions_adddup2(&actions, err.write_end(), 2);
  pid_t id = 0;
  run.not_started = ::posix_spawnp(&id, words[0].c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (run.not_started != 0) return run;
  Child child(id);
  out.close(1);
  err.close(1);
  read_all(out, err, run.text, run.message, file);
  run.status = child.wait();
  return run;
}

void require_argument(const std::string& argument) {
  const std::size_t at = argument.find(":=");
  if (at != std::string::npos && at > 0 && argument[0] != '-' && argument.find('\0') == std::string::npos) return;
  throw std::invalid_argument(fmt::format("xacro argument \"{}\": give NAME:=VALUE, as prefix:=left_", argument));
}

}  // namespace

const tinyxml2::XMLElement* find_xacro(const Xml& xml) {
  const tinyxml2::XMLElement& root = xml.root();
  if (std::string_view(root.Name()) != "robot") return nullptr;
  const bool is_declared = root.FindAttribute("xmlns:xacro") != nullptr || xml.file().extension() == ".xacro";
  return find_below(root, is_declared);
}

std::string expand_xacro(const std::filesystem::path& file, int line, const ReadOptions& options) {
  if (options.xacro.empty()) {
    fail_at(file, line, "has macros: run xacro on the file first, or name the program as the option xacro");
  }
  for (const std::string& argument : options.xacro_arguments) require_argument(argument);
  Run run = run_xacro({}, file, options);
  if (run.not_started != 0) {
    fail_at(file, line,
            fmt::format("has macros, and the program {} that expands them cannot be run ({}): install it (pip install "
                        "xacro, or ros-DISTRIBUTION-xacro), or name it as the option xacro",
                        options.xacro, std::strerror(run.not_started)));
  }
  if (WIFEXITED(run.status) && WEXITSTATUS(run.status) == 127 && run.text.empty() && run.message.empty()) {
    fail_at(file, line, fmt::format("has macros, and the program {} that expands them cannot be run", options.xacro));
  }
  if (!run.succeeded()) {
    fail_at(
        file, line,
        fmt::format("{} fails: {}", options.xacro, run.message.empty() ? "it says nothing" : one_line(run.message)));
  }
  return std::move(run.text);
}

std::vector<std::filesystem::path> files_of_xacro(const std::filesystem::path& file, const ReadOptions& options) {
  const Run run = run_xacro({"--deps"}, file, options);
  if (!run.succeeded()) return {};
  // Absolute paths with a blank between them; names may also have blanks.
  std::set<std::filesystem::path> files;
  for (std::size_t begin = 0; begin < run.text.size();) {
    const std::size_t end = std::min(run.text.find(" /", begin), run.text.size());
    std::string name = run.text.substr(begin, end - begin);
    while (!name.empty() && (name.back() == '\n' || name.back() == '\r')) name.pop_back();
    std::error_code error;
    if (name.starts_with('/') && std::filesystem::is_regular_file(name, error)) files.insert(name);
    begin = end + 1;
  }
  return {files.begin(), files.end()};
}

}  // namespace morula::robot
