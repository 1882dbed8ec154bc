// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"
#include "vtu/vtu.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"VTU",
             {"vtu"},
             {"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\"", "<VTKFile type=\"UnstructuredGrid\""},
             {kind_of<TetMesh>(), kind_of<PatchComplex>()},
             false},
            {},
            {{kind_of<TetMesh>(), vtk::write_vtu}, {kind_of<PatchComplex>(), vtk::write_vtu_patches}}};
}
