#!/usr/bin/env bash
# Makes README's table and picture again: builds `dem`, repeats the Mount Washington experiment,
# and rewrites mount-washington.jpg and the lines of README.md between the `figures` marks.
#
#   scripts/figures.sh [TILE]   default: mtwashington_1025_3s.tif in $DEM_TESTDATA or ../shared/data
#
# Needs python3-numpy and python3-gdal in addition to what scripts/setup.sh installs.
set -euo pipefail
tile=${1:+"$(realpath "$1")"}
cd "$(dirname "$0")/.."

tile=${tile:-"${DEM_TESTDATA:-../shared/data}/mtwashington_1025_3s.tif"}
if [[ ! -f "$tile" ]]; then
  echo "figures: there is no $tile; README says where to download the tile" >&2
  exit 1
fi

scripts/setup.sh
cmake --preset release -B build/demo -DDEM_BUILD_TESTS=OFF -DDEM_BUILD_BENCH=OFF
cmake --build build/demo
mkdir -p out
build/demo/apps/dem/dem reproduce mount-washington out/figures --tile "$tile" --threads 1 --overwrite
/usr/bin/python3 scripts/figures.py out/figures
