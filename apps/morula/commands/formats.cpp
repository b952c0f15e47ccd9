// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula formats: which files are read and written.
#include <fmt/format.h>

#include <memory>
#include <morula/io/files.hpp>

#include "shared/command.hpp"
#include "shared/extension.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct FormatsArguments {
  bool json = false;
};

/// The library's, and what single commands write by the names of their --format.
int formats_command(const FormatsArguments& o) {
  const std::vector<FileFormat> formats = file_formats();
  Json json = Json::array();
  std::size_t purpose_width = 0;
  for (const FileFormat& format : formats) {
    purpose_width = std::max(purpose_width, format.purpose.size());
    json.push_back({{"extension", format.extension},
                    {"program", format.program},
                    {"read", format.is_read},
                    {"written", format.is_written},
                    {"for", format.purpose}});
  }
  Json commands = Json::object();
  for (const Extension& extension : extensions())
    if (!extension.format_command.empty()) commands[extension.format_command] = extension.format_names;
  if (o.json) {
    print_json({{"formats", json}, {"commands", commands}});
    return exit_done;
  }
  fmt::print("{:<9} {:<4}  {:<7}  {:<{}}  {}\n", "extension", "read", "written", "for", purpose_width, "format of");
  for (const FileFormat& format : formats) {
    fmt::print("{:<9} {:<4}  {:<7}  {:<{}}  {}\n", format.extension, format.is_read ? "yes" : "no",
               format.is_written ? "yes" : "no", format.purpose, purpose_width, format.program);
  }
  for (const auto& [command, names] : commands.items()) {
    std::string list;
    for (const Json& name : names) list += (list.empty() ? "" : " ") + name.get<std::string>();
    fmt::print("\nmorula {} --format: {}\n", command, list);
  }
  return exit_done;
}

}  // namespace

void add_formats(CLI::App& app, Run& run) {
  auto o = std::make_shared<FormatsArguments>();
  CLI::App* command = add_command(app, "formats", "List the files that are read and written");
  add_json(*command, o->json);
  set_footer(*command, "Example:\n  morula formats --json");
  on_use(*command, [o, &run] { run = [o] { return formats_command(*o); }; });
}

}  // namespace morula::cli
