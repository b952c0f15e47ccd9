# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# The evaluators in GLSL and WGSL as C++ over shader_types.hpp: words are replaced, and no expression is changed.

# morula_shader_as_cpp(SOURCE RESULT): by the ending of SOURCE.
function(morula_shader_as_cpp source result)
  file(READ "${source}" text)
  string(REGEX REPLACE "//[^\n]*" "" text "${text}")
  string(REPLACE "return SkinBounds(" "return made(SkinBounds{}, " text "${text}")
  if(source MATCHES "[.]wgsl$")
    string(REGEX REPLACE "([a-z_]+): ([A-Za-z0-9_]+)" "\\2 \\1" text "${text}")
    string(REGEX REPLACE "fn ([a-z_]+)\\(([^)]*)\\) -> ([A-Za-z0-9]+) {" "inline \\3 \\1(\\2) {" text "${text}")
    string(REGEX REPLACE "(\n  [A-Za-z0-9]+ [a-z_]+)," "\\1;" text "${text}")
    string(REGEX REPLACE "(struct [A-Za-z]+ {[^}]*})" "\\1;" text "${text}")
    string(REGEX REPLACE "let ([a-z_]+) =" "const auto \\1 =" text "${text}")
    string(REGEX REPLACE "var ([a-z_]+) =" "auto \\1 =" text "${text}")
    string(REPLACE ".xyz" ".xyz()" text "${text}")
  endif()
  file(CONFIGURE OUTPUT "${result}" CONTENT "${text}" @ONLY)
endfunction()
