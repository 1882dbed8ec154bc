// SPDX-License-Identifier: GPL-3.0-or-later
#include "repair/orient_soup.hpp"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>

#include <cstddef>

namespace scanmill {

std::vector<u32> orient_soup(std::size_t vertices, std::vector<Triangle>& triangles) {
    // CGAL only copies points, so the number of a vertex serves as its point.
    std::vector<u32> originals(vertices);
    for (u32 v = 0; v < vertices; ++v) originals[v] = v;
    std::vector<std::vector<std::size_t>> polygons;
    polygons.reserve(triangles.size());
    for (const auto& [a, b, c] : triangles) polygons.push_back({a, b, c});
    CGAL::Polygon_mesh_processing::orient_polygon_soup(originals, polygons);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) triangles[t][i] = static_cast<u32>(polygons[t][i]);
    originals.erase(originals.begin(), originals.begin() + static_cast<std::ptrdiff_t>(vertices));
    return originals;
}

}  // namespace scanmill
