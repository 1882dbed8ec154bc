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

# The first page: a scan and what becomes of it, and a scan of one side.
scan_of() { printf 'scanmill: 1\nname: scan\ninputs: {model: mesh}\nsteps: [{virtual-scan: {%s}}]\noutputs: {"{scan}-scan.ply": virtual-scan}\n' "$1"; }
scan_of 'views: 20, resolution: 0.5 %diag, noise: 0.15 %diag, outliers: 1 %' >noisy.yaml
run noisy.yaml "$data/meshes/ChineseDragon-10kv.off" -o lion
run raw-scans lion/ChineseDragon-10kv-scan.ply -o lion
lion=lion/raw-scans.ply
draw lion/ChineseDragon-10kv-scan.ply points 'up: y, size: [400, 310]' docs/pictures/lion-scan.png $lion
draw $lion mesh 'up: y, size: [400, 310]' docs/pictures/lion-mesh.png
scan_of 'views: [0, 0, 1], resolution: 0.5 %diag, noise: 0.05 %diag' >above.yaml
run above.yaml "$data/meshes/bear.off" -o side
run terrain side/bear-scan.ply -o terrain
draw terrain/bear-scan.ply mesh 'up: y, boundaries: true, size: [320, 240]' docs/pictures/one-side.png

# The page of render.
draw "$data/meshes/anchor_dense.off" mesh 'size: [400, 300], creases: true' filters/render/picture.png
draw "$data/meshes/mannequin-devil.off" mesh 'size: [400, 300], style: lines' filters/render/lines.png
draw "$data/meshes/elephant-with-holes.off" mesh 'size: [400, 300], edges: true, boundaries: true' filters/render/edges.png

# The how-to pages: their own files and commands.
files_of() { awk '/^<!-- file: /{name=$3} /^```/{if (open) {open=0; name=""} else if (name) {open=1; next}} open{print > name}' "$root/$1"; }
pictures=docs/how-to/pictures
files_of docs/how-to/remove-outliers.md
run dirty.yaml -o .
run marked.yaml dirty.ply -o .
draw dirty-marked.ply points 'colour: outlier, scale: [-1 u, 1 u], legend: false, size: [360, 270]' $pictures/outliers.png

files_of docs/how-to/close-a-noisy-scan.md
files_of docs/how-to/close-a-scan-with-a-part-missing.md
run sphere.yaml -o .
run closed.yaml sphere.ply -o .
draw sphere-closed.ply mesh 'colour: filled, scale: [-1 u, 1 u], legend: false, size: [360, 270]' $pictures/closed.png
run bowl.yaml sphere.ply -o .
draw sphere-open.ply mesh 'boundaries: true, size: [360, 270]' $pictures/bowl-open.png sphere.ply
draw sphere-solid.ply mesh 'size: [360, 270]' $pictures/bowl-closed.png sphere.ply

files_of docs/how-to/average-noise-with-poisson.md
run torus.yaml -o .
run surfaces.yaml torus.ply -o .
draw torus-through.ply mesh 'size: [300, 225]' $pictures/noisy-through.png
draw torus-poisson.ply mesh 'size: [300, 225]' $pictures/noisy-poisson.png torus-through.ply

files_of docs/how-to/make-a-lighter-mesh.md
run light.yaml sphere.ply -o .
near='edges: true, eye: [0 u, -120 u, 120 u], look-at: [0 u, -70 u, 70 u], size: [240, 180]'
draw sphere-full.ply mesh "$near" $pictures/full.png
draw sphere-light.ply mesh "$near" $pictures/light.png

files_of docs/how-to/mesh-raw-views.md
run views.yaml -o .
run raw-scans views.ply -o .
draw views.ply points 'size: [360, 240]' $pictures/raw-views.png raw-scans.ply
draw raw-scans.ply mesh 'size: [360, 240]' $pictures/raw-mesh.png

files_of docs/how-to/open-mesh-and-edges.md
files_of docs/how-to/plan-a-probe-path.md
run block.yaml -o .
run part.yaml block.ply -o .
run plate.yaml -o .
run probe.yaml block.ply --in plate=plate.ply --in corners=corners.csv -o .
cat >edges.yaml <<'YAML'
scanmill: 1
name: edges
inputs: {scene: {kind: mesh, frame: scanner}, lines: {kind: features, frame: scanner}, plan: probes, to-machine: transform}
steps:
  - id: edges
    render: {size: [360, 270]}
    in: {scene: scene, over: lines}
  - apply-transform:
    in: {value: scene, transform: to-machine}
  - id: plan-on-mesh
    render: {size: [400, 300]}
    in: {scene: apply-transform, over: plan}
outputs: {edges.png: edges, probe-plan.png: plan-on-mesh}
YAML
run edges.yaml block-mesh.ply --in lines=block-lines.json --in plan=block-probes.json --in to-machine=block-to-machine.json -o edges
cp edges/edges.png edges/probe-plan.png "$root/$pictures/"

files_of docs/how-to/inspect-a-part.md
run scan.yaml -o .
run inspect part.ply --unit mm --in nominal=block.off --set 'tolerance=[-0.1 mm, 0.1 mm]' -o out || true
mkdir -p "$root/docs/how-to/inspect-a-part"
cp out/failed/part-deviation.png out/failed/part-on-nominal.png "$root/docs/how-to/inspect-a-part/"

files_of docs/how-to/update-a-changed-part.md
run rescan.yaml part.off --unit mm -o clouds
clouds=clouds=clouds/block-pad.ply,clouds/block-pocket.ply
run update-mesh block.off --unit mm --in "$clouds" --set 'max-distance=1.5 mm' --set 'scale=[-6 mm, 6 mm]' -o changed
run pictures.yaml block.off --unit mm --in "$clouds" -o changed
mkdir -p "$root/docs/how-to/update-a-changed-part"
cp changed/model.png changed/scans.png changed/updated.png "$root/docs/how-to/update-a-changed-part/"
cp changed/block-change.png "$root/docs/how-to/update-a-changed-part/change.png"

files_of docs/how-to/touch-the-edges.md
run scan.yaml bracket.off -o .
run plate.yaml -o .
run wang-2006-hybrid part.ply --unit mm --in plate=plate.ply --in corners=corners.csv \
    --set 'first-corner=[-100 u, -60 u, 5 u]' --set 'spacing=2 mm' -o touched
run machine.yaml touched/part-probes.json --in model=bracket.off --in pose=pose.json -o .
run scan-and-touches touched/part-scan.ply --in touches=results.ply --in plan=touched/part-probes.json -o touched
cat >look.yaml <<'YAML'
scanmill: 1
name: look
inputs: {before: mesh, after: mesh, plan: probes}
parameters:
  eye: {default: [450 mm, 240 mm, 135 mm], help: The eye of the close-ups.}
  at: {default: [402 mm, 296 mm, 82 mm], help: The point in their middle.}
steps:
  - id: planned
    render: {size: [480, 360]}
    in: {scene: before, over: plan}
  - id: alone
    render: {size: [480, 360], creases: true, eye: $eye, look-at: $at}
    in: {scene: before}
  - id: both
    render: {size: [480, 360], creases: true, eye: $eye, look-at: $at}
    in: {scene: after}
outputs: {plan.png: planned, alone.png: alone, both.png: both}
YAML
run look.yaml touched/part-machine.ply --in after=touched/part-scan-hybrid.ply --in plan=touched/part-probes.json -o look
mkdir -p "$root/docs/how-to/touch-the-edges"
cp look/plan.png look/alone.png look/both.png "$root/docs/how-to/touch-the-edges/"

# The page on views without poses: eight views of a model, each turned and shifted in a way of its own, then registered.
cat >view.yaml <<'YAML'
scanmill: 1
name: view
inputs: {model: mesh, pose: transform}
parameters:
  direction: {default: [0, 0, 1], help: From the object to the scanner.}
steps:
  - virtual-scan: {views: $direction, resolution: 0.25 %diag, noise: 0.05 %diag, max-angle: 75 deg}
    in: {mesh: model}
  - apply-transform:
    in: {value: virtual-scan, transform: pose}
outputs: {"view.ply": apply-transform}
YAML
mkdir -p views
number=0
while read -r direction rotation shift; do
    number=$((number + 1))
    echo "{\"scanmill\": 1, \"poses\": [{\"rotation\": [$rotation], \"translation\": [$shift]}]}" >pose.json
    run view.yaml "$data/meshes/elephant.off" --in pose=pose.json --set "direction=[$direction]" -o view
    mv view/view.ply "views/view-$number.ply"
done <<'VIEWS'
1,0,0.2 0.5,0.5,0.5,0.5 0.4,0.1,0
0.7,0.7,0.1 0.8,0,0,0.6 -0.5,0.3,0.1
0,1,-0.2 0,0.6,0,0.8 0.2,-0.6,0.3
-0.7,0.7,0.3 0.48,0.6,0.64,0 0.1,0.5,-0.4
-1,0,0 0.6,0.48,0,0.64 -0.3,-0.4,-0.3
-0.7,-0.7,-0.1 0.5,-0.5,0.5,0.5 0.6,-0.2,0.4
0,-1,0.2 0,0,0.8,0.6 -0.1,0.2,0.6
0.7,-0.7,-0.2 0.64,0,-0.48,0.6 0.3,0.6,-0.2
VIEWS
printf 'scanmill: 1\nname: merged\ninputs:\n  views: {kind: points, list: true, frame: "{stem}"}\nsteps:\n  - merge:\noutputs: {merged.ply: merge}\n' >merged.yaml
run merged.yaml views/*.ply -o before
run register-views views/*.ply -o placed
run raw-scans views/*.ply -o after
mkdir -p "$root/docs/how-to/register-views"
draw before/merged.ply points 'colour: source, legend: false, size: [400, 300]' docs/how-to/register-views/views.png
draw placed/register-views.ply points 'colour: source, legend: false, size: [400, 300]' docs/how-to/register-views/placed.png
draw after/raw-scans.ply mesh 'size: [400, 300]' docs/how-to/register-views/mesh.png placed/register-views.ply

# The tutorial: each page has a folder, and its own files and commands make what the pictures show.
tutorial=docs/tutorial/pictures
mkdir -p "$root/$tutorial"
page() {
    mkdir "$folder/$1"
    cd "$folder/$1"
}

page one-scan
files_of docs/tutorial/1-one-scan.md
run scan.yaml -o scans
run raw-scans scans/part.ply -o out
run quickstart scans/part.ply -o quick
sed -i 's/outer: fil}/outer: fill}/' solid.yaml
run solid.yaml scans/part.ply -o coarse --set 'bin-size=4 u' || true
draw scans/part.ply points 'size: [320, 240]' $tutorial/part-scan.png out/raw-scans.ply
draw out/raw-scans.ply mesh 'size: [320, 240]' $tutorial/part-mesh.png
draw quick/part.stl mesh 'size: [320, 240]' $tutorial/part-doubtful.png out/raw-scans.ply
draw coarse/failed/part.ply mesh 'size: [400, 300], eye: [-72 u, -88 u, 82 u], look-at: [0 u, 0 u, -5 u]' $tutorial/part-coarse.png

page raw-views
files_of docs/tutorial/2-raw-views.md
awk -f duck.awk duck.txt >duck.off
mkdir positions
while read -r name pose; do echo "{\"scanmill\": 1, \"poses\": [{$pose}]}" >"positions/$name.json"; done <positions.txt
run view.yaml positions/*.json --in duck=duck.off -o views
run "$folder/merged.yaml" views/*.ply -o before
run register-views views/*.ply -o out
run raw-scans views/*.ply --set poses=out/register-views-poses.json -o out
run raw-scans views/above.ply views/side-*.ply --set poses=out/register-views-poses.json -o half
view='size: [320, 240], eye: [110 u, -100 u, 80 u]'
draw before/merged.ply points 'colour: source, legend: false, size: [320, 240]' $tutorial/duck-views.png
draw out/register-views.ply points "colour: source, legend: false, $view" $tutorial/duck-placed.png
draw out/raw-scans.ply mesh "$view" $tutorial/duck-mesh.png
draw half/raw-scans.ply mesh 'colour: filled, legend: false, camera: [bottom], size: [320, 240]' $tutorial/duck-filled.png

page compare-variants
files_of docs/tutorial/3-compare-variants.md
run scan.yaml bracket.off -o .
run settings.yaml part.ply --in truth=bracket.off -o settings
run surfaces.yaml part.ply --in truth=bracket.off --set neighbours=192 -o surfaces
for neighbours in 12 48 192; do mv "settings/neighbours=$neighbours.png" "$root/$tutorial/neighbours-$neighbours.png"; done
mv surfaces/grow.png "$root/$tutorial/surface-grow.png"
mv surfaces/poisson.png "$root/$tutorial/surface-poisson.png"

page nightly-batch
mkdir models scans
files_of docs/tutorial/4-nightly-batch.md
awk 'NR > 2 && NF == 3 { $2 *= 1.5 } { print }' models/bracket-1.off >models/bracket-3.off
awk 'NR > 2 && NF == 3 { $3 *= 1.2 } { print }' models/bracket-1.off >models/bracket-4.off
run scan.yaml models/bracket-3.off -o scans
run scan.yaml models/bracket-4.off -o scans --set 'views=[0.4, 0.3, 1, -0.5, 0.2, 1]'
run mesh.yaml scans/*.ply --unit mm -o nights
mv nights/bracket-3.png "$root/$tutorial/night-good.png"
mv nights/bracket-4.png "$root/$tutorial/night-doubtful.png"
