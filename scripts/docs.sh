#!/usr/bin/env bash
# Writes docs/VERB.md, a page for each verb, and docs/README.md, as the program itself tells them, and the outputs
# in docs/tutorial.md.
#
#   scripts/docs.sh [DEM]           default: build/release/apps/dem/dem
#   scripts/docs.sh --check [DEM]   changes nothing; names the pages that differ, exit code 1 when there are any
set -euo pipefail
mode=write
if [[ "${1:-}" == --check ]]; then
  mode=check
  shift
fi
dem=$(realpath "${1:-"$(dirname "$0")/../build/release/apps/dem/dem"}")
cd "$(dirname "$0")/.."

made=$(mktemp -d)
trap 'rm -r "$made"' EXIT
note="<!-- Written by scripts/docs.sh from the program itself: change the help, not this page. -->"
{
  echo "$note"
  "$dem" manual --format markdown
  cat <<'END'

## More
- [Tutorial](tutorial.md): remove cells from a tile, fill them, see how good that was.
- [From Python](python.md): numpy, xarray, and mosaics on a Dask cluster.
- [From C](c.md), and from every language that calls C.
- [QGIS](qgis.md): the same in the Processing toolbox.
- The same pages for `man`: `dem manual fill | man -l -`; installed, `man dem-fill`.
END
} > "$made/README.md"
for page in $("$dem" manual --format markdown | sed -n 's/^| \[dem \([a-z]*\)\].*/\1/p'); do
  { echo "$note"; "$dem" manual "$page" --format markdown; } > "$made/$page.md"
done

if [[ $mode == write ]]; then
  cp "$made"/*.md docs/
  python3 scripts/run_page.py docs/tutorial.md "$dem" --update
  exit 0
fi
stale=0
for page in "$made"/*.md; do
  if ! cmp --silent "$page" "docs/${page##*/}"; then
    echo "docs/${page##*/} is not what the program says: run scripts/docs.sh" >&2
    stale=1
  fi
done
for page in $(grep -l "^$note" docs/*.md); do
  if [[ ! -e "$made/${page##*/}" ]]; then
    echo "$page: the program has no such verb" >&2
    stale=1
  fi
done
exit $stale
