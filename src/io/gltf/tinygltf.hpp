// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// tinygltf as all of gltf/ uses it: in a private namespace, so that it does not clash with another tinygltf in the
// program, and without images, which are not read.
#pragma once

#include <fstream>  // which tinygltf uses and does not include
#include <nlohmann/json.hpp>

#define tinygltf morula_tinygltf
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>
