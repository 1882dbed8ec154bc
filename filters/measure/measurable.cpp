// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/measurable.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/size_limits.hpp"
#include "scanmill/kinds/length_scale.hpp"

namespace scanmill::measuring {

void require_sound(const MeasureParams& params) {
    if (params.samples < fewest_samples)
        throw Error("samples is {}; at least {} are needed for a spread of the mean", params.samples, fewest_samples)
            .hint("100000 are a good number for most meshes");
    const double gap = params.gap.value();
    if (!(gap > 0 && gap < 1))
        throw Error("gap is {}; it must be above 0 % and below 100 %", params.gap.text())
            .hint("a smaller gap takes longer: 1 % is a good one");
}

std::vector<double> thresholds_for(const TriangleMesh& mesh, const MeasureParams& params) {
    const LengthScale scale{mesh.frame.unit, [&] { return surface_box(mesh).diagonal(); },
                            [&] { return edge_spacing(mesh); }};
    std::vector<double> thresholds;
    for (const Length& threshold : params.thresholds) {
        thresholds.push_back(threshold.resolved(scale).value());
        if (!(thresholds.back() > 0 && std::isfinite(thresholds.back())))
            throw Error("the threshold {} comes to {} in the unit of the mesh; thresholds must be above 0 and finite",
                        threshold.text(), number_text(thresholds.back()))
                .hint("give it as a share of the mesh's size, as 0.5 %diag");
    }
    return thresholds;
}

void require_squares(const BoundingBox& box, std::string_view name) {
    require_finite_size(box);
    const double size = box.diagonal();
    if (!(size > 1e-60 && size < 1e60))
        throw Error("the {} is {:.3g} in size; between 1e-60 and 1e60 is needed for its squares to be numbers", name,
                    size)
            .hint("give it in another unit; `scanmill info` tells what a file holds");
}

void require_surface(const TriangleMesh& mesh, std::string_view name) {
    if (mesh.triangles.empty())
        throw Error("the {} has no triangles ({}); there is no surface to measure", name,
                    counted(mesh.positions.size(), "vertex", "vertices"))
            .hint("make a surface of the points first; only the truth may be points");
    require_consistent(mesh);
    require_finite(mesh.positions.span(), fmt::format("vertices of the {}", name));
    require_squares(surface_box(mesh), name);
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& origin = mesh.positions[a];
        if ((mesh.positions[b] - origin).cross(mesh.positions[c] - origin).squaredNorm() > 0) return;
    }
    throw Error("{} of the {} has {} area; there is no surface to measure",
                mesh.triangles.size() == 1 ? "the only triangle"
                                           : fmt::format("none of the {} triangles", mesh.triangles.size()),
                name, by_count(mesh.triangles.size(), "no", "an"))
        .hint("`scanmill info` tells what a file holds");
}

}  // namespace scanmill::measuring
