// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/cloud_surface.hpp"

#include <algorithm>
#include <numeric>

#include "cocone/cocone.hpp"
#include "delaunay/delaunay.hpp"
#include "delaunay/flatness.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"

namespace scanmill::updating {

namespace {

constexpr std::size_t least_edges = 8;
/// Shares of the longest loop below which other loops are ignored.
constexpr double least_share = 0.1;
/// A loop whose projected area does not decide whether it is a hole is one if it is shorter than this share of the
/// longest; both loops of a tube are outer.
constexpr double hole_share = 0.5;
const std::string row_column = "row";

std::size_t edges_between_boundary_points(const TriangleMesh& mesh) {
    const std::span<const u8> is_boundary = mesh.vertex_columns.find("boundary")->values<u8>();
    std::size_t edges = 0;
    const half_edges::ByVertex by_vertex = half_edges::by_smaller_vertex(mesh);
    half_edges::for_each_edge(by_vertex, [&](u32 vertex, std::span<const half_edges::VertexHalfEdge> edge) {
        edges += is_boundary[vertex] == 1 && is_boundary[edge[0].other] == 1;
    });
    return edges;
}

/// The positions; if they all lie in one plane, as simulated scans do, moved off it by a millionth of their extent.
Buffer<Vec3> spatial(const Buffer<Vec3>& positions, const Frame& frame, Context& context) {
    constexpr double share = 1e-6;
    const Extents found = extents(positions.span(), frame.origin, context.threads());
    if (found.from_plane > found.rounding || found.from_line <= found.rounding) return positions;
    Random random = context.random();
    Array<Vec3> moved(positions.begin(), positions.end());
    for (Vec3& position : moved)
        for (double& coordinate : position) coordinate += share * found.from_point * random.uniform(-1, 1);
    return moved;
}

/// Whether most of a loop runs along another component of the surface. The surface of a cloud may break at sharp edges,
/// where it does not end.
class Cracks {
public:
    Cracks(const TriangleMesh& mesh, std::span<const u32> component, double spacing, unsigned threads)
        : mesh_(mesh),
          distance_(width * spacing),
          tree_(mesh.positions.span(), threads),
          component_(tree_.positions().size(), ~u32(0)) {
        for (u32 t = 0; t < mesh.triangles.size(); ++t)
            for (const u32 vertex : mesh.triangles[t]) component_[tree_.index_of_row()[vertex]] = component[t];
    }

    bool contains(std::span<const u32> loop) {
        std::size_t near = 0;
        for (const u32 h : loop) {
            const u32 own = tree_.index_of_row()[half_edges::start(mesh_, h)];
            const std::span<const Neighbour> around = tree_.within(own, distance_ * distance_, buffer_);
            near += std::ranges::any_of(
                around, [&](const Neighbour& other) { return component_[other.index] != component_[own]; });
        }
        return 2 * near > loop.size();
    }

private:
    static constexpr double width = 2;  ///< largest width of a crack, in spacings of the cloud

    const TriangleMesh& mesh_;
    double distance_;
    PointTree tree_;
    std::vector<u32> component_;  ///< by position
    NeighbourBuffer buffer_;
};

void choose_loops(CloudSurface& surface, std::span<const u32> opposite) {
    const TriangleMesh& mesh = surface.mesh;
    const std::vector<Array<u32>> loops = boundary_loops(mesh, opposite);
    const FacetNormals normals = facet_normals(mesh, opposite, 1);
    std::vector<LoopShape> shapes;
    std::vector<std::span<const u32>> views;
    for (const Array<u32>& loop : loops) {
        shapes.push_back(loop_shape(mesh, loop, normals.unit));
        views.emplace_back(loop);
        surface.boundary_edges += loop.size();
    }
    const std::vector<bool> is_outer = outer_loops(views, shapes, opposite);
    const Array<u32> component = components_of(opposite);
    Array<double> longest(component.size(), 0.0);
    for (std::size_t i = 0; i < loops.size(); ++i) {
        double& length = longest[component[loops[i][0] / 3]];
        length = std::max(length, shapes[i].length);
    }
    Cracks cracks(mesh, component, surface.spacing, 1);
    const double all = longest.empty() ? 0 : *std::ranges::max_element(longest);
    for (std::size_t i = 0; i < loops.size(); ++i) {
        const double own = longest[component[loops[i][0] / 3]];
        const bool is_used = loops[i].size() >= least_edges && own >= least_share * all &&
                             shapes[i].length >= least_share * own && !cracks.contains(loops[i]);
        // The longest loop is the border, also of a cloud around most of the object.
        const bool is_hole =
            !is_outer[i] && shapes[i].length < own && (shapes[i].clear || shapes[i].length < hole_share * own);
        if (is_used)
            surface.loops.push_back({loops[i], shapes[i].length, is_hole});
        else
            ++surface.ignored_loops;
    }
}

}  // namespace

Array<u32> components_of(std::span<const u32> opposite) {
    DisjointSets sets(opposite.size() / 3);
    for (u32 h = 0; h < opposite.size(); ++h)
        if (opposite[h] < half_edges::no_half_edge) sets.unite(h / 3, opposite[h] / 3);
    Array<u32> component(opposite.size() / 3);
    for (u32 t = 0; t < component.size(); ++t) component[t] = sets.find(t);
    return component;
}

CloudSurface cloud_surface(const Buffer<Vec3>& positions, const Frame& frame, Context& context) {
    PointCloud cloud;
    cloud.frame = frame;
    cloud.positions = spatial(positions, frame, context);
    Array<u32> rows(positions.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    cloud.columns.add(Column(row_column, 1, Buffer<u32>(std::move(rows))));
    const DelaunayResult tets = delaunay(cloud, {}, context);
    CloudSurface surface;
    surface.mesh = cocone(tets.tets, {}, context).mesh;
    const std::span<const u32> row_of = surface.mesh.vertex_columns.find(row_column)->values<u32>();
    surface.mesh.positions = gather(positions, row_of);
    surface.spacing = point_spacing(positions.span());
    if (surface.spacing == 0)
        throw Error("more than half of the {} points are duplicates, so the cloud has no spacing", positions.size())
            .hint("give each scan once; voxel-thin removes duplicates");
    surface.paper_edges = edges_between_boundary_points(surface.mesh);
    choose_loops(surface, half_edges::opposites(surface.mesh));
    if (surface.loops.empty())
        throw Error(
            "the cloud has no boundary: its surface of {} triangles is closed, or has only loops of fewer than {} "
            "edges; a local cloud ends on the model, in one or more loops",
            surface.mesh.triangles.size(), least_edges)
            .hint("a scan of the whole object needs no model: use delaunay and tight-cocone");
    return surface;
}

}  // namespace scanmill::updating
