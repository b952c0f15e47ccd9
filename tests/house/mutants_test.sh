#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
# scripts/mutants --check accepts sound markers and names every kind of fault that is planted; --list shows what is marked.
# usage: mutants_test.sh path/to/scripts/mutants FOLDER
set -euo pipefail
rm -rf "$2"
mkdir -p "$2/scripts" "$2/src" "$2/include" "$2/apps" "$2/tests/mutants"
cp "$1" "$2/scripts/mutants"
cd "$2"
git init -q .

fresh() {
  cat > src/sum.cpp << 'END'
double sum(double a, double b) {
  // The sum is rounded up.
  // mutant sum-pad: `+ pad` -> ``
  // mutant sum-of-one: `a + ... + pad` -> `a`
  // Markers stand among other comments.
  return a + b
    + pad;
}
double bound() {
  // mutant no-bound: `a + b + pad` -> `a`
  return a + b + pad + b;
}
END
  printf '# comment\nsum-pad\tsum_test:Sum.*\nno-bound\tsum_test:Bound.*\nsum-of-one\tsum_test:Sum.*\n' > tests/mutants/killers.tsv
}

# expect STATUS TEXT: the exit status of --check, and what it says.
expect() {
  local status=0
  scripts/mutants --check > said 2>&1 || status=$?
  if [ "$status" != "$1" ] || ! grep -qF -- "$2" said; then
    echo "status $status, not $1, or not \"$2\":"
    cat said
    exit 1
  fi
}

fresh
sed -i 's/a + b$/a + b + pad;/; /^    + pad;$/d' src/sum.cpp
expect 0 "all 3 mutants apply"
scripts/mutants --list > said
grep -qF -- "-> a" said && grep -qF "src/sum.cpp: a + ... + pad" said && grep -qF "3 mutants" said || { cat said; exit 1; }
[ "$(scripts/mutants --list --only 'sum-*' | tail -n 1)" = "2 mutants" ]

# Text over two lines is in neither of them.
fresh
expect 1 "sum-of-one does not apply"
# plant EDIT STATUS TEXT: one fault in an otherwise sound tree.
plant() {
  fresh
  sed -i 's/a + b$/a + b + pad;/; /^    + pad;$/d' src/sum.cpp
  sed -i "$1" src/sum.cpp tests/mutants/killers.tsv
  expect "$2" "$3"
}
plant 's/return a + b + pad + b/return a + b + pad + (a + b + pad)/' 1 "no-bound does not apply"
plant 's/return a + b + pad;/return a + b;/' 1 "sum-pad does not apply"
plant 's/return a + b + pad;/return a;\n  int i;\n  int j;\n  int k = a + b + pad;/' 1 "sum-pad does not apply"
plant 's/-> `a`$/-> a/' 2 "src/sum.cpp:4: not"
plant 's/mutant no-bound/mutant sum-pad/' 2 "sum-pad is marked twice"
plant '/^no-bound/d' 2 "src/sum.cpp: no-bound has no tests"
plant '/mutant no-bound/d' 2 "no source marks no-bound"
plant 's/^no-bound\t.*/no-bound/' 2 "no-bound has no tests"
plant 's/^\(no-bound\t.*\)/\1\n\1/' 2 "no-bound is there twice"
