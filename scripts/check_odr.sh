#!/usr/bin/env bash
# Checks that no two types of one name differ, in the library and the program `dem`, with g++'s
# link-time look at all sources at once.
#
#     scripts/check_odr.sh [FOLDER]     builds in FOLDER (build/odr); prints each violation
#     scripts/check_odr.sh --self-test  plants a violation and sees that it is found
set -euo pipefail
cd "$(dirname "$0")/.."

for tool in g++ cmake ninja; do
  if ! command -v "$tool" > /dev/null; then
    echo "$tool is missing: scripts/setup.sh installs it" >&2
    exit 1
  fi
done

# Joins object files into one, and fails when two of them disagree about a type.
join() {
  local out=$1
  shift
  g++ -O0 -flto -r -nostdlib -flinker-output=rel -Wodr -Werror=odr -o "$out" "$@"
}

if [[ "${1:-}" == --self-test ]]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  echo '#include "dem/points.h"
        int cols(const dem::Lattice& l) { return l.size.cols; }' > "$work/points.cpp"
  echo 'namespace dem { struct Lattice { int x, y; }; }
        int cols(const dem::Lattice& l, int) { return l.x; }' > "$work/planted.cpp"
  echo 'namespace dem::midpoint { struct Lattice { int x, y; }; }
        int cols(const dem::midpoint::Lattice& l, int) { return l.x; }' > "$work/allowed.cpp"
  for name in points planted allowed; do
    g++ -std=c++20 -O0 -flto -Ilibdem/include -c "$work/$name.cpp" -o "$work/$name.o"
  done
  join "$work/all.o" "$work/points.o" "$work/allowed.o"
  if join "$work/all.o" "$work/points.o" "$work/planted.o" 2> "$work/errors"; then
    echo "self-test: a second dem::Lattice was not found" >&2
    exit 1
  fi
  grep -q "Lattice.* violates the C++ One Definition Rule" "$work/errors"
  echo "self-test: the planted violation was found, the allowed type passed"
  exit
fi

folder=${1:-build/odr}
launcher=$(command -v ccache || true)
cmake -S . -B "$folder" -G Ninja -DCMAKE_CXX_COMPILER=g++ -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" \
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG="-O0 -flto -w" -DDEM_BUILD_TESTS=OFF -DDEM_BUILD_BENCH=OFF \
  -DDEM_BUILD_PYTHON=OFF > /dev/null
cd "$folder"
mapfile -t objects < <(ninja -t targets all | sed -n 's/\(.*\.cpp\.o\): .*/\1/p')
ninja "${objects[@]}" > build.log || {
  tail -n 30 build.log >&2
  exit 1
}
join all.o "${objects[@]}"
echo "no two types of one name in ${#objects[@]} sources"
