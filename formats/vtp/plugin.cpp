// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"
#include "vtp/vtp.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"VTP",
             {"vtp"},
             {"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"", "<VTKFile type=\"PolyData\""},
             {Kind::points, Kind::mesh, Kind::features},
             false},
            {},
            {{Kind::points, vtk::write_vtp_points},
             {Kind::mesh, vtk::write_vtp_mesh},
             {Kind::features, vtk::write_vtp_features}}};
}
