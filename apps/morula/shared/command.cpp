// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/command.hpp"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace morula::cli {

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& description) {
  return app.add_subcommand(name, description);
}

template <class T>
CLI::Option* add_option(CLI::App& to, const std::string& names, T& value, const std::string& description) {
  return to.add_option(names, value, description);
}
template CLI::Option* add_option(CLI::App&, const std::string&, std::string&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<std::string>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::string>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, double&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<double>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<double>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, int&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, unsigned&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<unsigned>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::size_t&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<std::size_t>&, const std::string&);

CLI::Option* add_flag(CLI::App& to, const std::string& names, bool& value, const std::string& description) {
  return to.add_flag(names, value, description);
}

void set_footer(CLI::App& command, const std::string& text) {
  command.footer(text);
}

void on_use(CLI::App& command, std::function<void()> action) {
  command.callback(std::move(action));
}

}  // namespace morula::cli
