#!/usr/bin/env bash
# Makes the pictures in gallery/ and GALLERY.md, which shows them with their commands.
#
#   scripts/gallery.sh          with build/release/apps/dem/dem, or the program that DEM names
#
# A picture is one row below: file, heading, what it shows, the command. The command reads and
# writes DEMs in a folder with the drawings of testdata/, in which those of the rows before it lie.
set -euo pipefail
cd "$(dirname "$0")/.."
dem=$(realpath "${DEM:-build/release/apps/dem/dem}")
largest=40960  # bytes of one picture

rows() {
  cat <<'ROWS'
noise|Noise|Sums of noise [musgrave1989]|dem generate noise noise.tif --size 288 --cell 60
foothills|Foothills|Rough where high, smooth where low|dem generate noise:foothills foothills.tif --size 288 --cell 80 --seed 3
range|A range|The same along a winding ridge|dem generate noise:range range.tif --size 288 --cell 60 --seed 3
ridged|Crests|The ridged multifractal|dem generate noise:ridged ridged.tif --size 288 --cell 60
hybrid|Peaks|The hybrid multifractal|dem generate noise:hybrid hybrid.tif --size 288 --cell 80
dimension|From smooth to rough|Fractal dimension 2 in the west, 3 in the east|dem generate noise:dimension dimension.tif --size 288 --cell 80
warped|Folds|Places displaced by noise|dem generate noise:warped warped.tif --size 288 --cell 80
faults|Faults|10 000 straight faults [faulting1996]|dem generate faults faults.tif --size 288 --cell 100
globe|A planet|5 000 great circles, in EPSG:4326|dem generate globe globe.tif --size 512x256
collage|Collage|10 000 elliptical humps and hollows|dem generate collage collage.tif --size 288 --cell 80
discs|Discs|20 000 flat discs|dem generate collage:discs discs.tif --size 288 --cell 80
craters|Craters|1 500 pits H F / (F + x² + y²)|dem generate collage:craters craters.tif --size 288 --cell 60
eroded|Eroded noise|2 000 steps of rain, rivers and falling rock on the noise above [musgrave1989]|dem erode noise.tif eroded.tif -s steps=2000
eroded-ridged|Eroded crests|The same on the crests|dem erode ridged.tif eroded-ridged.tif -s steps=1000
canyon|A valley|Positive noise weighted by the distance from a winding line (the paper's plate 9, before)|dem generate noise:canyon canyon.tif --size 257
canyon-eroded|The valley after 2 000 steps|The paper's plate 9, after: there in 4 hours|dem erode canyon.tif canyon-eroded.tif -s steps=2000
ridges|Ridges and rivers|Grown from particles, and MCMD around them [belhadj2005, belhadj2007]|dem generate ridges ridges.tif --size 256 --cell 75
ridges-mdi|The same by MDI|As published in 2005: the inverse, then midpoint displacement|dem generate ridges:mdi ridges-mdi.tif --size 256 --cell 75
skeleton|Drawn ridges and rivers|MCMD around the lines of a vector layer|dem generate skeleton lines.geojson skeleton.tif --size 320 --cell 60
riverland|An island of rivers|RiverLand [teoh2009]: rivers first, and every cell drains|dem generate riverland riverland.tif --size 256 --cell 75
river-cliffs|River and coast cliffs|The same with another slope profile|dem generate riverland:cliffs river-cliffs.tif --size 256 --cell 75 --seed 2
terraces|Terraces|And another|dem generate riverland:terraces terraces.tif --size 256 --cell 75 --seed 3
painted|Painted land|RiverLand on a vector layer's land, with a patch of rocky outcrops|dem generate painted_land island.geojson painted.tif --size 320 --cell 60
lsystem|An L-system|The path of the 2007 paper's footnote, figure 11 (b)|dem generate lsystem lsystem.tif --size 256 --cell 5
bumped|A sketch, bumped|A line drawing with the bends of figure 12 (a)|dem generate sketch:bumped star.geojson bumped.tif --size 320 --cell 60
wall|A painted wall|1 % of noise, two median filters: figure 13|dem generate sketch:wall star.geojson wall.tif --size 256 --cell 75 --median 2
ROWS
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p gallery
cp testdata/*.geojson "$work"
{
  echo "# Gallery"
  echo
  echo "Each terrain is made by the command under it and drawn by \`dem render NAME.tif NAME.jpg\`; \`scripts/gallery.sh\` repeats it all."
} > "$work/GALLERY.md"

while IFS='|' read -r name heading what command; do
  read -ra words <<< "$command"
  (cd "$work" && "$dem" "${words[@]:1}" --quiet && "$dem" render "$name.tif" "$name.jpg" --quiet)
  size=$(stat --format=%s "$work/$name.jpg")
  if ((size > largest)); then
    echo "gallery: $name.jpg has $size bytes; at most $largest" >&2
    exit 1
  fi
  cp "$work/$name.jpg" "gallery/$name.jpg"
  printf '\n## %s\n%s.\n\n![%s](gallery/%s.jpg)\n\n    %s\n' \
    "$heading" "$what" "$heading" "$name" "$command" >> "$work/GALLERY.md"
done < <(rows)
cp "$work/GALLERY.md" GALLERY.md
