// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Next steps: the commands to type after a command line that names none.
#pragma once

#include <string>
#include <vector>

namespace morula::cli {

/// The lines that `morula` without arguments prints: three commands to paste. commands: those of this build.
std::string first_steps(const std::vector<std::string>& commands);

/// The answer to a first word that is no command.
struct NextSteps {
  std::string error;  ///< one line with the remedy, for stderr
  std::string lines;  ///< commands to paste, with the word where it is a file, for stdout; may be empty
};
/// words: the command line after "morula", of which words[at] is no command. options: those of the program itself,
/// with their dashes. Throws FileError for a damaged .ply or .npz.
NextSteps next_steps(const std::vector<std::string>& words, std::size_t at, const std::vector<std::string>& commands,
                     const std::vector<std::string>& options);

}  // namespace morula::cli
