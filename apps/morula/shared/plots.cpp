// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/io/whole_output.hpp>
#include <string_view>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/files.hpp"

namespace morula::cli {

void add_plot(CLI::App& command, std::string& path, const std::string& what) {
  add_option(command, "--plot", path, fmt::format("Draw {}, as FILE.svg", what))->type_name("FILE");
}

void require_plot_output(const std::string& path, const std::vector<std::filesystem::path>& inputs) {
  if (path.empty()) return;
  if (extension(path) != ".svg") throw UsageError(fmt::format("--plot {}: plots are written as .svg", path));
  require_output_place(path);
  require_not_input(path, inputs);
}

void write_plot(const std::string& path, const toolbox::Plot& plot) {
  if (path.empty()) return;
  write_whole(path, toolbox::svg_plot(plot));
  note_written(path);
}

toolbox::PlotLine line_over_frames(std::string name, std::vector<std::optional<double>> values, std::size_t color) {
  constexpr std::size_t palette = 8;
  toolbox::PlotLine line{.name = std::move(name), .x = {}, .y = std::move(values)};
  line.color = static_cast<int>(color % palette);
  for (std::size_t i = 0; i < line.y.size(); ++i) line.x.push_back(static_cast<double>(i));
  return line;
}

std::string sparkline(const std::vector<std::optional<double>>& values, std::size_t width) {
  constexpr std::array<std::string_view, 8> blocks{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  double largest = 0;
  for (const std::optional<double>& value : values) largest = std::max(largest, value.value_or(0));
  std::string text;
  const std::size_t count = std::min(width, values.size());
  for (std::size_t i = 0; i < count; ++i) {
    std::optional<double> here;
    for (std::size_t k = i * values.size() / count; k < (i + 1) * values.size() / count; ++k)
      if (values[k]) here = std::max(here.value_or(0), *values[k]);
    const double share = here && largest > 0 ? *here / largest : 0;
    const auto step = static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * (blocks.size() - 1)));
    text += here ? blocks[step] : " ";
  }
  return text;
}

std::string bar(double share, std::size_t width) {
  constexpr std::array<std::string_view, 8> eighths{"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const auto eights =
      static_cast<std::size_t>(std::lround(std::clamp(share, 0.0, 1.0) * 8 * static_cast<double>(width)));
  std::string text;
  for (std::size_t i = 0; i < eights / 8; ++i) text += "█";
  return text + std::string(eighths[eights % 8]);
}

}  // namespace morula::cli
