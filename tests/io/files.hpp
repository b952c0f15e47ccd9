// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files for tests: a scratch folder, bytes in and out, and what a complaint has to say.
#pragma once

#include <filesystem>
#include <functional>
#include <locale>
#include <morula/io/tree_file.hpp>
#include <string>
#include <string_view>
#include <support/raw.hpp>
#include <support/scratch_folder.hpp>
#include <vector>

namespace morula::test {

/// Expects a FileError whose text begins with the file's path and holds the fragment. line: 0, or the line that it has
/// to name right after the path.
void expect_file_error(const std::filesystem::path& path, std::size_t line, const std::string& fragment,
                       const std::function<void()>& action);

/// A file that must be refused.
struct HostileFile {
  std::string name;
  std::string bytes;
  std::size_t line;
  std::string fragment;
};
/// Each of them in a folder of its own, read by that function.
void expect_all_refused(const std::vector<HostileFile>& files,
                        const std::function<void(const std::filesystem::path&)>& read);

/// Numbers that a careless writer or reader changes: the largest, the smallest, −0, many digits.
std::vector<double> awkward_numbers();
/// A box whose vertices, used and unused, are awkward numbers; its coordinates stay small enough to compute with.
Mesh awkward_mesh();

bool same_bits(double a, double b);
bool same_bits(const Mesh& a, const Mesh& b);
bool same_bits(const SphereTree& a, const SphereTree& b);
bool same_bits(const Cover& a, const Cover& b);
bool same_bits(const BuildReport& a, const BuildReport& b);

/// A cube under a root with eight children, one of which has two of its own; many of its facets are cut.
CoveredTree small_built(const Mesh& mesh);
Mesh small_mesh();
const Mesh& one_facet();

/// While it lives, streams write 1.234,5 for 1234.5.
class CommaLocale {
 public:
  CommaLocale();
  ~CommaLocale() { std::locale::global(before_); }
  CommaLocale(const CommaLocale&) = delete;
  CommaLocale& operator=(const CommaLocale&) = delete;

 private:
  std::locale before_;
};

/// Puts the size and the checksum that its contents call for into a .morula.
std::string resealed(std::string morula);

}  // namespace morula::test
