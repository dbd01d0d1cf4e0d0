#!/usr/bin/env bash
# Installs what is missing, builds libdem three ways and runs every test.
# Exits with 0 only when each step passed; the closing summary names the steps and their times.
set -euo pipefail
cd "$(dirname "$0")/.."

summary=()
failures=0

# step NAME COMMAND...: runs the command, notes how it went, and goes on.
step() {
  local name=$1 start=$SECONDS result=passed
  shift
  echo
  echo "== $name"
  if ! "$@"; then
    result=FAILED
    failures=$((failures + 1))
  fi
  summary+=("$(printf '%-44s %-7s %4d s' "$name" "$result" $((SECONDS - start)))")
}

# build PRESET
build() {
  local launcher=()
  if command -v ccache > /dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  cmake --preset "$1" "${launcher[@]}" && cmake --build --preset "$1"
}

# run_tests PRESET [MORE...]
run_tests() {
  ctest --preset "$1" --parallel "$(nproc)" "${@:2}"
}

scripts/setup.sh --tests

if [[ -z "${DEM_TESTDATA:-}" ]]; then
  echo "test: DEM_TESTDATA is not set; tests that need its tiles will say so and be skipped"
fi

step "build, gcc, warnings are errors" build release
step "tests, gcc" run_tests release
step "build, AddressSanitizer and UBSan" build debug
step "tests, AddressSanitizer and UBSan" run_tests debug --label-exclude house
step "build, clang, warnings are errors" build clang
step "tests of the library, clang" run_tests clang --label-exclude house --exclude-regex '^cli\.'

echo
echo "== Summary"
printf '%s\n' "${summary[@]}"
if ((failures > 0)); then
  echo "$failures of ${#summary[@]} steps FAILED after $SECONDS s"
  exit 1
fi
echo "all ${#summary[@]} steps passed in $SECONDS s"
