// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"
#include "vtp/vtp.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"VTP",
             {"vtp"},
             {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"", "<VTKFile type=\"PolyData\""},
             {kind_of<PointCloud>(), kind_of<TriangleMesh>(), kind_of<FeatureGraph>(), kind_of<ProbePlan>()},
             false},
            {},
            {{kind_of<PointCloud>(), vtk::write_vtp_points},
             {kind_of<TriangleMesh>(), vtk::write_vtp_mesh},
             {kind_of<FeatureGraph>(), vtk::write_vtp_features},
             {kind_of<ProbePlan>(), vtk::write_vtp_probes}}};
}
