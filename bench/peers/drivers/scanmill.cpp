// SPDX-License-Identifier: GPL-3.0-or-later
/// Our side of the rows: the filters' algorithms, called as a C++ program calls them, on points in memory.

#include <variant>

#include "alpha_solid/alpha_solid.hpp"
#include "answer.hpp"
#include "delaunay/delaunay.hpp"
#include "scanmill/formats/files.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace {

using namespace scanmill;
using peers::Json;

/// What "load" and "read" left for the jobs that follow.
struct Held {
    PointCloud cloud;
    Value file;
};

Context context_for(const Json& request) {
    ContextOptions options;
    options.threads = peers::threads_of(request);
    return Context(options);
}

Json load(Held& held, const Json& request) {
    const peers::RawInput raw = peers::read_raw(request.at("path"));
    Array<Vec3> positions(raw.points.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = Vec3(raw.points[i].data());
    held.cloud.positions = std::move(positions);
    return raw.counts();
}

Json sizes(const Value& value) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value))
        return {{"points", (*mesh)->positions.size()}, {"triangles", (*mesh)->triangles.size()}};
    return {{"points", std::get<std::shared_ptr<const PointCloud>>(value)->size()}, {"triangles", 0}};
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
    params.grid_origin = Vec3::Zero();  // as PCL's grids, whose bins begin at whole multiples of their size
    Context context = context_for(request);
    VoxelThinResult result;
    const double seconds = peers::seconds_of([&] { result = voxel_thin(held.cloud, params, context); });
    return {{"seconds", seconds}, {"kept", result.points.size()}};
}

Json tetrahedralise(Held& held, const Json& request) {
    Context context = context_for(request);
    DelaunayResult result;
    const double seconds = peers::seconds_of([&] { result = delaunay(held.cloud, {}, context); });
    return {{"seconds", seconds}, {"cells", result.tets.cells.size()}, {"vertices", result.tets.positions.size()}};
}

/// With "alpha", at that radius; without, at the one that is chosen. The tetrahedralisation counts.
Json solid(Held& held, const Json& request) {
    AlphaSolidParams params;
    if (request.contains("alpha")) params.alpha = request["alpha"].get<double>();
    Context context = context_for(request);
    AlphaSolidResult result;
    const double seconds = peers::seconds_of([&] {
        const DelaunayResult tets = delaunay(held.cloud, {}, context);
        result = alpha_solid(tets.tets, params, context);
    });
    return {{"seconds", seconds}, {"alpha", result.alpha}, {"triangles", result.mesh.triangles.size()}};
}

}  // namespace

int main() {
    Held held;
    const auto with_held = [&held](Json (*job)(Held&, const Json&)) {
        return [&held, job](const Json& request) { return job(held, request); };
    };
    // A job "distances" joins here once the filter measure has its function: see rows/distances.py.
    return peers::answer({{"load", with_held(load)},
                          {"read", with_held(read)},
                          {"write", with_held(write)},
                          {"voxel-thin", with_held(thin)},
                          {"delaunay", with_held(tetrahedralise)},
                          {"alpha-solid", with_held(solid)}},
                         {{"Scanmill", SCANMILL_VERSION}});
}
