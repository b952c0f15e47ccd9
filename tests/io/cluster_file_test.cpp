// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/io/skin_bounds_file.hpp>
#include <support/npy.hpp>
#include <support/scratch_folder.hpp>

namespace morula::test {
namespace {

template <class Call>
std::string file_error(const Call& call) {
  try {
    call();
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

using Clusters = std::vector<std::uint32_t>;

TEST(ClusterFile, a_text_or_an_array_has_a_number_for_each_facet) {
  const ScratchFolder folder;
  EXPECT_EQ(read_clusters(folder.file("c.txt", "2 0\r\n1\n\n0 2"), 5), (Clusters{2, 0, 1, 0, 2}));
  EXPECT_EQ(read_clusters(folder.file("c.npy", npy("<i4", "(3,)", std::vector<std::int32_t>{0, 2, 1})), 3),
            (Clusters{0, 2, 1}));
  EXPECT_EQ(read_clusters(folder.file("d.npy", npy("<u8", "(2,)", std::vector<std::uint64_t>{1, 1})), 2),
            (Clusters{1, 1}));
}

TEST(ClusterFile, wrong_counts_and_numbers_are_named) {
  const ScratchFolder folder;
  const auto problem = [&](const std::string& name, const std::string& bytes) {
    const std::filesystem::path path = folder.file(name, bytes);
    return file_error([&] { static_cast<void>(read_clusters(path, 3)); }).substr(path.string().size());
  };
  EXPECT_EQ(problem("c.txt", "0 1\n"), ": has 2 numbers for 3 facets; one for each is needed");
  EXPECT_EQ(problem("c.txt", "0 1\n0 1"), ":2: has more numbers than the mesh has facets, 3");
  EXPECT_EQ(problem("c.txt", "0 1\n3"), ":2: cluster 3 is not below the number of facets, 3");
  EXPECT_NE(problem("c.txt", "0 -1 2").find(":1: "), std::string::npos);
  EXPECT_NE(problem("c.txt", "0 one 2").find(":1: "), std::string::npos);
  EXPECT_EQ(problem("c.npy", npy("<i4", "(3,)", std::vector<std::int32_t>{0, 1, 3})),
            ": facet 2 is in cluster 3, which is not below the number of facets, 3");
  EXPECT_NE(problem("c.npy", npy("<i4", "(3,)", std::vector<std::int32_t>{0, -1, 2})), "");
  EXPECT_NE(problem("c.npy", npy("<f4", "(3,)", std::vector<float>{0, 1, 2})), "");
  EXPECT_NE(problem("c.npy", npy("<i4", "(2,)", std::vector<std::int32_t>{0, 1})), "");
}

}  // namespace
}  // namespace morula::test
