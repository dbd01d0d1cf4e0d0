#!/usr/bin/env bash
# Installs what is missing, builds libdem and tests it.
# Exits with 0 only when each step passed; the closing summary names the steps, their tests and times.
#
#   scripts/test.sh          the daily loop: one build by gcc and the tests labelled `fast`
#   scripts/test.sh NAME...  some of: fast, slow, asan, clang, docs, python, qgis, package
#   scripts/test.sh all      all of them
set -euo pipefail
cd "$(dirname "$0")/.."

names=(fast slow asan clang docs python qgis package)
asked=("${@:-fast}")
if [[ "${asked[*]}" == all ]]; then asked=("${names[@]}"); fi
for name in "${asked[@]}"; do
  if [[ " ${names[*]} " != *" $name "* ]]; then
    echo "usage: $0 [NAME...|all], each NAME one of: ${names[*]}; not $name" >&2
    exit 1
  fi
done

summary=()
failures=0

# step NAME COMMAND...: runs the command, notes how it went, and goes on. Gives how it went.
step() {
  local name=$1 start=$SECONDS result=passed
  shift
  echo
  echo "== $name"
  counted=
  if ! "$@"; then
    result=FAILED
    failures=$((failures + 1))
  fi
  summary+=("$(printf '%-44s %-7s %4d s%s' "$name" "$result" $((SECONDS - start)) "$counted")")
  [[ $result == passed ]]
}

# build PRESET [TARGET...]
build() {
  local launcher=() targets=()
  if command -v ccache > /dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  if (($# > 1)); then targets=(--target "${@:2}"); fi
  cmake --preset "$1" "${launcher[@]}" && cmake --build --preset "$1" "${targets[@]}"
}

# run_tests PRESET [CHOICE...]: also counts what the test programs say that they ran and skipped.
run_tests() {
  local log=build/$1/Testing/Temporary/LastTest.log result=0
  ctest --preset "$1" --parallel "$(nproc)" --no-tests=error "${@:2}" || result=$?
  counted=$(awk '
    match($0, /^Ran [0-9]+ test/) { ran += $2 }
    match($0, /^\[==========\] [0-9]+ tests? from .* ran/) { ran += $2 }
    match($0, /^\[  SKIPPED \] [0-9]+ test/) { skipped += $4 }
    match($0, /skipped=[0-9]+/) { skipped += substr($0, RSTART + 8, RLENGTH - 8) }
    match($0, /[0-9]+ passed/) { ran += substr($0, RSTART, RLENGTH - 7) }
    match($0, /[0-9]+ skipped/) { ran += substr($0, RSTART, RLENGTH - 8)
                                  skipped += substr($0, RSTART, RLENGTH - 8) }
    END { if (ran) printf "  %d cases, %d of them skipped", ran, skipped }' "$log")
  return "$result"
}

program=(dem_cli dem_tests dem_io_tests)
built=" "

# with_build PRESET NAME TARGETS CHOICE...: the step that builds TARGETS (a string of words, which may be
# empty: everything), then the step that tests, unless the build failed.
with_build() {
  local preset=$1 name=$2 targets=() key="$1:$3"
  read -ra targets <<< "$3"
  if [[ "$built" != *" ${key// /,} "* ]]; then
    step "build for $name" build "$preset" "${targets[@]}" || return 0
    built+="${key// /,} "
  fi
  step "tests, $name" run_tests "$preset" "${@:4}" || return 0
}

scripts/setup.sh --tests

if [[ -z "${DEM_TESTDATA:-}" ]]; then
  echo "test: DEM_TESTDATA is not set; tests that need its tiles will say so and be skipped"
fi

for name in "${asked[@]}"; do
  case $name in
    fast) with_build release fast "${program[*]}" --label-regex fast ;;
    slow) with_build release slow "${program[*]}" --label-regex slow ;;
    docs) with_build release docs "${program[*]}" --tests-regex '^house\.(docs|tutorial)$' ;;
    python) with_build release python "${program[*]} dem_python_package fill_in_c fill_in_cpp" \
                       --tests-regex '^(python|doors)\.' ;;
    qgis) with_build release qgis "${program[*]} qgis_plugin" --tests-regex '^qgis$' ;;
    package) with_build release package "" --tests-regex '^house\.(consumer|package)' ;;
    asan) with_build debug "AddressSanitizer and UBSan" "" --label-regex fast --exclude-regex '^house\.' ;;
    clang) with_build clang "clang" "" --label-regex fast --exclude-regex '^(house|cli)\.' ;;
  esac
done

echo
echo "== Summary"
printf '%s\n' "${summary[@]}"
if ((failures > 0)); then
  echo "$failures of ${#summary[@]} steps FAILED after $SECONDS s"
  exit 1
fi
echo "all ${#summary[@]} steps passed in $SECONDS s"
