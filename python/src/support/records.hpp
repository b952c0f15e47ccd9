// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Records: reports and results of the library as Python classes with attributes, to_dict(), comparison and a printed
// form.
#pragma once

#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "calls.hpp"
#include "docstrings.hpp"

namespace morula::python {

/// Methods of a record that use the names of its fields; records.cpp.
nb::dict to_dict(nb::handle record);
nb::str to_text(nb::handle record);
nb::object equals(nb::handle a, nb::handle b);
/// Rows of a table of columns: a row as a dict for an index; for slices, masks and lists a dict of arrays.
nb::object rows(nb::handle columns, nb::handle index);
nb::object rows_one_by_one(nb::handle columns);

/// Makers of a record: functions alone, which return it, or also calls of its class.
enum class MadeBy { functions, calls };

/// A class whose fields are bound one by one.
template <class T>
class Record {
 public:
  Record(nb::module_& m, const char* name, const char* text, MadeBy made_by = MadeBy::functions)
      : class_(made_by == MadeBy::calls ? nb::class_<T>(m, name, text)
                                        : nb::class_<T>(m, name, only_returned(), text)) {
    class_
        .def(
            "to_dict", [](nb::handle self) { return to_dict(self); },
            nb::sig("def to_dict(self) -> dict[str, typing.Any]"), "All attributes, by name; records within as dicts.")
        .def("__repr__", [](nb::handle self) { return to_text(self); })
        .def(
            "__eq__", [](nb::handle self, nb::handle other) { return equals(self, other); }, nb::arg("other").none(),
            nb::sig("def __eq__(self, other: object, /) -> bool"));
  }
  ~Record() { class_.attr("_fields") = nb::tuple(names_); }
  Record(const Record&) = delete;

  template <class Member, class From>
  Record& field(const char* name, Member From::*member, const char* text = "") {
    class_.def_prop_ro(
        name, [member](const T& self) -> Member { return self.*member; }, nb::rv_policy::automatic, text);
    names_.append(name);
    return *this;
  }
  template <class Get>
  Record& property(const char* name, const Get& get, const char* text = "") {
    class_.def_prop_ro(name, get, nb::rv_policy::automatic, text);
    names_.append(name);
    return *this;
  }
  /// Prints these fields alone, lists by their lengths: for records that hold many others.
  Record& shown(std::initializer_list<const char*> names) {
    nb::list all;
    for (const char* name : names) all.append(name);
    class_.attr("_shown") = nb::tuple(all);
    return *this;
  }
  /// The class, for methods and properties in addition to the fields.
  nb::class_<T>& python() { return class_; }
  /// The record is a table: its fields are columns of one length.
  template <class Length>
  Record& table(const Length& length) {
    class_.def("__len__", length);
    class_.def(
        "__getitem__", [](nb::handle self, nb::handle index) { return rows(self, index); }, nb::arg("index"),
        nb::sig("def __getitem__(self, index: object, /) -> dict[str, typing.Any]"),
        "An index gives one row; a slice, a mask or an array of indices gives the columns of these rows.");
    class_.def(
        "__iter__", [](nb::handle self) { return rows_one_by_one(self); },
        nb::sig("def __iter__(self) -> collections.abc.Iterator[dict[str, typing.Any]]"), "One row after the other.");
    return *this;
  }

 private:
  nb::class_<T> class_;
  nb::list names_;
};

/// A docstring with the types of the arguments.
inline std::string with_arguments(const char* text,
                                  std::initializer_list<std::pair<const char*, const char*>> arguments) {
  std::string all = text;
  all += "\n\nArgs:";
  for (const auto& [name, meaning] : arguments) all += std::string("\n    ") + name + ": " + meaning;
  return all;
}

}  // namespace morula::python
