# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# PAGE shows EXAMPLE as it is, from its first include on.
cmake_minimum_required(VERSION 3.24)

file(READ "${EXAMPLE}" example)
file(READ "${PAGE}" page)
string(FIND "${example}" "#include" begin)
string(SUBSTRING "${example}" ${begin} -1 text)
string(FIND "${page}" "```cpp\n${text}```" found)
if(found EQUAL -1)
  message(FATAL_ERROR "${PAGE} does not show the text of ${EXAMPLE}")
endif()
