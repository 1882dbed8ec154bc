// SPDX-License-Identifier: GPL-3.0-or-later
/// Makes the raw arrays that all programs of a row load. Coordinates are rounded to float, so that programs that store
/// floats work on the same points.
///
/// usage: peer_inputs scan FILE OUT | torus COUNT OUT | random-torus COUNT OUT | around RAW COUNT OUT |
///                    displaced RAW COUNT OUT | weighted RAW OUT | oriented RAW OUT | soup RAW OUT |
///                    holes RAW COUNT OUT
///   scan          the points of a file, and its triangles if it has any
///   torus         350000 or 3500000 evenly spread points in random order, on a bumpy torus with radii 1 and 0.4
///   random-torus  independent points, uniform by area, on a torus without bumps with these radii
///   weighted      the points of RAW with the weights of `delaunay: {weights: spacing}`
///   oriented      the points of RAW with normals of the mesh at its vertices, weighted by the triangles' areas
///   soup          the triangles of RAW, each with three points of its own, and every third one reversed
///   holes         RAW without the triangles within four edges of COUNT vertices, which are spread over the rows
///   around        points uniform on the triangles of RAW, moved by up to 1 % of its diagonal along each axis
///   displaced     points uniform on the triangles of RAW with normally distributed noise of 0.02 % of its diagonal
///                 along each axis; all turned by 1 degree about (1, 2, 3) and moved by 1 % of the diagonal along x

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "answer.hpp"
#include "delaunay/point_weights.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/value.hpp"
#include "support/point_sets.hpp"

namespace {

using peers::RawInput;
using scanmill::Vec3;

std::array<double, 3> rounded(const Vec3& p) {
    const auto as_float = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    return {as_float(p.x()), as_float(p.y()), as_float(p.z())};
}

RawInput scan(const std::string& file) {
    const scanmill::Value value = scanmill::read_file(file).value;
    RawInput raw;
    const auto take = [&](const auto& shape) {
        for (const Vec3& p : shape.positions) raw.points.push_back(rounded(shape.frame.origin + p));
    };
    if (const auto* mesh = value.find<scanmill::TriangleMesh>()) {
        take(*mesh);
        raw.triangles.assign(mesh->triangles.begin(), mesh->triangles.end());
    } else {
        take(*value.get<scanmill::PointCloud>());
    }
    return raw;
}

/// The minimum distance of that many evenly spread points, determined by trial.
double distance_for(std::size_t count) {
    if (count == 350'000) return 0.0052;
    if (count == 3'500'000) return 0.00164;
    throw std::runtime_error("tori have 350000 or 3500000 points, not " + std::to_string(count));
}

/// Moves a point along the tube's radius by up to a tenth of it. Spheres inside a torus without bumps touch it along
/// whole circles, so more than four points would be cospherical. Scans are not like that, and qhull does not terminate
/// on it.
Vec3 with_bumps(const Vec3& p) {
    const double around = std::atan2(p.y(), p.x()), along = std::atan2(p.z(), std::hypot(p.x(), p.y()) - 1);
    const Vec3 core(std::cos(around), std::sin(around), 0);
    return core + (1 + 0.1 * std::sin(5 * around) * std::cos(3 * along)) * (p - core);
}

RawInput torus(std::size_t count) {
    const scanmill::PointCloud cloud =
        scanmill::test::poisson_torus(distance_for(count), 0.4, std::size_t(1) << 20, 1, count);
    if (cloud.size() != count)
        throw std::runtime_error("the torus has room for only " + std::to_string(cloud.size()) + " points");
    RawInput raw;
    for (const Vec3& p : cloud.positions) raw.points.push_back(rounded(with_bumps(p)));
    return raw;
}

RawInput random_torus(std::size_t count) {
    scanmill::Random random(1);
    RawInput raw;
    while (raw.points.size() < count) {
        const double around = random.uniform(0, 2 * std::numbers::pi), along = random.uniform(0, 2 * std::numbers::pi);
        const double minor = 0.4, from_axis = 1 + minor * std::cos(along);
        // Area per angle grows with the distance from the axis.
        if (random.uniform(0, 1 + minor) > from_axis) continue;
        raw.points.push_back(
            rounded({from_axis * std::cos(around), from_axis * std::sin(around), minor * std::sin(along)}));
    }
    return raw;
}

Vec3 corner(const RawInput& mesh, std::uint32_t index) { return Vec3(mesh.points.at(index).data()); }

/// Cumulative areas of the triangles.
std::vector<double> areas_up_to(const RawInput& mesh) {
    std::vector<double> sums;
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 origin = corner(mesh, a);
        sum += (corner(mesh, b) - origin).cross(corner(mesh, c) - origin).norm() / 2;
        sums.push_back(sum);
    }
    return sums;
}

scanmill::BoundingBox box_of(const RawInput& mesh) {
    scanmill::BoundingBox box;
    for (const auto& p : mesh.points) box.add(Vec3(p.data()));
    return box;
}

/// Points uniform on the triangles, each changed by `change(point, random)`.
template <class Change>
RawInput sampled(const RawInput& mesh, std::size_t count, Change&& change) {
    if (mesh.triangles.empty()) throw std::runtime_error("points need a mesh, and the input has no triangles");
    const std::vector<double> areas = areas_up_to(mesh);
    scanmill::Random random(1);
    RawInput raw;
    for (std::size_t i = 0; i < count; ++i) {
        const auto chosen = std::upper_bound(areas.begin(), areas.end() - 1, random.uniform(0, areas.back()));
        const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(chosen - areas.begin())];
        const double root = std::sqrt(random.uniform()), share = random.uniform();
        Vec3 p = (1 - root) * corner(mesh, a) + root * (1 - share) * corner(mesh, b) + root * share * corner(mesh, c);
        change(p, random);
        raw.points.push_back(rounded(p));
    }
    return raw;
}

RawInput around(const RawInput& mesh, std::size_t count) {
    const double amount = 0.01 * box_of(mesh).diagonal();
    return sampled(mesh, count, [&](Vec3& p, scanmill::Random& random) {
        for (int axis = 0; axis < 3; ++axis) p[axis] += random.uniform(-amount, amount);
    });
}

RawInput displaced(const RawInput& mesh, std::size_t count) {
    const scanmill::BoundingBox box = box_of(mesh);
    const double diagonal = box.diagonal();
    const Vec3 centre = (box.low + box.high) / 2, shift = 0.01 * diagonal * Vec3::UnitX();
    const Eigen::AngleAxisd turn(std::numbers::pi / 180, Vec3(1, 2, 3).normalized());
    return sampled(mesh, count, [&](Vec3& p, scanmill::Random& random) {
        for (int axis = 0; axis < 3; ++axis) p[axis] += 0.0002 * diagonal * random.normal();
        p = turn * (p - centre) + centre + shift;
    });
}

RawInput weighted(const RawInput& given) {
    scanmill::Array<Vec3> positions;
    for (const auto& p : given.points) positions.push_back(Vec3(p.data()));
    scanmill::Context context{scanmill::ContextOptions()};
    const scanmill::Array<double> weights = scanmill::spacing_weights(positions, 1, context);
    return {given.points, {}, {weights.begin(), weights.end()}};
}

RawInput oriented(RawInput mesh) {
    std::vector<Vec3> sums(mesh.points.size(), Vec3::Zero());
    for (const auto& triangle : mesh.triangles) {
        const auto [a, b, c] = triangle;
        const Vec3 twice_area = (corner(mesh, b) - corner(mesh, a)).cross(corner(mesh, c) - corner(mesh, a));
        for (const std::uint32_t vertex : triangle) sums[vertex] += twice_area;
    }
    for (const Vec3& sum : sums) mesh.normals.push_back(rounded(sum.normalized()));
    mesh.triangles.clear();
    return mesh;
}

RawInput soup(const RawInput& mesh) {
    RawInput raw;
    for (const auto& triangle : mesh.triangles) {
        const auto first = static_cast<std::uint32_t>(raw.points.size());
        for (const std::uint32_t vertex : triangle) raw.points.push_back(mesh.points.at(vertex));
        const bool reversed = raw.triangles.size() % 3 == 0;
        raw.triangles.push_back({first, first + (reversed ? 2 : 1), first + (reversed ? 1 : 2)});
    }
    return raw;
}

RawInput with_holes(RawInput mesh, std::size_t count) {
    std::vector<bool> near(mesh.points.size(), false);
    for (std::size_t hole = 0; hole < count; ++hole) near[mesh.points.size() * hole / count] = true;
    for (int ring = 0; ring < 4; ++ring) {
        std::vector<bool> wider = near;
        for (const auto& triangle : mesh.triangles)
            if (std::ranges::any_of(triangle, [&](std::uint32_t vertex) { return near[vertex]; }))
                for (const std::uint32_t vertex : triangle) wider[vertex] = true;
        near = std::move(wider);
    }
    std::erase_if(mesh.triangles, [&](const auto& triangle) {
        return std::ranges::all_of(triangle, [&](std::uint32_t vertex) { return near[vertex]; });
    });
    return mesh;
}

}  // namespace

int main(int argc, char** argv) try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 3 && words[0] == "scan")
        write_raw(words[2], scan(words[1]));
    else if (words.size() == 3 && words[0] == "torus")
        write_raw(words[2], torus(std::stoul(words[1])));
    else if (words.size() == 3 && words[0] == "random-torus")
        write_raw(words[2], random_torus(std::stoul(words[1])));
    else if (words.size() == 4 && words[0] == "around")
        write_raw(words[3], around(peers::read_raw(words[1]), std::stoul(words[2])));
    else if (words.size() == 4 && words[0] == "displaced")
        write_raw(words[3], displaced(peers::read_raw(words[1]), std::stoul(words[2])));
    else if (words.size() == 3 && words[0] == "weighted")
        write_raw(words[2], weighted(peers::read_raw(words[1])));
    else if (words.size() == 3 && words[0] == "oriented")
        write_raw(words[2], oriented(peers::read_raw(words[1])));
    else if (words.size() == 3 && words[0] == "soup")
        write_raw(words[2], soup(peers::read_raw(words[1])));
    else if (words.size() == 4 && words[0] == "holes")
        write_raw(words[3], with_holes(peers::read_raw(words[1]), std::stoul(words[2])));
    else
        throw std::runtime_error(
            "usage: peer_inputs scan FILE OUT | torus COUNT OUT | random-torus COUNT OUT | around RAW COUNT OUT | "
            "displaced RAW COUNT OUT | weighted RAW OUT | oriented RAW OUT | soup RAW OUT | holes RAW COUNT OUT");
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
