// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "next_steps.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <morula/io/mesh_file.hpp>
#include <system_error>
#include <toolbox/shell_word.hpp>

#include "shared/files.hpp"
#include "shared/options.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;
using toolbox::shell_word;

struct Step {
  std::string typed;  ///< after "morula "
  std::string gives;
};
constexpr std::size_t most_steps = 3;

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string shell_word(fs::path path, const char* extension) {
  return shell_word(path.replace_extension(extension).string());
}

std::string lines_of(const std::vector<Step>& steps) {
  std::size_t width = 0;
  for (const Step& step : steps) width = std::max(width, step.typed.size());
  std::string lines;
  for (const Step& step : steps) lines += fmt::format("  morula {:<{}}  # {}\n", step.typed, width, step.gives);
  return lines;
}

/// The first three steps whose command this build has.
std::vector<Step> available(std::vector<Step> steps, const std::vector<std::string>& commands) {
  std::erase_if(steps, [&](const Step& step) { return !has(commands, step.typed.substr(0, step.typed.find(' '))); });
  if (steps.size() > most_steps) steps.resize(most_steps);
  return steps;
}

/// The mesh next to its tree under the same name, or the word MESH.
std::string mesh_beside(const fs::path& tree) {
  for (const MeshFileKind& kind : mesh_file_kinds()) {
    const fs::path mesh = fs::path(tree).replace_extension(kind.extension);
    std::error_code ignored;
    if (mesh != tree && fs::is_regular_file(mesh, ignored) && file_kind(mesh) == FileKind::mesh)
      return shell_word(mesh.string());
  }
  return "MESH";
}

struct FileSteps {
  std::string kind;  ///< "a mesh"; empty: no file that a command takes
  std::vector<Step> steps;
};

FileSteps steps_for(const fs::path& path) {
  const std::string file = shell_word(path.string());
  const Step info{"info " + file, "its contents, and what they are good for"};
  switch (file_kind(path)) {
    case FileKind::mesh:
      return {"a mesh",
              {{fmt::format("build {} -o {}", file, shell_word(path, ".morula")), "spheres that cover it"},
               {fmt::format("view {} {} -o {}", file, shell_word(path, ".morula"), shell_word(path, ".html")),
                "a page that shows both"},
               info,
               {fmt::format("measure {} {}", file, shell_word(path, ".morula")), "how tight the spheres are"}}};
    case FileKind::tree: {
      const std::string mesh = mesh_beside(path);
      return {"a tree",
              {{fmt::format("view {} {} -o {}", mesh, file, shell_word(path, ".html")), "a page that shows both"},
               {fmt::format("measure {} {}", mesh, file), "how tight its spheres are"},
               info,
               {fmt::format("convert {} {}", file, shell_word(path, ".sph")), "the same in another format"}}};
    }
    case FileKind::balls:
      return {"a file of balls", {info}};
    case FileKind::sphere_frames:
      return {"a file of spheres in motion",
              {info, {fmt::format("convert {} {}", file, shell_word(path, ".glb")), "an animation for Blender"}}};
    case FileKind::motion:
      return {"a motion",
              {{fmt::format("update MESH TREE {} -o {}", file, shell_word(path, ".npz")), "spheres of every frame"},
               {fmt::format("view MESH TREE {} -o {}", file, shell_word(path, ".html")), "a page that moves"}}};
    case FileKind::folder:
      return {"a folder",
              {{fmt::format("batch {} -o trees", file), "a tree for each mesh in it"},
               {fmt::format("update MESH TREE {} -o spheres", file), "spheres for each frame in it"}}};
    case FileKind::unknown:
      break;
  }
  if (const std::string ending = extension(path); ending == ".urdf" || ending == ".sdf" || ending == ".xml")
    return {"a robot", {{fmt::format("robot {} -o {}", file, shell_word(path, "")), "spheres for every link"}}};
  return {};
}

NextSteps steps_of_file(const std::string& word, const std::vector<std::string>& commands) {
  FileSteps found = steps_for(word);
  found.steps = available(std::move(found.steps), commands);
  if (found.steps.empty())
    return {fmt::format("unknown command '{}', which is a file, but {}; see morula formats", word, known_kinds()), {}};
  return {fmt::format("'{}' is {}, not a command; try morula {}", word, found.kind, found.steps.front().typed),
          fmt::format("With {}:\n{}", word, lines_of(found.steps))};
}

/// The rest of the command line, as it was typed.
std::string rest_after(const std::vector<std::string>& words, std::size_t at) {
  std::string rest;
  for (std::size_t i = at + 1; i < words.size(); ++i) rest += ' ' + shell_word(words[i]);
  return rest;
}

}  // namespace

std::string first_steps(const std::vector<std::string>& commands) {
  const std::vector<Step> steps = available({{"sample limb -o limb.obj", "a mesh, unless you have one"},
                                             {"build limb.obj -o limb.morula", "spheres that cover it, level by level"},
                                             {"view limb.obj limb.morula -o limb.html", "a page that shows both"},
                                             {"measure limb.obj limb.morula", "how tight the spheres are"}},
                                            commands);
  return fmt::format(
      "Morula builds trees of spheres that cover a triangle mesh, certified, while it deforms. To begin:\n\n{}\n"
      "morula --help lists all commands, morula COMMAND --help explains one.\n",
      lines_of(steps));
}

NextSteps next_steps(const std::vector<std::string>& words, std::size_t at, const std::vector<std::string>& commands,
                     const std::vector<std::string>& options) {
  const std::string& word = words[at];
  std::error_code ignored;
  if (fs::is_regular_file(word, ignored) || fs::is_directory(word, ignored)) return steps_of_file(word, commands);
  const std::string unknown = fmt::format("unknown command '{}'", word);
  if (has(options, "--" + word)) {
    const bool of_command = at + 1 < words.size() && has(commands, words[at + 1]);
    return {fmt::format("{}; try morula {}--{}", unknown, of_command ? words[at + 1] + ' ' : "", word), {}};
  }
  if (const std::string near = nearest_name(word, commands); !near.empty()) {
    const std::string rest = rest_after(words, at);
    return {fmt::format("{}; did you mean {}? {} morula {}{}", unknown, near, rest.empty() ? "See" : "Try", near,
                        rest.empty() ? " --help" : rest),
            {}};
  }
  if (fs::path(word).has_extension())
    return {fmt::format("{}, and there is no file of that name; see morula --help", unknown), {}};
  return {fmt::format("{}; known: {}; see morula --help", unknown, fmt::join(commands, ", ")), {}};
}

}  // namespace morula::cli
