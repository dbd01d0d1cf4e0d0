#!/usr/bin/env bash
# Makes the pictures in gallery/ and GALLERY.md, which shows them with their commands.
#
#   scripts/gallery.sh          with build/release/apps/dem/dem, or the program that DEM names
#
# A picture is three lines below: its file and heading, what it shows, and the command. The command
# runs in a folder with the drawings of testdata/ and the DEMs of the pictures before it.
set -euo pipefail
cd "$(dirname "$0")/.."
dem=$(realpath "${DEM:-build/release/apps/dem/dem}")
largest=40960  # bytes of one picture

rows() {
  cat <<'ROWS'
noise|Noise
  This is a sum of noise [musgrave1989].
  dem generate noise noise.tif --size 288 --cell 60
foothills|Foothills
  The terrain is rough where it is high, and smooth where it is low.
  dem generate noise:foothills foothills.tif --size 288 --cell 80 --seed 3
range|A range
  This is the same law along a winding ridge.
  dem generate noise:range range.tif --size 288 --cell 60 --seed 3
ridged|Crests
  This is the ridged multifractal.
  dem generate noise:ridged ridged.tif --size 288 --cell 60
hybrid|Peaks
  This is the hybrid multifractal.
  dem generate noise:hybrid hybrid.tif --size 288 --cell 80
dimension|From smooth to rough
  The fractal dimension is 2 in the west and 3 in the east.
  dem generate noise:dimension dimension.tif --size 288 --cell 80
warped|Folds
  Noise displaces the places at which the terrain is computed.
  dem generate noise:warped warped.tif --size 288 --cell 80
faults|Faults
  These are 10 000 straight faults [faulting1996].
  dem generate faults faults.tif --size 288 --cell 100
globe|A planet
  These are 5 000 great circles, in EPSG:4326.
  dem generate globe globe.tif --size 512x256
collage|Collage
  These are 10 000 elliptical humps and hollows.
  dem generate collage collage.tif --size 288 --cell 80
discs|Discs
  These are 20 000 flat discs.
  dem generate collage:discs discs.tif --size 288 --cell 80
craters|Craters
  These are 1 500 pits of the form H F / (F + x² + y²).
  dem generate collage:craters craters.tif --size 288 --cell 60
eroded|Eroded noise
  Rain, rivers and falling rock wear down the noise above in 2 000 steps [musgrave1989].
  dem erode noise.tif eroded.tif -s steps=2000
eroded-ridged|Eroded crests
  The same erosion wears down the crests above in 1 000 steps.
  dem erode ridged.tif eroded-ridged.tif -s steps=1000
canyon|A valley
  Positive noise is weighted by the distance from a winding line. It is the paper's plate 9, before erosion.
  dem generate noise:canyon canyon.tif --size 257
canyon-eroded|The valley after 2 000 steps
  It is the paper's plate 9, after erosion. There it took 4 hours.
  dem erode canyon.tif canyon-eroded.tif -s steps=2000
ridges|Ridges and rivers
  Ridges and rivers grow from particles, and MCMD fills the terrain around them [belhadj2005, belhadj2007].
  dem generate ridges ridges.tif --size 256 --cell 75
ridges-mdi|The same by MDI
  The terrain is filled as published in 2005: by the inverse process, then by midpoint displacement.
  dem generate ridges:mdi ridges-mdi.tif --size 256 --cell 75
skeleton|Drawn ridges and rivers
  MCMD fills the terrain around the lines of a vector layer.
  dem generate skeleton lines.geojson skeleton.tif --size 320 --cell 60
riverland|An island of rivers
  RiverLand makes the rivers first, and every cell drains [teoh2009].
  dem generate riverland riverland.tif --size 256 --cell 75
river-cliffs|River and coast cliffs
  This is RiverLand with another slope profile.
  dem generate riverland:cliffs river-cliffs.tif --size 256 --cell 75 --seed 2
terraces|Terraces
  This is RiverLand with a third slope profile.
  dem generate riverland:terraces terraces.tif --size 256 --cell 75 --seed 3
painted|Painted land
  RiverLand grows on the land of a vector layer, with a patch of rocky outcrops.
  dem generate painted_land island.geojson painted.tif --size 320 --cell 60
lsystem|An L-system
  This is the path of the 2007 paper's footnote 2, figure 11 (b).
  dem generate lsystem lsystem.tif --size 256 --cell 5
bumped|A sketch, bumped
  This is a line drawing with the bends of figure 12 (a).
  dem generate sketch:bumped star.geojson bumped.tif --size 320 --cell 60
wall|A painted wall
  One per cent of the cells is noise, and two median filters smooth it: figure 13.
  dem generate sketch:wall star.geojson wall.tif --size 256 --cell 75 --median 2
ROWS
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p gallery
cp testdata/*.geojson "$work"
{
  echo "# Gallery"
  echo
  echo "The command under a picture makes its terrain. \`dem render NAME.tif NAME.jpg\` draws it."
  echo "\`scripts/gallery.sh\` makes all pictures again."
} > "$work/GALLERY.md"

while IFS='|' read -r name heading && read -r what && read -r command; do
  read -ra words <<< "$command"
  (cd "$work" && "$dem" "${words[@]:1}" --quiet && "$dem" render "$name.tif" "$name.jpg" --quiet)
  size=$(stat --format=%s "$work/$name.jpg")
  if ((size > largest)); then
    echo "gallery: $name.jpg has $size bytes; at most $largest" >&2
    exit 1
  fi
  cp "$work/$name.jpg" "gallery/$name.jpg"
  printf '\n## %s\n%s\n\n![%s](gallery/%s.jpg)\n\n    %s\n' \
    "$heading" "$(fold -s -w 100 <<< "$what" | sed 's/ *$//')" "$heading" "$name" "$command" \
    >> "$work/GALLERY.md"
done < <(rows)
cp "$work/GALLERY.md" GALLERY.md
