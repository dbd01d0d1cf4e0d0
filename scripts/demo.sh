#!/usr/bin/env bash
# From nothing to a reconstructed mountain: installs what is missing, builds `dem`, repeats the
# Mount Washington experiment and prints its table and the paths of its pictures.
#
#   scripts/demo.sh [FOLDER]   results go to FOLDER (default: out/demo)
#
# Input: mtwashington_1025_3s.tif of the folder DEM_TESTDATA (default: ../shared/data), or else the
# tile in testdata/, on which the same experiment runs.
set -euo pipefail
out=$(realpath --canonicalize-missing "${1:-"$(dirname "$0")/../out/demo"}")
cd "$(dirname "$0")/.."

scripts/setup.sh

cmake --preset release -B build/demo -DDEM_BUILD_TESTS=OFF -DDEM_BUILD_BENCH=OFF -DDEM_BUILD_PYTHON=OFF
cmake --build build/demo --target dem_cli

tile="${DEM_TESTDATA:-../shared/data}/mtwashington_1025_3s.tif"
if [[ ! -f "$tile" ]]; then
  echo "demo: there is no $tile; running on testdata/jacksboro.tif"
  tile=testdata/jacksboro.tif
fi
mkdir -p "$(dirname "$out")"
build/demo/apps/dem/dem reproduce mount-washington "$out" --tile "$tile" --overwrite
