// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "records.hpp"

namespace morula::python {

namespace {

bool is_record(nb::handle value) {
  return nb::hasattr(value, "_fields") && nb::hasattr(value, "to_dict");
}

nb::object plain(nb::handle value) {
  if (is_record(value)) return to_dict(value);
  if (PyList_Check(value.ptr())) {
    nb::list list;
    for (nb::handle item : nb::borrow<nb::list>(value)) list.append(plain(item));
    return list;
  }
  return nb::borrow(value);
}

bool same(nb::handle a, nb::handle b) {
  if (nb::hasattr(a, "dtype")) {
    return nb::cast<bool>(nb::module_::import_("numpy").attr("array_equal")(a, b));
  }
  return a.equal(b);
}

}  // namespace

nb::dict to_dict(nb::handle record) {
  nb::dict fields;
  for (nb::handle name : nb::borrow<nb::tuple>(nb::object(record.attr("_fields"))))
    fields[name] = plain(record.attr(nb::str(name)));
  return fields;
}

nb::str to_text(nb::handle record) {
  std::string text = nb::cast<std::string>(nb::object(nb::handle(record.type()).attr("__name__"))) + "(";
  const bool in_short = nb::hasattr(record, "_shown");
  bool first = true;
  for (nb::handle name : nb::borrow<nb::tuple>(nb::object(record.attr(in_short ? "_shown" : "_fields")))) {
    const nb::object value = record.attr(nb::str(name));
    text += (first ? "" : ", ") + nb::cast<std::string>(nb::str(name)) + "=";
    first = false;
    if (nb::hasattr(value, "dtype"))
      text += "<" + nb::cast<std::string>(nb::str(nb::object(value.attr("shape")))) + ">";
    else if (in_short && PyList_Check(value.ptr()))
      text += "<" + std::to_string(nb::len(value)) + ">";
    else
      text += nb::cast<std::string>(nb::repr(value));
  }
  return nb::str((text + ")").c_str());
}

nb::object equals(nb::handle a, nb::handle b) {
  if (!a.type().is(b.type())) return nb::borrow(nb::handle(Py_NotImplemented));
  for (nb::handle name : nb::borrow<nb::tuple>(nb::object(a.attr("_fields")))) {
    if (!same(nb::object(a.attr(nb::str(name))), nb::object(b.attr(nb::str(name))))) return nb::bool_(false);
  }
  return nb::bool_(true);
}

nb::object rows(nb::handle columns, nb::handle index) {
  nb::dict result;
  for (nb::handle name : nb::borrow<nb::tuple>(nb::object(columns.attr("_fields")))) {
    const nb::object column = columns.attr(nb::str(name));
    if (nb::hasattr(column, "dtype")) result[name] = column[index];
  }
  return result;
}

nb::object rows_one_by_one(nb::handle columns) {
  PyObject* iterator = PySeqIter_New(columns.ptr());
  if (!iterator) throw nb::python_error();
  return nb::steal(iterator);
}

}  // namespace morula::python
