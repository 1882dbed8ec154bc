// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/cocone.hpp"

#include <fmt/format.h>

#include "cocone/pinholes.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

using namespace cocones;

CoconeResult cocone(const TetMesh& tets, const CoconeParams& params, Context& context) {
    require_usable(tets, params);
    const Diagram diagram(tets, params.cone_angle.in_radians(), context);
    context.progress(0.3);
    const Sampling samples = sampling(diagram, params, context);
    context.progress(0.5);
    Surface surface = surface_of(diagram, samples, params, context);
    context.progress(0.7);
    close_by_solid(diagram, samples, params, surface, context);

    CoconeResult result;
    result.mesh = SurfaceMesh(tets, surface).mesh;
    if (result.mesh.triangles.empty()) refuse_empty(tets, samples, surface, "");
    context.progress(0.9);
    face_outwards(result.mesh, context);
    const Array<Vec3> outward = outward_directions(tets.positions.span(), result.mesh.triangles.span());
    result.mesh.vertex_columns = with_sampling(tets, diagram, samples, outward, context);
    result.mesh = without_unused_vertices(result.mesh);
    result.unused = tets.positions.size() - result.mesh.positions.size();
    result.boundary_points = samples.boundary_points;
    result.pole_flat = samples.pole_flat;
    FeatureLines lines = find_features(
        result.mesh, {.sharp_angle = Angle::degrees(180), .min_length = {}, .noise = Length(0.0)}, context);
    result.loops = lines.counts.boundaries + lines.counts.holes;
    result.features = std::move(lines.graph);
    context.progress(1);

    if (result.unused > 0)
        context.warn(fmt::format("{} of {} points {} in no triangle", result.unused, tets.positions.size(),
                                 by_count(result.unused, "is", "are")));
    context.metric("triangles", static_cast<double>(result.mesh.triangles.size()));
    context.metric("boundary-points", static_cast<double>(result.boundary_points));
    context.metric("loops", static_cast<double>(result.loops));
    context.metric("unused-points", static_cast<double>(result.unused));
    context.metric("pole-flat", static_cast<double>(result.pole_flat));
    return result;
}

}  // namespace scanmill
