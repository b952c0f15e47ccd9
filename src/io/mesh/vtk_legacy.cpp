// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// VTK's legacy files, .vtk: polygons and unstructured grids, text and binary, up to version 5.1.
#include <algorithm>
#include <cctype>
#include <limits>
#include <optional>

#include "io/mesh/cells.hpp"
#include "io/mesh/formats.hpp"
#include "io/mesh/mixed_reader.hpp"
#include "io/whole_file.hpp"

namespace morula::detail {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return result;
}

enum class Number { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

std::optional<Number> number_type(std::string_view name) {
  constexpr std::pair<std::string_view, Number> names[] = {{"float", Number::float32},
                                                           {"double", Number::float64},
                                                           {"int", Number::int32},
                                                           {"vtkidtype", Number::int32},
                                                           {"vtktypeint64", Number::int64},
                                                           {"vtktypeint32", Number::int32},
                                                           {"vtktypeuint64", Number::uint64},
                                                           {"vtktypeuint32", Number::uint32},
                                                           {"long", Number::int64},
                                                           {"unsigned_long", Number::uint64},
                                                           {"unsigned_int", Number::uint32},
                                                           {"short", Number::int16},
                                                           {"unsigned_short", Number::uint16},
                                                           {"char", Number::int8},
                                                           {"signed_char", Number::int8},
                                                           {"unsigned_char", Number::uint8}};
  for (const auto& [known, type] : names)
    if (known == name) return type;
  return std::nullopt;
}

std::size_t byte_size(Number type) {
  switch (type) {
    case Number::int8:
    case Number::uint8:
      return 1;
    case Number::int16:
    case Number::uint16:
      return 2;
    case Number::int32:
    case Number::uint32:
    case Number::float32:
      return 4;
    default:
      return 8;
  }
}

class LegacyReader {
 public:
  LegacyReader(const std::filesystem::path& path, std::string_view bytes) : in_(path, bytes) {}

  Mesh read(MeshReading& reading) {
    read_header();
    if (lower(in_.word()) != "dataset") in_.fail("a line 'DATASET' should be here");
    const std::string kind = lower(in_.require_word("the kind of data"));
    if (kind != "polydata" && kind != "unstructured_grid")
      in_.fail(in_quotes(kind) +
               " is a dataset without a surface of its own; save POLYDATA or UNSTRUCTURED_GRID (in ParaView: extract "
               "the surface)");
    while (read_part()) {
    }
    if (!has_points_) in_.fail("the file ends before its POINTS; it was cut short");
    if (!types_.empty() || !cells_.empty()) add_cells();
    mesh_.facets = surface_.facets(mesh_.positions, reading);
    return std::move(mesh_);
  }

 private:
  void read_header() {
    const std::string_view first = in_.line();
    constexpr std::string_view begin = "# vtk DataFile Version ";
    if (first.substr(0, begin.size()) != begin)
      in_.fail("a VTK file begins with a line '# vtk DataFile Version …'; .vtu and .vtp are for XML");
    in_.line();  // the title
    const std::string mode = lower(in_.word());
    if (mode == "binary") {
      is_binary_ = true;
    } else if (mode != "ascii") {
      in_.fail(in_quotes(mode) + " is neither ASCII nor BINARY");
    }
  }

  // Numbers of a block: they begin on the line after the words that announce them.
  void begin_numbers() {
    in_.line();
    if (is_binary_) in_.set_binary(std::endian::big);
  }

  double number(Number type, std::string_view what) {
    switch (type) {
      case Number::float32:
        return in_.number<float>(what);
      case Number::float64:
        return in_.number<double>(what);
      default:
        return static_cast<double>(integer(type, what));
    }
  }

  std::int64_t integer(Number type, std::string_view what) {
    switch (type) {
      case Number::int8:
        return in_.integer<std::int8_t>(what);
      case Number::uint8:
        return in_.integer<std::uint8_t>(what);
      case Number::int16:
        return in_.integer<std::int16_t>(what);
      case Number::uint16:
        return in_.integer<std::uint16_t>(what);
      case Number::int32:
        return in_.integer<std::int32_t>(what);
      case Number::uint32:
        return in_.integer<std::uint32_t>(what);
      case Number::int64:
      case Number::uint64:  // no relevant number has the highest bit
        return in_.integer<std::int64_t>(what);
      default:
        in_.fail(std::string(what) + " is no whole number by its type");
    }
  }

  Number require_type() {
    const std::string name = lower(in_.require_word("a type of numbers"));
    const std::optional<Number> type = number_type(name);
    if (!type) in_.fail("numbers of type " + in_quotes(name) + " are not read");
    return *type;
  }

  std::size_t room(std::uint64_t count, Number type, std::string_view what) const {
    return in_.require_room(count, is_binary_ ? byte_size(type) : 2, what);
  }

  /// Returns false at the end of the parts that describe the shape.
  bool read_part() {
    const std::string keyword = lower(in_.word());
    if (keyword.empty() || keyword == "point_data" || keyword == "cell_data") return false;
    if (keyword == "points") {
      read_points();
    } else if (keyword == "polygons") {
      read_lists({CellShape::polygon, 0}, true);
    } else if (keyword == "triangle_strips") {
      read_lists({CellShape::strip, 0}, true);
    } else if (keyword == "vertices" || keyword == "lines") {
      read_lists({CellShape::none, 0}, true);
    } else if (keyword == "cells") {
      read_lists({}, false);
    } else if (keyword == "cell_types") {
      read_types();
    } else if (keyword == "field") {
      skip_field();
    } else if (keyword == "metadata") {
      in_.line();
      while (in_.bytes_left() > 0 && !in_.line().empty()) {
      }
    } else {
      in_.fail(in_quotes(keyword) + " is not a part of this dataset that is known");
    }
    return true;
  }

  void read_points() {
    if (has_points_) in_.fail("a second list of POINTS");
    has_points_ = true;
    const std::uint64_t count = in_.text_count("the number of points");
    const Number type = require_type();
    begin_numbers();
    if (count > std::numeric_limits<std::uint32_t>::max()) in_.fail("more points than 32 bits count");
    mesh_.positions.reserve(in_.require_room(count, is_binary_ ? 3 * byte_size(type) : 6, "points"));
    for (std::uint64_t i = 0; i < count; ++i) {
      in_.begin_row();
      const double x = number(type, "x"), y = number(type, "y");
      mesh_.positions.push_back({x, y, number(type, "z")});
    }
  }

  std::uint32_t corner(Number type) {
    const std::int64_t vertex = integer(type, "a point of a cell");
    if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= mesh_.vertex_count())
      in_.fail("a cell refers to point " + std::to_string(vertex) + ", but the file has " +
               std::to_string(mesh_.vertex_count()) + " points, counted from 0");
    return static_cast<std::uint32_t>(vertex);
  }

  /// Cells as lists of points. adds: the cells have this type; otherwise their types come later.
  void read_lists(CellType type, bool adds) {
    if (!has_points_) in_.fail("cells come before the POINTS");
    const std::uint64_t first = in_.text_count("the number of cells"), second = in_.text_count("the size of the list");
    in_.line();
    // Binary numbers spell the word only if the first cell has two billion points.
    if (lower(in_.peek().substr(0, 8)) == "offsets") {
      read_offsets(type, adds, first, second);
      return;
    }
    if (is_binary_) in_.set_binary(std::endian::big);
    room(second, Number::int32, "numbers of cells");
    std::uint64_t used = 0;
    for (std::uint64_t i = 0; i < first; ++i) {
      in_.begin_row();
      const std::int64_t corners = integer(Number::int32, "the number of points of a cell");
      if (corners < 0 || static_cast<std::uint64_t>(corners) + 1 > second - used)
        in_.fail("a cell of " + std::to_string(corners) + " points does not fit into a list of " +
                 std::to_string(second) + " numbers; the counts are wrong");
      used += static_cast<std::uint64_t>(corners) + 1;
      corners_.clear();
      for (std::int64_t k = 0; k < corners; ++k) corners_.push_back(corner(Number::int32));
      take(type, adds);
    }
    if (used != second)
      in_.fail("the cells take " + std::to_string(used) + " numbers, but the list has " + std::to_string(second));
  }

  void read_offsets(CellType type, bool adds, std::uint64_t offset_count, std::uint64_t corner_count) {
    in_.word();
    const Number offset_type = require_type();
    begin_numbers();
    std::vector<std::int64_t> offsets;
    offsets.reserve(room(offset_count, offset_type, "offsets"));
    for (std::uint64_t i = 0; i < offset_count; ++i) {
      in_.begin_row();
      const std::int64_t offset = integer(offset_type, "an offset");
      const std::int64_t least = offsets.empty() ? 0 : offsets.back();
      if (offset < least || static_cast<std::uint64_t>(offset) > corner_count || (offsets.empty() && offset != 0))
        in_.fail("offset " + std::to_string(offset) + " is out of place; offsets go up from 0 to " +
                 std::to_string(corner_count));
      offsets.push_back(offset);
    }
    if (!offsets.empty() && static_cast<std::uint64_t>(offsets.back()) != corner_count)
      in_.fail("the offsets end at " + std::to_string(offsets.back()) + ", but there are " +
               std::to_string(corner_count) + " points of cells");
    if (lower(in_.word()) != "connectivity") in_.fail("'CONNECTIVITY' should be here");
    const Number corner_type = require_type();
    begin_numbers();
    room(corner_count, corner_type, "points of cells");
    for (std::size_t i = 1; i < offsets.size(); ++i) {
      in_.begin_row();
      corners_.clear();
      for (std::int64_t k = offsets[i - 1]; k < offsets[i]; ++k) corners_.push_back(corner(corner_type));
      take(type, adds);
    }
  }

  void take(CellType type, bool adds) {
    if (!adds) {
      cells_.push_back({kept_.size(), corners_.size()});
      kept_.insert(kept_.end(), corners_.begin(), corners_.end());
      return;
    }
    add(type, corners_);
  }

  void add(CellType type, std::span<const std::uint32_t> corners) {
    const std::size_t least = type.corners != 0 ? type.corners : type.shape == CellShape::none ? 0 : 3;
    if (corners.size() < least)
      in_.fail("a cell has " + std::to_string(corners.size()) + " points, fewer than " + std::to_string(least) +
               "; remove it or complete it");
    surface_.add(type, corners);
  }

  void read_types() {
    if (!types_.empty()) in_.fail("a second list of CELL_TYPES");
    const std::uint64_t count = in_.text_count("the number of cells");
    begin_numbers();
    types_.reserve(room(count, Number::int32, "types of cells"));
    for (std::uint64_t i = 0; i < count; ++i) {
      in_.begin_row();
      types_.push_back(integer(Number::int32, "a type of cell"));
    }
  }

  void add_cells() {
    if (types_.size() != cells_.size())
      in_.fail("the file has " + std::to_string(cells_.size()) + " CELLS, but " + std::to_string(types_.size()) +
               " CELL_TYPES");
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      in_.begin_row();
      CellType type{};
      if (types_[i] < 0 || !vtk_cell_type(static_cast<std::uint64_t>(types_[i]), type))
        in_.fail("cell " + std::to_string(i) + " is of type " + std::to_string(types_[i]) +
                 ", which is not read; save linear or quadratic cells");
      add(type, std::span(kept_).subspan(cells_[i].first, cells_[i].count));
    }
  }

  void skip_field() {
    in_.require_word("the name of a field");
    const std::uint64_t arrays = in_.text_count("the number of arrays");
    in_.require_room(arrays, 8, "arrays");
    for (std::uint64_t i = 0; i < arrays; ++i) {
      in_.require_word("the name of an array");
      const std::uint64_t components = in_.text_count("the number of components"),
                          rows = in_.text_count("the number of rows");
      const std::string name = lower(in_.require_word("a type of numbers"));
      const std::optional<Number> type = number_type(name);
      if (!type) in_.fail("an array of " + in_quotes(name) + " is not read; save the file without its fields");
      in_.line();
      if (components != 0 && rows > in_.bytes_left() / components) in_.require_room(rows, 1, "rows of an array");
      const std::uint64_t numbers = components * rows;
      if (is_binary_) {
        in_.set_binary(std::endian::big);
        room(numbers, *type, "numbers of an array");
        in_.skip_bytes(numbers * byte_size(*type), "an array");
      } else {
        room(numbers, *type, "numbers of an array");
        for (std::uint64_t k = 0; k < numbers; ++k) in_.require_word("an array");
      }
    }
  }

  struct Cell {
    std::size_t first, count;
  };

  MixedReader in_;
  bool is_binary_ = false, has_points_ = false;
  Mesh mesh_;
  CellSurface surface_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> kept_, corners_;
  std::vector<std::int64_t> types_;
};

}  // namespace

Mesh read_vtk(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  return LegacyReader(path, bytes).read(reading);
}

}  // namespace morula::detail
