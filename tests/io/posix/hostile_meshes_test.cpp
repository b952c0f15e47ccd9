// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that are no files, or may not be read.
#include <gtest/gtest.h>
#include <unistd.h>

#include <morula/io/mesh_file.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

TEST(HostileMeshes, devices_are_not_read) {
  const ScratchFolder folder;
  fs::create_symlink("/dev/null", folder.path() / "device.ply");
  expect_file_error(folder.path() / "device.ply", 0, "is not a regular file",
                    [&] { read_mesh(folder.path() / "device.ply"); });
}

TEST(HostileMeshes, files_that_may_not_be_read) {
  const ScratchFolder folder;
  const fs::path path = folder.file("secret.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  fs::permissions(path, fs::perms::none);
  // Permissions do not bind the superuser.
  if (geteuid() == 0)
    EXPECT_EQ(read_mesh(path).facet_count(), 1u);
  else
    expect_file_error(path, 0, "cannot be opened (Permission denied)", [&] { read_mesh(path); });
}

}  // namespace
}  // namespace morula::test
