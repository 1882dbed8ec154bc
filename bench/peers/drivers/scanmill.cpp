// SPDX-License-Identifier: GPL-3.0-or-later
/// The Scanmill driver: calls the filters' algorithms as a C++ program does, on points in memory.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <variant>

#include "a_patch/a_patch.hpp"
#include "alpha_solid/alpha_solid.hpp"
#include "answer.hpp"
#include "cluster_mesh/cluster_mesh.hpp"
#include "decimate/decimate.hpp"
#include "delaunay/delaunay.hpp"
#include "fill_holes/fill_holes.hpp"
#include "icp/icp.hpp"
#include "inspect/inspect.hpp"
#include "measure/measure.hpp"
#include "mesh_update/mesh_update.hpp"
#include "normals/normals.hpp"
#include "outlier_removal/outlier_removal.hpp"
#include "poisson/poisson.hpp"
#include "region_grow/region_grow.hpp"
#include "render/render.hpp"
#include "repair/repair.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/distance/certified_hausdorff.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/fit/local_surface.hpp"
#include "sculpt/sculpt.hpp"
#include "smooth/smooth.hpp"
#include "tessellate/tessellate.hpp"
#include "tight_cocone/tight_cocone.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace {

using namespace scanmill;
using peers::Json;

/// The data that "load" and "read" keep for the following jobs.
struct Held {
    PointCloud cloud;
    Array<Triangle> triangles;
    Array<Vec3> queries;
    Array<Triangle> query_triangles;
    Value file;
    TriangleMesh model;  ///< closed mesh of the cloud
    std::vector<std::shared_ptr<const PointCloud>> scans;  ///< scans that show a part of the model

    TriangleMesh mesh() const {
        TriangleMesh mesh;
        mesh.positions = cloud.positions;
        mesh.triangles = triangles;
        return mesh;
    }
};

Context context_for(const Json& request) {
    ContextOptions options;
    options.threads = peers::threads_of(request);
    return Context(options);
}

Array<Vec3> positions_of(const peers::RawInput& raw) {
    Array<Vec3> positions(raw.points.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = Vec3(raw.points[i].data());
    return positions;
}

peers::RawInput raw_of(const TriangleMesh& mesh) {
    peers::RawInput raw;
    for (const Vec3& p : mesh.positions) raw.points.push_back({p.x(), p.y(), p.z()});
    raw.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
    return raw;
}

Json load(Held& held, const Json& request) {
    const peers::RawInput raw = peers::read_raw(request.at("path"));
    held.cloud.positions = positions_of(raw);
    held.cloud.columns = {};
    if (!raw.weights.empty())
        held.cloud.columns.add(
            Column("weight", 1, Buffer<double>(Array<double>(raw.weights.begin(), raw.weights.end()))));
    if (!raw.normals.empty()) {
        Array<float> normals;
        for (const auto& normal : raw.normals)
            for (const double number : normal) normals.push_back(static_cast<float>(number));
        held.cloud.columns.add(Column("normal", 3, Buffer<float>(std::move(normals))));
    }
    held.triangles.assign(raw.triangles.begin(), raw.triangles.end());
    if (request.contains("points")) {
        const peers::RawInput queries = peers::read_raw(request["points"]);
        held.queries = positions_of(queries);
        held.query_triangles.assign(queries.triangles.begin(), queries.triangles.end());
    }
    return raw.counts();
}

Json sizes(const Value& value) {
    if (const auto* mesh = value.find<TriangleMesh>())
        return {{"points", mesh->positions.size()}, {"triangles", mesh->triangles.size()}};
    return {{"points", value.get<PointCloud>()->size()}, {"triangles", 0}};
}

Json read(Held& held, const Json& request) {
    const std::string path = request.at("path");
    held.file = Value();
    const double seconds = peers::seconds_of([&] { held.file = read_file(path).value; });
    Json answer = sizes(held.file);
    answer["seconds"] = seconds;
    return answer;
}

Json write(Held& held, const Json& request) {
    const std::string path = request.at("path");
    const double seconds = peers::seconds_of([&] { write_file(path, held.file); });
    return {{"seconds", seconds}, {"bytes", std::filesystem::file_size(path)}};
}

Json thin(Held& held, const Json& request) {
    VoxelThinParams params;
    params.bin_size = request.at("bin_size").get<double>();
    params.grid_origin = Vec3::Zero();  // as in PCL, whose voxels begin at multiples of their size
    Context context = context_for(request);
    VoxelThinResult result;
    const double seconds = peers::seconds_of([&] { result = voxel_thin(held.cloud, params, context); });
    return {{"seconds", seconds}, {"kept", result.points.size()}};
}

/// "min_component" is in percent; with 0 the mean distances alone decide, as in PCL.
Json remove_outliers(Held& held, const Json& request) {
    OutlierRemovalParams params;
    params.neighbours = request.at("neighbours").get<u32>();
    params.factor = request.at("factor").get<double>();
    params.min_component = Ratio::percent(request.at("min_component").get<double>());
    Context context = context_for(request);
    OutlierRemovalResult result;
    const double seconds = peers::seconds_of([&] { result = outlier_removal(held.cloud, params, context); });
    return {{"seconds", seconds}, {"kept", result.points.size()}};
}

/// Planes, quadrics and principal curvatures; includes the tree and the search for neighbours.
Json curvature(Held& held, const Json& request) {
    LocalSurfaceParams params;
    params.neighbours = request.at("neighbours").get<u32>();
    Context context = context_for(request);
    Array<LocalSurface> surfaces;
    std::vector<u32> index_of_row;
    const double seconds = peers::seconds_of([&] {
        const PointTree tree(held.cloud.positions.span(), context.threads());
        surfaces = local_surfaces(tree, params, context);
        index_of_row.assign(tree.index_of_row().begin(), tree.index_of_row().end());
    });
    std::size_t along_x = 0;
    for (const u32 index : index_of_row) {
        const Vec3 n = surfaces[index].normal.cwiseAbs();
        along_x += n.x() > n.y() && n.x() > n.z();
    }
    return {{"seconds", seconds}, {"along_x", static_cast<double>(along_x) / static_cast<double>(index_of_row.size())}};
}

/// With "jet" by jets, else by planes; with "oriented" along a spanning tree.
Json estimate_normals(Held& held, const Json& request) {
    NormalsParams params;
    params.neighbours = request.at("neighbours").get<u32>();
    params.method = request.value("jet", false) ? NormalsParams::Method::jet : NormalsParams::Method::pca;
    params.orient = request.value("oriented", false) ? NormalsParams::Orient::tree : NormalsParams::Orient::none;
    Context context = context_for(request);
    NormalsResult result;
    const double seconds = peers::seconds_of([&] { result = normals(held.cloud, params, context); });
    peers::Vectors points, vectors;
    const std::span<const float> values = result.points.columns.find("normal")->values<float>();
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const Vec3& p = result.points.positions[i];
        points.push_back({p.x(), p.y(), p.z()});
        vectors.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    }
    Json answer = peers::directions(request, points, vectors);
    answer["seconds"] = seconds;
    return answer;
}

Json smoothed(Held& held, const Json& request) {
    SmoothParams params;
    params.neighbours = request.at("neighbours").get<u32>();
    Context context = context_for(request);
    SmoothResult result;
    const double seconds = peers::seconds_of([&] { result = smooth(held.cloud, params, context); });
    return {{"seconds", seconds}, {"moved_rms", result.moved_rms}};
}

Json tetrahedralise(Held& held, const Json& request) {
    Context context = context_for(request);
    DelaunayResult result;
    const double seconds = peers::seconds_of([&] { result = delaunay(held.cloud, {}, context); });
    return {{"seconds", seconds}, {"cells", result.tets.cells.size()}, {"vertices", result.tets.positions.size()}};
}

/// The alpha-solid at the radius "alpha", or at an automatic radius without it; "weighted" uses the weights of the
/// points. The time includes the tetrahedralisation.
Json solid(Held& held, const Json& request) {
    AlphaSolidParams params;
    if (request.contains("alpha")) params.alpha = request["alpha"].get<double>();
    DelaunayParams shape;
    if (request.value("weighted", false)) shape.weights = "weight";
    Context context = context_for(request);
    std::optional<DelaunayResult> tets;
    AlphaSolidResult result;
    const double tetrahedralising = peers::seconds_of([&] { tets = delaunay(held.cloud, shape, context); });
    const double choosing = peers::seconds_of([&] { result = alpha_solid(tets->tets, params, context); });
    return {{"seconds", tetrahedralising + choosing},
            {"delaunay_seconds", tetrahedralising},
            {"alpha_solid_seconds", choosing},
            {"cells", tets->tets.cells.size()},
            {"alpha", result.alpha},
            {"triangles", result.mesh.triangles.size()}};
}

/// From points to the sculpted mesh. Frees the inputs that the following steps do not need, as a workflow does between
/// its steps.
Json sculpted(Held& held, const Json& request) {
    Context context = context_for(request);
    std::optional<DelaunayResult> tets;
    const double tetrahedralising = peers::seconds_of([&] { tets = delaunay(held.cloud, {}, context); });
    const std::size_t cells = tets->tets.cells.size();
    std::optional<AlphaSolidResult> solid;
    const double choosing = peers::seconds_of([&] {
        solid = alpha_solid(tets->tets, {}, context);
        tets.reset();
    });
    SculptResult result;
    const double sculpting = peers::seconds_of([&] { result = sculpt(solid->tets, {}, context); });
    return {{"seconds", tetrahedralising + choosing + sculpting},
            {"delaunay_seconds", tetrahedralising},
            {"alpha_solid_seconds", choosing},
            {"sculpt_seconds", sculpting},
            {"cells", cells},
            {"alpha", solid->alpha},
            {"removed", result.removals.size()},
            {"interior_points", result.blocked_points.size() + result.deep_points.size()},
            {"triangles", result.mesh.triangles.size()}};
}

/// From points to the closed mesh of tight-cocone.
Json tightly_closed(Held& held, const Json& request) {
    Context context = context_for(request);
    DelaunayResult tets;
    const double tetrahedralising = peers::seconds_of([&] { tets = delaunay(held.cloud, {}, context); });
    TightCoconeResult result;
    const double closing = peers::seconds_of([&] { result = tight_cocone(tets.tets, {}, context); });
    return {{"seconds", tetrahedralising + closing},     {"delaunay_seconds", tetrahedralising},
            {"tight_cocone_seconds", closing},           {"cells", tets.tets.cells.size()},
            {"triangles", result.mesh.triangles.size()}, {"unused", result.unused}};
}

/// Loads points, makes a closed mesh of them, and scans a part of it again: the centroids of the 5,000 triangles
/// nearest to its highest vertex.
Json load_model(Held& held, const Json& request) {
    Json loaded = load(held, request);
    Context context;
    held.model = tight_cocone(delaunay(held.cloud, {}, context).tets, {}, context).mesh;
    const auto& positions = held.model.positions;
    constexpr std::size_t scanned = 5000;
    const Vec3 top = *std::ranges::max_element(positions, {}, [](const Vec3& p) { return p.z(); });
    Array<Vec3> points;
    for (const auto& [a, b, c] : held.model.triangles)
        points.push_back((positions[a] + positions[b] + positions[c]) / 3);
    std::ranges::sort(points, {}, [&](const Vec3& point) { return (point - top).squaredNorm(); });
    points.resize(std::min(points.size(), scanned));
    PointCloud scan;
    scan.positions = std::move(points);
    held.scans = {std::make_shared<const PointCloud>(std::move(scan))};
    return loaded;
}

Json updated(Held& held, const Json& request) {
    Context context = context_for(request);
    MeshUpdateParams params;
    if (request.at("rebuild") == "local") params.rebuild = MeshUpdateParams::Rebuild::local;
    MeshUpdateResult result;
    const double seconds = peers::seconds_of([&] { result = mesh_update(held.model, held.scans, params, context); });
    return {{"seconds", seconds},
            {"added", result.added},
            {"discarded", result.discarded},
            {"replaced", result.replaced},
            {"triangles", result.mesh.triangles.size()}};
}

Json grown(Held& held, const Json& request) {
    Context context = context_for(request);
    RegionGrowResult result;
    const double seconds = peers::seconds_of([&] { result = region_grow(held.cloud, {}, context); });
    return {{"seconds", seconds},
            {"triangles", result.mesh.triangles.size()},
            {"loops", result.loops},
            {"unused", result.unused_points}};
}

Json clustered(Held& held, const Json& request) {
    Context context = context_for(request);
    ClusterMeshResult result;
    const double seconds = peers::seconds_of([&] { result = cluster_mesh(held.cloud, {}, context); });
    return {{"seconds", seconds},
            {"triangles", result.mesh.triangles.size()},
            {"loops", result.loops},
            {"unused", result.unused_points}};
}

Json distances(Held& held, const Json& request) {
    Context context = context_for(request);
    std::optional<TriangleTree> tree;
    const double building = peers::seconds_of(
        [&] { tree.emplace(held.cloud.positions.span(), std::span(held.triangles), context.threads()); });
    NearestDistances found;
    const double asking = peers::seconds_of([&] { found = nearest_distances(held.queries, *tree, 0, context); });
    double sum = 0, squares = 0;
    for (const double distance : found.distances) sum += distance, squares += distance * distance;
    const auto count = static_cast<double>(found.distances.size());
    return {{"seconds", building + asking},
            {"building_seconds", building},
            {"mean", sum / count},
            {"rms", std::sqrt(squares / count)},
            {"max", *std::ranges::max_element(found.distances)}};
}

/// The whole filter on the held mesh as the nominal, with statistics, labels and the map.
Json inspected(Held& held, const Json& request) {
    const double tolerance = request.at("tolerance").get<double>();
    InspectParams params;
    params.tolerance = {-tolerance, tolerance};
    params.max_distance = request.at("max_distance").get<double>();
    PointCloud scan;
    scan.positions = held.queries;
    const TriangleMesh nominal = held.mesh();
    Context context = context_for(request);
    Inspection found;
    const double seconds = peers::seconds_of([&] { found = inspect(scan, nominal, nullptr, params, context); });
    return {{"seconds", seconds},
            {"rms", found.numbers.rms},
            {"min", found.numbers.min},
            {"max", found.numbers.max},
            {"in_tolerance", found.numbers.in_tolerance}};
}

Json reconstructed(Held& held, const Json& request) {
    PoissonParams params;
    params.depth = request.at("depth").get<u32>();
    params.scale = request.at("scale").get<double>();
    params.trim = Ratio::percent(0);
    Context context = context_for(request);
    PoissonResult result;
    const double seconds = peers::seconds_of([&] { result = poisson(held.cloud, params, context); });
    const peers::RawInput mesh = raw_of(result.mesh);
    return {{"seconds", seconds},
            {"triangles", mesh.triangles.size()},
            {"volume", peers::enclosed_volume(mesh.points, mesh.triangles)}};
}

Json filled(Held& held, const Json& request) {
    const TriangleMesh mesh = held.mesh();
    Context context = context_for(request);
    FillHolesResult result;
    const double seconds = peers::seconds_of([&] { result = fill_holes(mesh, {}, context); });
    const peers::RawInput closed = raw_of(result.mesh);
    return {{"seconds", seconds},
            {"boundary_edges", peers::boundary_edges(closed.triangles)},
            {"triangles", closed.triangles.size()},
            {"volume", peers::enclosed_volume(closed.points, closed.triangles)}};
}

Json repaired(Held& held, const Json& request) {
    const TriangleMesh soup = held.mesh();
    Context context = context_for(request);
    RepairResult result;
    const double seconds = peers::seconds_of([&] { result = repair(soup, {}, context); });
    const peers::RawInput mesh = raw_of(result.mesh);
    return {{"seconds", seconds},
            {"points", mesh.points.size()},
            {"boundary_edges", peers::boundary_edges(mesh.triangles)},
            {"enclosed", std::abs(peers::enclosed_volume(mesh.points, mesh.triangles))}};
}

/// The mesh against the second input, a mesh too, without the search for self-intersections.
Json measured(Held& held, const Json& request) {
    const TriangleMesh mesh = held.mesh();
    TriangleMesh truth;
    truth.positions = held.queries;
    truth.triangles = held.query_triangles;
    MeasureParams params;
    params.samples = request.at("samples").get<u32>();
    params.self_intersections = false;
    Context context = context_for(request);
    std::optional<Measurement> result;
    const double seconds = peers::seconds_of([&] { result = measure(mesh, truth, params, context); });
    return {{"seconds", seconds}, {"mean", result->chamfer.value()}, {"area", result->mesh.area}};
}

/// A smooth surface through the vertices, and triangles on it with every edge in "segments" parts.
Json patched(Held& held, const Json& request) {
    const TriangleMesh mesh = held.mesh();
    Context context = context_for(request);
    APatchResult patches;
    const double patching = peers::seconds_of([&] { patches = a_patch(mesh, nullptr, {}, context); });
    TessellateParams params;
    params.subdivision = request.at("segments").get<u32>();
    TriangleMesh fine;
    const double cutting = peers::seconds_of([&] { fine = tessellate(patches.patches, params, context); });
    return {{"seconds", patching + cutting}, {"a_patch_seconds", patching}, {"triangles", fine.triangles.size()}};
}

/// Removes vertices until "triangles" are left, within "max_error" percent of the diagonal. The seconds include the
/// certificate; a second computation of it shows its part.
Json decimated(Held& held, const Json& request) {
    const TriangleMesh mesh = held.mesh();
    DecimateParams params;
    const BoundingBox box = bounding_box(mesh.positions.span());
    const double max_error = request.at("max_error").get<double>() / 100 * (box.high - box.low).norm();
    params.max_error = max_error;
    params.target_triangles = request.at("triangles").get<u64>();
    Context context = context_for(request);
    DecimateResult result;
    const double seconds = peers::seconds_of([&] { result = decimate(mesh, nullptr, params, context); });
    const CertifyLimits limits{.gap = 0.01, .most_cuts = 100'000'000, .bound = max_error};
    const double certifying = peers::seconds_of([&] { certified_hausdorff(result.mesh, mesh, limits, context); });
    return {{"seconds", seconds},
            {"certificate_seconds", certifying},
            {"input_triangles", mesh.triangles.size()},
            {"triangles", result.mesh.triangles.size()}};
}

/// A picture from above, z towards the camera.
Json drawn(Held& held, const Json& request) {
    const TriangleMesh mesh = held.mesh();
    RenderParams params;
    params.size = {request.at("width").get<u32>(), request.at("height").get<u32>()};
    params.camera = {CameraView::top};
    params.up = UpAxis::z;
    Context context = context_for(request);
    Picture picture;
    const double seconds = peers::seconds_of([&] { picture = render({&mesh, {}, {}}, params, context); });
    const auto is_covered = [](const Colour& colour) { return colour != Colour{255, 255, 255}; };
    const auto covered = static_cast<double>(std::ranges::count_if(picture.pixels, is_covered));
    return {{"seconds", seconds}, {"covered", covered / static_cast<double>(picture.pixels.size())}};
}

/// The motion from the second input to the points of the first, with their normals. "max_distance" is in percent of the
/// diagonal.
Json refined(Held& held, const Json& request) {
    PointCloud source;
    source.positions = held.queries;
    const BoundingBox box = bounding_box(held.queries);
    IcpParams params;
    params.max_distance = request.at("max_distance").get<double>() / 100 * box.diagonal();
    Context context = context_for(request);
    IcpResult result;
    const double seconds = peers::seconds_of([&] { result = icp(source, held.cloud, params, context); });
    const Vec3 centre = (box.low + box.high) / 2;
    const Eigen::Matrix3d& rotation = result.transform.rotation;
    return {{"seconds", seconds},
            {"angle", std::acos((rotation.trace() - 1) / 2) * 180 / std::numbers::pi},
            {"shift", (result.transform.apply(centre) - centre).norm()},
            {"residual", result.rms},
            {"iterations", result.iterations}};
}

}  // namespace

int main() {
    Held held;
    const auto with_held = [&held](Json (*job)(Held&, const Json&)) {
        return [&held, job](const Json& request) { return job(held, request); };
    };
    return peers::answer({{"load", with_held(load)},
                          {"read", with_held(read)},
                          {"write", with_held(write)},
                          {"voxel-thin", with_held(thin)},
                          {"remove-outliers", with_held(remove_outliers)},
                          {"curvature", with_held(curvature)},
                          {"normals", with_held(estimate_normals)},
                          {"smooth", with_held(smoothed)},
                          {"poisson", with_held(reconstructed)},
                          {"fill-holes", with_held(filled)},
                          {"repair", with_held(repaired)},
                          {"measure", with_held(measured)},
                          {"render", with_held(drawn)},
                          {"a-patch", with_held(patched)},
                          {"delaunay", with_held(tetrahedralise)},
                          {"alpha-solid", with_held(solid)},
                          {"sculpt", with_held(sculpted)},
                          {"tight-cocone", with_held(tightly_closed)},
                          {"load-model", with_held(load_model)},
                          {"mesh-update", with_held(updated)},
                          {"region-grow", with_held(grown)},
                          {"cluster-mesh", with_held(clustered)},
                          {"decimate", with_held(decimated)},
                          {"icp", with_held(refined)},
                          {"inspect", with_held(inspected)},
                          {"distances", with_held(distances)}},
                         {{"Scanmill", SCANMILL_VERSION}});
}
