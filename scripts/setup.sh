#!/usr/bin/env bash
# Installs the Debian packages that libdem is built from, those that are missing and no other.
#
#   scripts/setup.sh           to build and run `dem`
#   scripts/setup.sh --tests   also what scripts/test.sh needs
set -euo pipefail

packages=(
  g++ cmake ninja-build pkg-config
  libgdal-dev libgeographiclib-dev libopenimageio-dev libtbb-dev libeigen3-dev libfmt-dev
  nlohmann-json3-dev libjs-chart.js
  python3-dev python3-numpy pybind11-dev
  ca-certificates
)
test_packages=(
  libgtest-dev libgmock-dev libbenchmark-dev libembree-dev
  clang-14 clang-format-14 libclang-rt-14-dev
  python3 python3-pytest python3-hypothesis python3-xarray python3-rioxarray python3-tqdm
  python3-distributed python3-pip python3-setuptools python3-wheel
  chromium
  man-db zsh fish
  qgis
)

case "${1:-}" in
  "") ;;
  --tests) packages+=("${test_packages[@]}") ;;
  *) echo "usage: $0 [--tests]" >&2; exit 1 ;;
esac

is_installed() {
  [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

missing=()
for package in "${packages[@]}"; do
  is_installed "$package" || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "setup: all ${#packages[@]} packages are installed"
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo > /dev/null; then
    echo "setup: missing: ${missing[*]}; install them as root, since there is no sudo here" >&2
    exit 1
  fi
  as_root=(sudo)
fi

echo "setup: installing ${#missing[@]} of ${#packages[@]} packages: ${missing[*]}"
"${as_root[@]}" apt-get update --quiet
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install --quiet --yes --no-install-recommends "${missing[@]}"
echo "setup: installed ${missing[*]}"
