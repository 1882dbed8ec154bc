// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/pinholes.hpp"

#include <algorithm>
#include <bit>

#include "cocone/candidates.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::cocones {

namespace {

bool is_inside(std::span<const u8> labels, const Side& side) { return side.is_cell() && labels[side.cell] == 1; }

bool is_on_boundary(const TetMesh& tets, std::span<const u8> labels, const Side& side) {
    return is_inside(labels, side) != is_inside(labels, other_side(tets, side));
}

bool is_inner(const Surface& surface, const Side& side) {
    return side.is_cell() && (surface.inner[side.cell] >> side.corner & 1) != 0;
}

/// A gap of the surface in the solid's boundary.
struct Gap {
    std::vector<Side> facets;  ///< seen from their inner cells
    bool touches_surface = false, may_be_closed = true;
};

class Gaps {
public:
    Gaps(const TetMesh& tets, const Sampling& sampling, double lid_factor, std::span<const u8> labels,
         const Surface& surface)
        : tets_(tets),
          sampling_(sampling),
          lid_factor_(lid_factor),
          labels_(labels),
          surface_(surface),
          seen_(tets.cells.size()) {}

    std::vector<Gap> all() {
        std::vector<Gap> gaps;
        for (u32 cell = 0; cell < labels_.size(); ++cell)
            for (int corner = 0; corner < 4 && labels_[cell] == 1; ++corner)
                if (const Side side{cell, corner}; is_gap(side) && !seen_.contains(side)) gaps.push_back(gap_at(side));
        return gaps;
    }

private:
    bool is_gap(const Side& side) const {
        return is_on_boundary(tets_, labels_, side) && !surface_.facets.contains(side);
    }

    Gap gap_at(const Side& seed) {
        Gap gap;
        const auto reach = [&](const Side& side) {
            const Side inner = is_inside(labels_, side) ? side : other_side(tets_, side);
            if (seen_.contains(inner)) return;
            seen_.add(tets_, inner);
            gap.facets.push_back(inner);
        };
        reach(seed);
        for (std::size_t i = 0; i < gap.facets.size(); ++i) {
            const Side side = gap.facets[i];
            const Triangle corners = corners_of(tets_, side);
            if (spans_opening(tets_, sampling_, lid_factor_, corners)) gap.may_be_closed = false;
            for (const u32 third : corners) {
                std::size_t on_boundary = 0, on_surface = 0, on_both = 0;
                bool agrees = true;
                for_each_facet_at(tets_, side, third, [&](const Side& other) {
                    const bool its = surface_.facets.contains(other);
                    on_surface += its;
                    if (!is_on_boundary(tets_, labels_, other)) return;
                    ++on_boundary;
                    on_both += its;
                    if (its)
                        agrees &= is_inner(surface_, is_inside(labels_, other) ? other : other_side(tets_, other));
                    else
                        reach(other);
                });
                gap.touches_surface |= on_both > 0;
                if (on_boundary != 1 || on_surface != on_both || !agrees) gap.may_be_closed = false;
            }
        }
        return gap;
    }

    const TetMesh& tets_;
    const Sampling& sampling_;
    double lid_factor_;
    std::span<const u8> labels_;
    const Surface& surface_;
    FacetSet seen_;
};

}  // namespace

bool face_outside(const TetMesh& tets, std::span<const u8> labels, const SurfaceMesh& mesh, Surface& surface) {
    const std::size_t count = mesh.mesh.triangles.size();
    DisjointSets components(count);
    for (u32 h = 0; h < mesh.opposite.size(); ++h)
        if (mesh.opposite[h] < mesh.opposite.size()) components.unite(h / 3, mesh.opposite[h] / 3);
    Array<double> excess(count, 0.0);  // by component: area that faces outside minus area that faces inside
    const auto for_each_facet = [&](const auto& visit) {
        u32 number = 0;
        for (u32 cell = 0; cell < tets.cells.size(); ++cell)
            for (unsigned bits = surface.facets.of(cell); bits != 0; bits &= bits - 1)
                if (const Side side{cell, std::countr_zero(bits)}; owns_facet(tets, cell, side.corner))
                    visit(side, components.find(number++));
    };
    for_each_facet([&](const Side& side, u32 component) {
        if (!is_on_boundary(tets, labels, side)) return;
        const double area = area_vector(tets.positions.span(), corners_of(tets, side)).norm();
        excess[component] += is_inside(labels, side) == is_inner(surface, side) ? area : -area;
    });
    if (std::ranges::none_of(excess, [](double area) { return area < 0; })) return false;
    for_each_facet([&](const Side& side, u32 component) {
        if (!(excess[component] < 0)) return;
        for (const Side& its : {side, other_side(tets, side)})
            if (its.is_cell()) surface.inner[its.cell] = static_cast<u8>(surface.inner[its.cell] ^ 1 << its.corner);
    });
    return true;
}

std::size_t close_pinholes(const TetMesh& tets, const Sampling& sampling, double lid_factor, std::span<const u8> labels,
                           Surface& surface) {
    std::size_t closed = 0;
    for (const Gap& gap : Gaps(tets, sampling, lid_factor, labels, surface).all()) {
        if (!gap.may_be_closed || !gap.touches_surface) continue;
        ++closed;
        for (const Side& side : gap.facets) {
            surface.facets.add(tets, side);
            surface.inner[side.cell] = static_cast<u8>(surface.inner[side.cell] | 1 << side.corner);
        }
    }
    return closed;
}

namespace {

/// Peels the solid off the surface, lets the surface face outside and closes its pinholes.
SurfaceWithSolid close_by_solid(const Diagram& diagram, const Sampling& sampling, const CoconeParams& params,
                                Surface& surface, Context& context) {
    const TetMesh& tets = diagram.tets;
    SurfaceMesh mesh(tets, surface);
    Peeling peeling = peel(diagram, surface, mesh, sampling.flat, context);
    const bool is_turned = face_outside(tets, peeling.labels, mesh, surface);
    const std::size_t closed = close_pinholes(tets, sampling, params.lid_factor, peeling.labels, surface);
    if (is_turned || closed > 0) mesh = SurfaceMesh(tets, surface);
    return {std::move(peeling), std::move(mesh)};
}

/// Returns the value, and reports the fraction of the work that is done with it.
template <class Value>
Value reported(Value value, double fraction, Context& context) {
    context.progress(fraction);
    return value;
}

}  // namespace

Reconstruction::Reconstruction(const TetMesh& given, const CoconeParams& params, Context& context)
    : spatial(reported(in_spatial_order(given, context), 0.1, context)),
      diagram(spatial.tets, params.cone_angle.in_radians(), context),
      samples(reported(sampling(diagram, params, context), 0.5, context)),
      surface(reported(surface_of(diagram, samples, params, context), 0.7, context)),
      solid(reported(close_by_solid(diagram, samples, params, surface, context), 0.8, context)) {}

}  // namespace scanmill::cocones
