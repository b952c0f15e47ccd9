// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plots of figures that commands measured, as SVG files, and the same in a few characters for tables.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <toolbox/svg_plot.hpp>
#include <vector>

#include "shared/command.hpp"

namespace morula::cli {

/// --plot FILE.
void add_plot(CLI::App& command, std::string& path, const std::string& what);
/// Before any work. Throws UsageError unless `path` is empty, or an .svg that can be written and is no input.
void require_plot_output(const std::string& path, const std::vector<std::filesystem::path>& inputs);
/// Writes the plot and remembers it as written; nothing for an empty path.
void write_plot(const std::string& path, const toolbox::Plot& plot);

/// A line over frames 0, 1, …; nothing where there is no value.
toolbox::PlotLine line_over_frames(std::string name, std::vector<std::optional<double>> values, std::size_t color);

/// "▁▂▅█": values from 0 to their largest, in at most `width` characters, each the largest of its share of the values.
std::string sparkline(const std::vector<std::optional<double>>& values, std::size_t width = 24);
/// "█████▌": a share, 0…1, of `width` characters.
std::string bar(double share, std::size_t width = 12);

}  // namespace morula::cli
