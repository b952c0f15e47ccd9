// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Texts of the library that may name files.
#pragma once

#include <nanobind/nanobind.h>

#include <string_view>

namespace morula::python {

namespace nb = nanobind;

/// A message or a name as Python's text. Bytes that are not UTF-8, which names of files may have, become what
/// os.fsdecode makes of them.
inline nb::object python_text(std::string_view text) {
  return nb::steal(PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
}

}  // namespace morula::python
