// SPDX-License-Identifier: GPL-3.0-or-later
/// Colours of virtual scans with noise: sharp at edges between colours, and less noisy than one view elsewhere.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "filters/transfer/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::test {
namespace {

using Colour = std::array<double, 3>;
constexpr Colour first{190, 60, 50}, second{60, 110, 180};
constexpr double noise = 10;  // of a view, in codes

/// Cubes of this edge have one of two colours in turn.
struct Checkers {
    double edge, offset;

    bool is_first(const Vec3& p) const {
        int sum = 0;
        for (int axis = 0; axis < 3; ++axis) sum += static_cast<int>(std::floor((p[axis] - offset) / edge));
        return sum % 2 == 0;
    }
    /// About the distance along the surface to the nearest edge between colours. `normal`: of the surface, unit length.
    double distance_to_edge(const Vec3& p, const Vec3& normal) const {
        double least = edge;
        for (int axis = 0; axis < 3; ++axis) {
            const double across = std::sqrt(std::max(0.0, 1 - normal[axis] * normal[axis]));
            const double cells = (p[axis] - offset) / edge;
            least = std::min(least, std::abs(cells - std::round(cells)) * edge / std::max(across, 1e-9));
        }
        return least;
    }
};

double difference(const Colour& a, const Colour& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// The point of the sphere of radius 1, or of the cube of edge 1, below a point with noise.
Vec3 on_surface(VirtualScanParams::Shape shape, const Vec3& p) {
    return shape == VirtualScanParams::Shape::sphere ? Vec3(p.normalized()) : Vec3(p / (2 * p.cwiseAbs().maxCoeff()));
}

struct Errors {
    std::size_t near = 0, wrong = 0, unknown = 0, elsewhere = 0;
    double sum = 0;  // of absolute errors of all channels elsewhere
    double wrong_share() const { return static_cast<double>(wrong) / static_cast<double>(near); }
    double mean() const { return sum / static_cast<double>(3 * elsewhere); }
};

/// Scans the shape with `views` views, colours the points with noise, and transfers the colours to the vertices.
/// A vertex is near an edge if it is within two spacings of the mesh, which is coarser than a view as after thinning.
Errors errors_of(VirtualScanParams::Shape shape, double views, const TriangleMesh& mesh, const Checkers& checkers) {
    constexpr double resolution = 0.02;
    VirtualScanParams params;
    params.shape = shape;
    params.views = {views};
    params.resolution = Length(resolution);
    params.noise = Length(resolution / 10);
    Context context;
    PointCloud cloud = virtual_scan(nullptr, params, context).points;
    Random random(7);
    const auto gauss = [&] {
        return std::sqrt(-2 * std::log(1 - random.uniform(0, 1))) *
               std::cos(2 * std::numbers::pi * random.uniform(0, 1));
    };
    std::vector<u8> colours;
    for (const Vec3& p : cloud.positions) {
        const Colour colour = checkers.is_first(0.99 * on_surface(shape, p)) ? first : second;
        for (const double channel : colour)
            colours.push_back(static_cast<u8>(std::clamp(channel + noise * gauss(), 0.0, 255.0)));
    }
    cloud = with(cloud, column_of("colour", 3, colours));
    const auto result = carried(cloud, mesh, {});
    const auto found = numbers_in(result.result, "colour");
    const Array<Vec3> normals = vertex_area_vectors(mesh);
    const double spacing = edge_spacing(mesh);
    Errors errors;
    errors.unknown = result.unknown;
    const auto marks = numbers_in(result.result, "transferred");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (marks[i] == 0) continue;
        const Vec3 p = 0.99 * mesh.positions[i];
        const bool is_first = checkers.is_first(p);
        const Colour &right = is_first ? first : second, &other = is_first ? second : first;
        const Colour colour{found[3 * i], found[3 * i + 1], found[3 * i + 2]};
        if (checkers.distance_to_edge(p, normals[i].normalized()) < 2 * spacing) {
            ++errors.near;
            errors.wrong += difference(colour, right) > difference(colour, other);
        } else {
            ++errors.elsewhere;
            for (int channel = 0; channel < 3; ++channel) errors.sum += std::abs(colour[channel] - right[channel]);
        }
    }
    return errors;
}

void expect_sharp(const Errors& errors, std::size_t vertices) {
    ASSERT_GT(errors.near, 500u);
    ASSERT_GT(errors.elsewhere, 500u);
    EXPECT_LT(errors.unknown, 0.01 * static_cast<double>(vertices));
    EXPECT_LE(errors.wrong_share(), 0.02) << errors.wrong << " of " << errors.near;
    // The mean absolute error of a normal distribution is 0.8 of its standard deviation.
    EXPECT_LT(errors.mean(), 0.5 * 0.8 * noise);
}

TEST(TransferEdges, CheckeredBox_FromSeveralViews) {
    TriangleMesh mesh = cube_of_squares(23);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Random random(5);
    for (Vec3& p : positions) {
        p = p / 23 - Vec3(0.5, 0.5, 0.5);
        // Moved within the face, so that no row of vertices has one distance from an edge between colours.
        for (double& coordinate : p)
            if (std::abs(coordinate) < 0.49) coordinate += random.uniform(-0.4, 0.4) / 23;
    }
    mesh.positions = std::move(positions);
    for (const double views : {6.0, 12.0})
        expect_sharp(errors_of(VirtualScanParams::Shape::box, views, mesh, {0.5, 0.13}), mesh.positions.size());
}

TEST(TransferEdges, CheckeredSphere_FromSeveralViews) {
    const TriangleMesh mesh = geodesic_sphere(1, 25);
    for (const double views : {6.0, 12.0})
        expect_sharp(errors_of(VirtualScanParams::Shape::sphere, views, mesh, {0.7, 0.23}), mesh.positions.size());
}

}  // namespace
}  // namespace scanmill::test
