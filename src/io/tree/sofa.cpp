// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/io/sofa_file.hpp>
#include <morula/io/whole_output.hpp>
#include <stdexcept>
#include <string>

#include "io/number_text.hpp"
#include "parallel/interruption.hpp"

namespace morula {

void write_sofa_spheres(const std::filesystem::path& path, std::span<const Sphere> spheres) {
  // The loader steps over the first line whatever it says, and does not look at the index.
  std::string text = "sph 1.0\nnums ";
  detail::append_number(text, spheres.size());
  detail::AskNowAndThen ask_now_and_then(4096);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    ask_now_and_then();
    const Sphere& s = spheres[i];
    if (!is_finite(s.center) || !std::isfinite(s.radius))
      throw std::invalid_argument("sphere " + std::to_string(i) + " has a number that is not finite");
    text += "\nsphe ";
    detail::append_number(text, i);
    for (const double value : {s.center.x, s.center.y, s.center.z, s.radius}) {
      text += ' ';
      detail::append_number(text, value);
    }
  }
  write_whole(path, text + '\n');
}

}  // namespace morula
