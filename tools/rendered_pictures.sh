#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# rendered_pictures.sh PROGRAM DATA: draws the shaded pictures of README and pages with the filter `render`. DATA is the folder of
# `make data`.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
program=$(realpath "$1")
data=$(realpath "$2")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

run() { "$program" run "$@" --no-cache --quiet >/dev/null; }

# draw FILE KIND PARAMETERS PICTURE [POINTS]: the points set the camera.
draw() {
    printf 'scanmill: 1\nname: draw\ninputs: {scene: %s, truth: points}\nsteps:\n  - render: {%s}\n    in: {scene: scene, truth: truth}\n' \
        "$2" "$3" >draw.yaml
    printf 'outputs: {picture.png: render}\n' >>draw.yaml
    run draw.yaml "$1" --in "truth=${5:-$1}" -o drawn
    mkdir -p "$(dirname "$root/$4")"
    mv drawn/picture.png "$root/$4"
}

# The first page: a scan and what becomes of it.
run raw-scans "$data/points_3/kitten.xyz" -o kitten
kitten=kitten/raw-scans.ply
draw "$data/points_3/kitten.xyz" points 'up: y, size: [400, 400]' docs/pictures/kitten-scan.png
draw $kitten mesh 'up: y, size: [400, 400]' docs/pictures/kitten-mesh.png "$data/points_3/kitten.xyz"

# The page of render.
draw "$data/meshes/anchor_dense.off" mesh 'size: [400, 300], creases: true' filters/render/picture.png
draw "$data/meshes/mannequin-devil.off" mesh 'size: [400, 300], style: lines' filters/render/lines.png
draw "$data/meshes/elephant-with-holes.off" mesh 'size: [400, 300], edges: true, boundaries: true' filters/render/edges.png

# The pages on inspection and on changed parts: their own files and commands.
files_of() { awk '/^<!-- file: /{name=$3} /^```/{if (open) {open=0; name=""} else if (name) {open=1; next}} open{print > name}' "$root/$1"; }
files_of docs/inspection.md
run scan.yaml -o .
run inspect part.ply --unit mm --in nominal=block.off --set 'tolerance=[-0.1 mm, 0.1 mm]' -o out || true
mkdir -p "$root/docs/inspection"
cp out/failed/part-deviation.png out/failed/part-on-nominal.png "$root/docs/inspection/"

files_of docs/part-changed.md
run rescan.yaml part.off --unit mm -o clouds
clouds=clouds=clouds/block-pad.ply,clouds/block-pocket.ply
run update-mesh block.off --unit mm --in "$clouds" --set 'max-distance=1.5 mm' --set 'scale=[-6 mm, 6 mm]' -o changed
run pictures.yaml block.off --unit mm --in "$clouds" -o changed
mkdir -p "$root/docs/part-changed"
cp changed/model.png changed/scans.png changed/updated.png "$root/docs/part-changed/"
cp changed/block-change.png "$root/docs/part-changed/change.png"
