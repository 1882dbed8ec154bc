// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The solid of most writer tests.

#include "support/shapes.hpp"

namespace scanmill::test {

inline TriangleMesh cube_in(LengthUnit unit, double edge = 1) {
    TriangleMesh mesh = cube(edge);
    mesh.frame.unit = unit;
    return mesh;
}

}  // namespace scanmill::test
