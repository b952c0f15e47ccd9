// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// tinygltf as all of gltf/ sees it: in a namespace of our own, so that a program that also has tinygltf links it once
// more without a clash, and without images, which are not read.
#pragma once

#include <fstream>  // which tinygltf uses and forgets

#define tinygltf morula_tinygltf
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>
