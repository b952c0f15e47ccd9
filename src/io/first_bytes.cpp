// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/first_bytes.hpp"

#include <algorithm>
#include <array>

namespace morula::detail {
namespace {

using namespace std::string_view_literals;

// The number of bytes examined, enough for comments ahead of the first tag of a page.
constexpr std::size_t looked_at = 4096;

struct Signature {
  std::string_view begin, belongs_to, problem;  // belongs_to: extensions under which it is right
};
constexpr std::array signatures{
    Signature{"\x1f\x8b"sv, "", "is packed by gzip; unpack it with gunzip"},
    Signature{"PK\x03\x04"sv, "", "is a ZIP archive; unpack it"},
    Signature{"PK\x05\x06"sv, "", "is a ZIP archive; unpack it"},
    Signature{"BZh"sv, "", "is packed by bzip2; unpack it with bunzip2"},
    Signature{"\xfd"
              "7zXZ\0"sv,
              "", "is packed by xz; unpack it with unxz"},
    Signature{"\x28\xb5\x2f\xfd"sv, "", "is packed by zstd; unpack it with unzstd"},
    Signature{"7z\xbc\xaf\x27\x1c"sv, "", "is a 7z archive; unpack it"},
    Signature{"\xff\xfe"sv, "", "is text in UTF-16; save it as UTF-8"},
    Signature{"\xfe\xff"sv, "", "is text in UTF-16; save it as UTF-8"},
    Signature{"%PDF"sv, "", "is a PDF"},
    Signature{"\x89PNG"sv, "", "is a picture (PNG)"},
    Signature{"\xff\xd8\xff"sv, "", "is a picture (JPEG)"},
    Signature{"404: Not Found"sv, "", "is a server's answer that there is no such file; download it again"},
    Signature{"Kaydara FBX Binary"sv, "", "is an FBX file; convert it to glTF or OBJ"},
    Signature{"BLENDER"sv, "", "is a file of Blender; export it as glTF or OBJ"},
    Signature{"PXR-USDC"sv, "", "is a USD file; read it in Python by morula.usd"},
    Signature{"#usda "sv, "", "is a USD file; read it in Python by morula.usd"},
    Signature{"glTF"sv, ".gltf.glb", "is a binary glTF file; name it .glb"},
    Signature{"ply\n"sv, ".ply", "is a PLY file; name it .ply"},
    Signature{"ply\r"sv, ".ply", "is a PLY file; name it .ply"},
    Signature{"solid "sv, ".stl", "is an STL file; name it .stl"},
    Signature{"OFF\n"sv, ".off", "is an OFF file; name it .off"},
    Signature{"OFF\r"sv, ".off", "is an OFF file; name it .off"},
    Signature{"# vtk DataFile Version"sv, ".vtk", "is a legacy file of VTK; name it .vtk"},
    Signature{"$MeshFormat"sv, ".msh", "is a file of Gmsh; name it .msh"},
};

// Tags that an XML file begins with; pages may begin with any tag.
constexpr std::array tag_signatures{
    Signature{"<!doctype html", "", "is a web page, not the file that it offers; download that one"},
    Signature{"<html", "", "is a web page, not the file that it offers; download that one"},
    Signature{"<collada", "", "is a COLLADA file; convert it to glTF or OBJ"},
    Signature{"<x3d", "", "is an X3D file; convert it to glTF or OBJ"},
    Signature{"<vtkfile", ".vtp.vtu", "is an XML file of VTK; name it .vtp or .vtu"},
};

char small_letters(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string small_letters(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char c) { return small_letters(c); });
  return result;
}

bool is_allowed(const Signature& signature, std::string_view extension) {
  return !signature.belongs_to.empty() && signature.belongs_to.find(extension) != std::string_view::npos;
}

// Plain text in 16-bit characters without a mark at its front: every other byte is zero.
bool is_wide_text(std::string_view bytes) {
  constexpr std::size_t characters = 8;
  if (bytes.size() < 2 * characters) return false;
  std::array<bool, 2> all_zero{true, true}, all_text{true, true};
  for (std::size_t i = 0; i < 2 * characters; ++i) {
    const auto c = static_cast<unsigned char>(bytes[i]);
    all_zero[i % 2] = all_zero[i % 2] && c == 0;
    all_text[i % 2] = all_text[i % 2] && (c == '\t' || c == '\n' || c == '\r' || (c >= ' ' && c < 127));
  }
  return (all_zero[0] && all_text[1]) || (all_zero[1] && all_text[0]);
}

}  // namespace

bool is_lfs_pointer(std::string_view bytes) {
  return bytes.starts_with("version https://git-lfs.github.com/spec/");
}

std::string foreign_content(std::string_view bytes, std::string_view extension) {
  if (is_lfs_pointer(bytes)) return std::string(lfs_remedy);
  for (const Signature& signature : signatures)
    if (bytes.starts_with(signature.begin) && !is_allowed(signature, extension)) return std::string(signature.problem);
  if (is_wide_text(bytes)) return "is text in UTF-16; save it as UTF-8";
  if (!bytes.empty() && bytes.find_first_not_of('\0') == bytes.npos)
    return "holds nothing but zero bytes; copy it again";
  constexpr std::string_view before_tags = " \t\r\n\xef\xbb\xbf";
  const std::string start = small_letters(bytes.substr(0, looked_at));
  const std::size_t first = start.find_first_not_of(before_tags);
  if (first == start.npos) return {};
  if (start[first] == '{' && extension != ".gltf" && extension != ".glb")
    return start.find("\"asset\"") != start.npos ? "is a glTF file; name it .gltf" : "is JSON, and no mesh";
  if (start[first] != '<') return {};
  for (const Signature& tag : tag_signatures)
    if (start.find(tag.begin) != start.npos && !is_allowed(tag, extension)) return std::string(tag.problem);
  return {};
}

}  // namespace morula::detail
