#!/usr/bin/env bash
# Checks that every C++ file is formatted as .clang-format says. To format: scripts/check_format.sh --fix
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v clang-format-14 > /dev/null; then
  echo "clang-format-14 is missing: apt-get install clang-format-14 (scripts/setup.sh --tests does)" >&2
  exit 1
fi
mode=(--dry-run --Werror)
if [[ "${1:-}" == --fix ]]; then mode=(-i); fi

find libdem apps tests -name '*.h' -print0 -o -name '*.cpp' -print0 | xargs -0 clang-format-14 "${mode[@]}"
