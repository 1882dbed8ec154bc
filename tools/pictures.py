#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws filters/*/picture.svg, the picture of every filter's page. Each one runs the filter's method in the plane."""
import pathlib

import cleanup_pictures as cleanups
import cloud_pictures as clouds
import cocone_pictures as cocones
import frame_pictures as frames
import patch_pictures as patches
import probe_pictures as probes
import surface_pictures as surfaces
import update_pictures as updates


def main():
    filters = pathlib.Path(__file__).resolve().parent.parent / "filters"
    for name, draw in (
        ("a_patch", patches.a_patch),
        ("align", frames.align),
        ("alpha_solid", surfaces.alpha_solid),
        ("apply_transform", frames.apply_transform),
        ("cluster_mesh", surfaces.cluster_mesh),
        ("cocone", cocones.cocone),
        ("crop", clouds.crop),
        ("decimate", surfaces.decimate),
        ("delaunay", surfaces.delaunay_filter),
        ("edge_flip", surfaces.edge_flip),
        ("features", surfaces.features),
        ("fill_holes", cleanups.fill_holes),
        ("icp", frames.icp),
        ("inspect", surfaces.inspect),
        ("measure", surfaces.measure),
        ("merge", clouds.merge),
        ("mesh_update", updates.mesh_update),
        ("normals", cleanups.normals),
        ("outlier_removal", clouds.outlier_removal),
        ("patch_distance", patches.patch_distance),
        ("plate_corners", frames.plate_corners),
        ("poisson", cleanups.poisson),
        ("probe_planner", probes.probe_planner),
        ("region_grow", surfaces.region_grow),
        ("repair", cleanups.repair),
        ("sculpt", surfaces.sculpt),
        ("smooth", cleanups.smooth),
        ("tessellate", patches.tessellate),
        ("tight_cocone", cocones.tight_cocone),
        ("transfer", clouds.transfer),
        ("virtual_probe", frames.virtual_probe),
        ("probe_compensate", frames.probe_compensate),
        ("virtual_scan", clouds.virtual_scan),
        ("voxel_thin", clouds.voxel_thin),
    ):
        draw().write(filters / name / "picture.svg")


main()
