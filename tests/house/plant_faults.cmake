# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# Plants faults in a small tree of files and expects the checks to name each of them, and nothing in a sound tree.
# Run as: cmake -D CHECKS=folder -D FOLDER=scratch -P plant_faults.cmake
cmake_minimum_required(VERSION 3.24)

set(license "// SPDX-FileCopyrightText: 2026 The Morula authors\n// SPDX-License-Identifier: Apache-2.0\n")

# run(CHECK EXPECTED_RESULT TEXTS...): runs a check over FOLDER; its output has to hold all the texts.
function(run check expected)
  execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${FOLDER} -P "${CHECKS}/${check}.cmake"
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if((expected STREQUAL "passes") AND NOT result EQUAL 0)
    message(FATAL_ERROR "${check} complains about a sound tree:\n${output}")
  elseif((expected STREQUAL "fails") AND result EQUAL 0)
    message(FATAL_ERROR "${check} finds nothing wrong:\n${output}")
  endif()
  foreach(text IN LISTS ARGN)
    string(FIND "${output}" "${text}" position)
    if(position LESS 0)
      message(FATAL_ERROR "${check} does not say '${text}', but:\n${output}")
    endif()
  endforeach()
endfunction()

file(REMOVE_RECURSE "${FOLDER}")
file(WRITE "${FOLDER}/include/morula/morula.hpp" "${license}#include <morula/update/body.hpp>\n")
file(WRITE "${FOLDER}/include/morula/update/body.hpp" "${license}#include <morula/tree/cover.hpp>\n#include <vector>\n")
file(WRITE "${FOLDER}/include/morula/tree/cover.hpp" "${license}")
file(WRITE "${FOLDER}/src/tree/region.hpp" "${license}")
file(WRITE "${FOLDER}/src/update/body.cpp" "${license}#include \"tree/region.hpp\"\n")
file(WRITE "${FOLDER}/apps/morula/main.cpp" "${license}#include <morula/morula.hpp>\n#include \"table.hpp\"\n")
file(WRITE "${FOLDER}/apps/morula/table.hpp" "${license}")
file(WRITE "${FOLDER}/scripts/test" "#!/bin/sh\n# SPDX-FileCopyrightText: 2026 The Morula authors\n"
  "# SPDX-License-Identifier: Apache-2.0\n")
file(WRITE "${FOLDER}/docs/references.bib" "@article{welzl1991,\n}\n@book{ericson2005,\n}\n")
file(WRITE "${FOLDER}/src/tree/cover.cpp" "${license}// [ericson2005, 5.1.5] and [welzl1991]\n")
run(check_layers passes "4 includes point down")
run(check_license passes "9 files carry their license lines")
run(check_references passes "2 papers cited")
file(WRITE "${FOLDER}/src/tree/named.cpp" "${license}// As cover.hpp, tree/region.hpp and src/tree say; NAME_test.cpp, *.hpp and\n"
  "int x;  // 3/2 of body.hpp; the caller's a/b is none of ours\nconst char* text = \"nowhere.hpp\";\n")
file(WRITE "${FOLDER}/docs/explanation/tree.md" "[Covers](cover.md#why-a-cover-proves) [home](https://example.org/a.md) `src/update/body.cpp`; [](const X& x)\n")
file(WRITE "${FOLDER}/docs/explanation/cover.md" "# A cover\n\n```sh\n# no heading\n```\n\n## Why: `a cover` (proves)\n")
file(WRITE "${FOLDER}/README.md" "[docs/explanation/tree.md](docs/explanation/tree.md)\n")
run(check_names passes "8 names of files")
run(check_pages passes "3 pages")

file(WRITE "${FOLDER}/include/morula/tree/cover.hpp" "${license}# include <morula/generators/build.hpp>  // up\n")
file(WRITE "${FOLDER}/src/update/sideways.cpp" "${license}#include <morula/accuracy/measure.hpp>\n")
file(WRITE "${FOLDER}/include/morula/geometry/private.hpp" "${license}#include \"geometry/hash.hpp\"\n")
file(WRITE "${FOLDER}/src/geometry/everything.cpp" "${license}#include <morula/morula.hpp>\n")
file(WRITE "${FOLDER}/src/update/points/upward.inl" "${license}#include \"update/rules/exact.hpp\"\n")
file(WRITE "${FOLDER}/src/update/points/outward.hpp" "${license}#include \"update/body_state.hpp\"\n")
file(WRITE "${FOLDER}/src/update/attic/old.hpp" "${license}#include \"update/points/narrow.hpp\"\n")
file(WRITE "${FOLDER}/src/novelty/new.cpp" "${license}")
file(WRITE "${FOLDER}/apps/morula/private.cpp" "${license}#include <tree/region.hpp>\n")
file(WRITE "${FOLDER}/tests/consumer/path.cpp" "${license}#include \"../../src/tree/region.hpp\"\n")
file(WRITE "${FOLDER}/src/update/product.cpp" "${license}#include <morula/robot/fit.hpp>\n")
file(WRITE "${FOLDER}/extras/grains/src/clump.cpp" "${license}#include <morula/page/page.hpp>\n#include <morula/tree/cover.hpp>\n")
file(WRITE "${FOLDER}/extras/page/src/page.cpp" "${license}#include <toolbox/csv.hpp>\n#include \"update/body_state.hpp\"\n")
file(WRITE "${FOLDER}/extras/study/include/morula/study/study.hpp" "${license}#include <toolbox/csv.hpp>\n")
file(WRITE "${FOLDER}/extras/robot/src/fit/fit.hpp" "${license}")
file(WRITE "${FOLDER}/extras/robot/src/read/urdf.cpp" "${license}#include \"fit/fit.hpp\"\n")
file(WRITE "${FOLDER}/toolbox/csv.hpp" "${license}#include <morula/tree/cover.hpp>\n")
file(WRITE "${FOLDER}/apps/morula/product.cpp" "${license}#include <morula/page/page.hpp>\n")
run(check_layers fails
  "src/update/product.cpp includes <morula/robot/fit.hpp>: there is no folder robot in the library"
  "extras/grains/src/clump.cpp includes <morula/page/page.hpp>: the extra grains does not use page"
  "extras/page/src/page.cpp includes <toolbox/csv.hpp>: the extra page does not use toolbox"
  "extras/page/src/page.cpp includes \"update/body_state.hpp\": extras include private headers of"
  "extras/study/include/morula/study/study.hpp includes <toolbox/csv.hpp>: toolbox is private"
  "extras/robot/src/read/urdf.cpp includes \"fit/fit.hpp\": wings include themselves"
  "toolbox/csv.hpp includes <morula/tree/cover.hpp>: toolbox includes nothing of the library"
  "apps/morula/product.cpp includes <morula/page/page.hpp>: what an extra adds stands in extras/page/command"
  "include/morula/tree/cover.hpp includes <morula/generators/build.hpp>: generators is not below tree"
  "src/update/sideways.cpp includes <morula/accuracy/measure.hpp>: accuracy is not below update"
  "include/morula/geometry/private.hpp includes \"geometry/hash.hpp\": a public header may include public"
  "src/geometry/everything.cpp includes <morula/morula.hpp>: the library includes what it uses"
  "src/update/points/upward.inl includes \"update/rules/exact.hpp\": wings include themselves"
  "src/update/points/outward.hpp includes \"update/body_state.hpp\": wings include themselves"
  "src/update/attic/old.hpp includes \"update/points/narrow.hpp\": a wing without a place"
  "src/novelty/new.cpp: the folder novelty has no height"
  "apps/morula/private.cpp includes <tree/region.hpp>: a private header"
  "tests/consumer/path.cpp includes \"../../src/tree/region.hpp\": a private header"
  "18 includes break the layers")

file(WRITE "${FOLDER}/src/tree/named.cpp" "${license}// See gone.hpp [and] update/region.hpp; then\nint x;  // of src/attic/x\n")
file(WRITE "${FOLDER}/src/tree/named.inl" "${license}/// As lost.cpp has it.\n")
file(WRITE "${FOLDER}/scripts/run" "#!/bin/sh\n# Calls scripts/runn\n")
file(WRITE "${FOLDER}/docs/explanation/tree.md" "[One](one.md#why); [two](tree.md), [three](three.md), [four](cover.md#no-heading)\nand `src/update/corps.cpp`\n")
run(check_names fails
  "src/tree/named.cpp: gone.hpp"
  "src/tree/named.cpp: update/region.hpp"
  "src/tree/named.cpp: src/attic/x"
  "src/tree/named.inl: lost.cpp"
  "scripts/run: scripts/runn"
  "docs/explanation/tree.md: a link to one.md"
  "docs/explanation/tree.md: a link to three.md"
  "docs/explanation/tree.md: a link to cover.md#no-heading, no heading there"
  "docs/explanation/tree.md: src/update/corps.cpp")

# Only a nested type of a public one stands in namespace morula itself.
file(WRITE "${FOLDER}/src/update/state.hpp" "${license}namespace morula::detail {\n\nnamespace inner {\nint x;\n}  // namespace inner\n"
  "constexpr int list[] = {1, 2};\n\n}  // namespace morula::detail\nnamespace morula {\n\nstruct Body::State {\n  int x;\n};\n\n}  // namespace morula\n")
run(check_namespaces passes "private headers, nothing of theirs")
file(WRITE "${FOLDER}/src/update/open.hpp" "${license}namespace morula {\n\nnamespace inner {\nint deep;\n}  // namespace inner\n"
  "struct State {\n  int x;\n};\n\n}  // namespace morula\n")
file(WRITE "${FOLDER}/src/update/loop.inl" "${license}namespace morula {\nconst int list[] = {1};\n}  // namespace morula\n")
run(check_namespaces fails "src/update/open.hpp: struct State {" "src/update/loop.inl: const int list   = {1};")

string(REPEAT "word [a; b]\n" 834 many)
# The words of the first line are not read by who sees the picture.
file(WRITE "${FOLDER}/docs/explanation/tree.md" "![A limb; its spheres](../pictures/limb.svg)\n${many}")
file(WRITE "${FOLDER}/SECURITY.md" "${many}")
run(check_pages fails "docs/explanation/tree.md has 2502 words, 2500 at most" "SECURITY.md has 2502 words, 2500 at most")
file(REMOVE "${FOLDER}/SECURITY.md")
file(WRITE "${FOLDER}/docs/explanation/tree.md" "Short again.\n")
file(REMOVE "${FOLDER}/scripts/run")

file(WRITE "${FOLDER}/src/tree/bare.cpp" "int bare;\n")
file(WRITE "${FOLDER}/src/tree/bare.inl" "int bare;\n")
file(WRITE "${FOLDER}/scripts/late" "#!/bin/sh\n\n# SPDX-License-Identifier: Apache-2.0\n")
file(WRITE "${FOLDER}/.github/workflows/bare.yml" "name: bare\n")
run(check_license fails "4 of" "src/tree/bare.cpp" "src/tree/bare.inl" "scripts/late" ".github/workflows/bare.yml")

file(WRITE "${FOLDER}/src/tree/cover.cpp" "${license}/// As in [ericson2005, 5.1.5; welzl1991].\n// [welzl1991, nobody1999]\n")
run(check_references fails "src/tree/cover.cpp: nobody1999")
