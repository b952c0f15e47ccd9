// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Gmsh's .msh, versions 2.2, 4.0 and 4.1, text and binary: nodes in the order of the file, and the surface of the
// elements.
#include <limits>
#include <unordered_map>

#include "io/byte_reader.hpp"
#include "io/mesh/cells.hpp"
#include "io/mesh/formats.hpp"
#include "io/mesh/mixed_reader.hpp"
#include "io/whole_file.hpp"

namespace morula::detail {
namespace {

struct ElementType {
  CellType cell;
  std::size_t nodes;
};

/// Sets the type for Gmsh's number. Elements of higher order have their corners first.
bool element_type(std::int64_t number, ElementType& type) {
  constexpr CellType line{CellShape::none, 0}, triangle{CellShape::polygon, 3}, quad{CellShape::polygon, 4},
      tetrahedron{CellShape::tetrahedron, 4}, hexahedron{CellShape::hexahedron, 8}, wedge{CellShape::wedge, 6},
      pyramid{CellShape::pyramid, 5};
  struct Row {
    std::int64_t number;
    ElementType type;
  };
  static constexpr Row rows[] = {
      {1, {line, 2}},          {2, {triangle, 3}},   {3, {quad, 4}},          {4, {tetrahedron, 4}},
      {5, {hexahedron, 8}},    {6, {wedge, 6}},      {7, {pyramid, 5}},       {8, {line, 3}},
      {9, {triangle, 6}},      {10, {quad, 9}},      {11, {tetrahedron, 10}}, {12, {hexahedron, 27}},
      {13, {wedge, 18}},       {14, {pyramid, 14}},  {15, {line, 1}},         {16, {quad, 8}},
      {17, {hexahedron, 20}},  {18, {wedge, 15}},    {19, {pyramid, 13}},     {20, {triangle, 9}},
      {21, {triangle, 10}},    {22, {triangle, 12}}, {23, {triangle, 15}},    {26, {line, 4}},
      {27, {line, 5}},         {28, {line, 6}},      {29, {tetrahedron, 20}}, {30, {tetrahedron, 35}},
      {31, {tetrahedron, 56}}, {36, {quad, 16}},     {92, {hexahedron, 64}}};
  for (const Row& row : rows) {
    if (row.number != number) continue;
    type = row.type;
    return true;
  }
  return false;
}

// MuJoCo's meshes have the same extension: counts of vertices, normals, texture coordinates and facets, then these
// data.
bool has_size_of_mujoco_mesh(std::string_view bytes) {
  constexpr std::size_t head = 16;
  if (bytes.size() < head) return false;
  const auto count = [&](std::size_t i) { return std::uint64_t{load<std::uint32_t>(bytes.data() + 4 * i)}; };
  return head + 12 * (count(0) + count(1) + count(3)) + 8 * count(2) == bytes.size();
}

class GmshReader {
 public:
  GmshReader(const std::filesystem::path& path, std::string_view bytes)
      : in_(path, bytes), is_mujoco_(has_size_of_mujoco_mesh(bytes)) {}

  Mesh read(MeshReading& reading) {
    if (is_mujoco_) in_.fail("is a mesh of MuJoCo, which its robots are read with; save it as OBJ or STL");
    if (in_.line() != "$MeshFormat") in_.fail("a Gmsh file begins with a line '$MeshFormat'");
    read_format();
    bool has_nodes = false, has_elements = false;
    for (std::string_view section = next_section(); !section.empty(); section = next_section()) {
      if (section == "$Nodes") {
        if (has_nodes) in_.fail("a second section '$Nodes'; write one");
        is_new_ ? read_nodes_4() : read_nodes_2();
        has_nodes = true;
      } else if (section == "$Elements") {
        if (!has_nodes) in_.fail("'$Elements' comes before '$Nodes'; write the nodes first");
        if (has_elements) in_.fail("a second section '$Elements'; write one");
        is_new_ ? read_elements_4() : read_elements_2();
        has_elements = true;
      } else {
        skip_section(section);
        continue;
      }
      const std::string end = "$End" + std::string(section.substr(1));
      if (in_.word() != end) in_.fail(in_quotes(end) + " does not follow the last entry; its counts are wrong");
    }
    if (!has_nodes) in_.fail("the file ends before a section '$Nodes'; it was cut short");
    if (!has_elements) in_.fail("the file ends before a section '$Elements'; it was cut short");
    mesh_.facets = cells_.facets(mesh_.positions, reading);
    return std::move(mesh_);
  }

 private:
  void read_format() {
    const std::string_view version = in_.require_word("the version");
    if (version == "4.1" || version == "4" || version == "4.0") {
      is_new_ = true;
      is_4_0_ = version != "4.1";
    } else if (version != "2.2" && version != "2" && version != "2.1") {
      in_.fail("version " + in_quotes(version) + " is not read; save the mesh as version 2.2, 4.0 or 4.1");
    }
    const std::uint64_t binary = in_.text_count("the type of file"), size = in_.text_count("the size of numbers");
    if (binary > 1) in_.fail("type of file " + std::to_string(binary) + " is neither 0, text, nor 1, binary");
    if (size != 8) in_.fail("numbers of " + std::to_string(size) + " bytes are not read; save the mesh with 8");
    in_.line();
    if (binary == 1) {
      in_.set_binary(std::endian::little);
      const std::int64_t one = in_.integer<std::int32_t>("the number that marks the order of bytes");
      if (one == 0x01000000) {
        in_.set_binary(std::endian::big);
      } else if (one != 1) {
        in_.fail("the number that marks the order of bytes is " + std::to_string(one) + ", not 1");
      }
    }
    if (in_.word() != "$EndMeshFormat") in_.fail("'$EndMeshFormat' does not follow the format");
  }

  /// The next line that begins with $; text between sections belongs to none.
  std::string_view next_section() {
    const std::string_view section = in_.word();
    if (!section.empty() && section[0] != '$') in_.fail(in_quotes(section) + " stands where a section should begin");
    if (!section.empty()) in_.line();
    return section;
  }

  void skip_section(std::string_view section) {
    const std::string end = "$End" + std::string(section.substr(1));
    // Data of binary files may hold any bytes, also line ends: the end of the section is searched for.
    const std::size_t found = in_.find(end);
    if (found == std::string_view::npos) in_.fail("the file ends inside " + in_quotes(section) + "; it was cut short");
    in_.seek(found + end.size());
  }

  std::uint64_t count(std::string_view what) {
    const std::int64_t value = in_.integer<std::int64_t>(what);
    if (value < 0) in_.fail(std::string(what) + " is " + std::to_string(value) + ", less than none");
    return static_cast<std::uint64_t>(value);
  }

  void add_node(std::int64_t tag, const Vec3& p) {
    in_.begin_row();
    if (mesh_.vertex_count() == std::numeric_limits<std::uint32_t>::max()) in_.fail("more nodes than 32 bits count");
    if (!index_of_.emplace(tag, static_cast<std::uint32_t>(mesh_.vertex_count())).second)
      in_.fail("two nodes have the number " + std::to_string(tag) + "; renumber them");
    mesh_.positions.push_back(p);
  }

  Vec3 position() {
    const double x = in_.number<double>("x"), y = in_.number<double>("y");
    return {x, y, in_.number<double>("z")};
  }

  void read_nodes_2() {
    const std::uint64_t total = in_.text_count("the number of nodes");
    in_.line();
    mesh_.positions.reserve(in_.require_room(total, in_.is_binary() ? 28 : 8, "nodes"));
    for (std::uint64_t i = 0; i < total; ++i) {
      const std::int64_t tag = in_.integer<std::int32_t>("the number of a node");
      add_node(tag, position());
    }
  }

  /// Reads the entity's number and dimension of a block, in the order of the version.
  std::int64_t entity_dimension() {
    if (is_4_0_) in_.integer<std::int32_t>("the number of an entity");
    const std::int64_t dimension = in_.integer<std::int32_t>("the dimension of an entity");
    if (!is_4_0_) in_.integer<std::int32_t>("the number of an entity");
    return dimension;
  }

  void read_nodes_4() {
    const std::uint64_t blocks = count("the number of blocks"), total = count("the number of nodes");
    if (!is_4_0_) {
      count("the least number of a node");
      count("the largest number of a node");
    }
    mesh_.positions.reserve(in_.require_room(total, in_.is_binary() ? (is_4_0_ ? 28 : 32) : 8, "nodes"));
    std::vector<std::int64_t> tags;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::int64_t dimension = entity_dimension();
      const std::int64_t parametric = in_.integer<std::int32_t>("whether nodes have parameters");
      const std::uint64_t nodes = count("the number of nodes of a block");
      if (dimension < 0 || dimension > 3)
        in_.fail("an entity of dimension " + std::to_string(dimension) + "; entities have 0 to 3");
      if (nodes > total - mesh_.vertex_count())
        in_.fail("blocks have more nodes than the " + std::to_string(total) + " that the section counts");
      const auto add = [&](std::int64_t tag) {
        add_node(tag, position());
        for (std::int64_t k = 0; parametric != 0 && k < dimension; ++k) in_.number<double>("a parameter");
      };
      // Each number comes with its coordinates, or all numbers come first.
      for (std::uint64_t i = 0; is_4_0_ && i < nodes; ++i) add(in_.integer<std::int32_t>("the number of a node"));
      if (is_4_0_) continue;
      tags.clear();
      for (std::uint64_t i = 0; i < nodes; ++i) {
        in_.begin_row();
        tags.push_back(in_.integer<std::int64_t>("the number of a node"));
      }
      for (const std::int64_t tag : tags) add(tag);
    }
    if (mesh_.vertex_count() != total)
      in_.fail("blocks have " + std::to_string(mesh_.vertex_count()) + " nodes, but the section counts " +
               std::to_string(total));
  }

  ElementType known_type(std::int64_t number) const {
    ElementType type{};
    if (!element_type(number, type))
      in_.fail("elements of type " + std::to_string(number) + " are not read; save the mesh with lower order");
    return type;
  }

  template <class Value>
  void read_corners(const ElementType& type) {
    in_.begin_row();
    corners_.clear();
    for (std::size_t k = 0; k < type.nodes; ++k) {
      const std::int64_t tag = in_.integer<Value>("a node of an element");
      const auto found = index_of_.find(tag);
      if (found == index_of_.end())
        in_.fail("an element refers to node " + std::to_string(tag) + ", which the file does not have");
      corners_.push_back(found->second);
    }
    cells_.add(type.cell, corners_);
  }

  void read_elements_2() {
    const std::uint64_t total = in_.text_count("the number of elements");
    in_.line();
    in_.require_room(total, in_.is_binary() ? 8 : 6, "elements");
    for (std::uint64_t done = 0; done < total;) {
      // In text every element has its type; in binary a header gives the number of consecutive elements of one type.
      std::uint64_t block = 1;
      std::int64_t number = 0, tags = 0;
      if (in_.is_binary()) {
        number = in_.integer<std::int32_t>("the type of elements");
        const std::int64_t follow = in_.integer<std::int32_t>("the number of elements of a type");
        tags = in_.integer<std::int32_t>("the number of tags");
        if (follow < 1 || static_cast<std::uint64_t>(follow) > total - done)
          in_.fail("a block of " + std::to_string(follow) + " elements, where " + std::to_string(total - done) +
                   " are left; the counts are wrong");
        block = static_cast<std::uint64_t>(follow);
      }
      for (std::uint64_t i = 0; i < block; ++i, ++done) {
        in_.integer<std::int32_t>("the number of an element");
        if (!in_.is_binary()) {
          number = in_.integer<std::int32_t>("the type of an element");
          tags = in_.integer<std::int32_t>("the number of tags");
        }
        if (tags < 0) in_.fail("an element has " + std::to_string(tags) + " tags");
        in_.require_room(static_cast<std::uint64_t>(tags), in_.is_binary() ? 4 : 2, "tags");
        for (std::int64_t k = 0; k < tags; ++k) in_.integer<std::int32_t>("a tag");
        read_corners<std::int32_t>(known_type(number));
      }
    }
  }

  void read_elements_4() {
    const std::uint64_t blocks = count("the number of blocks"), total = count("the number of elements");
    if (!is_4_0_) {
      count("the least number of an element");
      count("the largest number of an element");
    }
    in_.require_room(total, in_.is_binary() ? (is_4_0_ ? 8 : 16) : 4, "elements");
    std::uint64_t done = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      entity_dimension();
      const ElementType type = known_type(in_.integer<std::int32_t>("the type of elements"));
      const std::uint64_t elements = count("the number of elements of a block");
      if (elements > total - done)
        in_.fail("blocks have more elements than the " + std::to_string(total) + " that the section counts");
      for (std::uint64_t i = 0; i < elements; ++i, ++done) {
        if (is_4_0_) {
          in_.integer<std::int32_t>("the number of an element");
          read_corners<std::int32_t>(type);
        } else {
          in_.integer<std::int64_t>("the number of an element");
          read_corners<std::int64_t>(type);
        }
      }
    }
    if (done != total)
      in_.fail("blocks have " + std::to_string(done) + " elements, but the section counts " + std::to_string(total));
  }

  MixedReader in_;
  bool is_mujoco_;
  bool is_new_ = false, is_4_0_ = false;
  Mesh mesh_;
  CellSurface cells_;
  std::unordered_map<std::int64_t, std::uint32_t> index_of_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

Mesh read_gmsh(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  return GmshReader(path, bytes).read(reading);
}

}  // namespace morula::detail
