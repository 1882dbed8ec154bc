// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Views for tests of register.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "register/register_views.hpp"
#include "scanmill/base/random.hpp"
#include "support/mesh_operations.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::test {

struct View {
    std::string name;
    std::vector<Vec3> points;
    Vec3 to_scanner = Vec3::UnitZ();
    RigidMotion truth{};  ///< from the view's frame to the world
    std::optional<RigidMotion> start{};
};

inline RigidMotion random_motion(Random& random, double shift) {
    const Eigen::Quaterniond q(random.normal(), random.normal(), random.normal(), random.normal());
    return {q.normalized().toRotationMatrix(), shift * Vec3(random.normal(), random.normal(), random.normal())};
}

/// The views with their poses thrown away: each in a random frame of its own.
inline std::vector<View> in_random_frames(std::vector<View> views, u64 seed, double shift) {
    Random random(seed);
    for (View& view : views) {
        const RigidMotion motion = random_motion(random, shift);
        for (Vec3& p : view.points) p = motion.apply(p);
        view.to_scanner = motion.turned(view.to_scanner);
        view.truth = motion.inverse().then(view.truth);
    }
    return views;
}

inline RegisterViewsResult registered(const std::vector<View>& views, const RegisterViewsParams& params = {},
                                      unsigned threads = 2) {
    std::vector<ViewToRegister> input;
    for (const View& view : views) input.push_back({view.name, view.points, view.to_scanner, view.start});
    ExecutionOptions options;
    options.threads = threads;
    Execution execution(options);
    return register_views(input, params, execution);
}

/// The root mean square distance of each placed view's points from where they belong, after one motion of all of them
/// together; negative for refused views.
inline std::vector<double> errors_of(const RegisterViewsResult& result, const std::vector<View>& views) {
    std::vector<Vec3> from, to;
    for (std::size_t i = 0; i < views.size(); ++i)
        if (result.views[i].pose)
            for (std::size_t k = 0; k < views[i].points.size(); k += 50) {
                from.push_back(result.views[i].pose->apply(views[i].points[k]));
                to.push_back(views[i].truth.apply(views[i].points[k]));
            }
    std::vector<double> errors(views.size(), -1);
    if (from.empty()) return errors;
    const RigidMotion all = fitted_motion(from, to);
    std::size_t next = 0;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (!result.views[i].pose) continue;
        double squares = 0;
        std::size_t count = 0;
        for (std::size_t k = 0; k < views[i].points.size(); k += 50, ++next, ++count)
            squares += (all.apply(from[next]) - to[next]).squaredNorm();
        errors[i] = std::sqrt(squares / static_cast<double>(count));
    }
    return errors;
}

/// A view from above of the height field over a rectangle of unit squares.
inline View height_view(std::string name, double from_x, double to_x, double from_y, double to_y,
                        const std::function<double(double, double)>& height, double noise = 0, u64 seed = 1) {
    Random random(seed);
    View view;
    view.name = std::move(name);
    for (double x = from_x; x < to_x; ++x)
        for (double y = from_y; y < to_y; ++y) view.points.emplace_back(x, y, height(x, y) + noise * random.normal());
    return view;
}

/// A closed lump without symmetry, about 100 long. Another `kind` is another object.
inline TriangleMesh lump(double kind = 0) {
    constexpr u32 around = 120, along = 60;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 j = 0; j <= along; ++j)
        for (u32 i = 0; i < around; ++i) {
            const double turn = 2 * std::numbers::pi * i / around, tilt = std::numbers::pi * (j + 0.5) / (along + 1);
            const Vec3 d(std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt));
            const double radius = 40 + 9 * std::sin(3 * d.x() + 2 * d.y() + kind) +
                                  7 * std::cos(5 * d.z() - 2 * d.x()) + 5 * std::sin(6 * d.y() + d.z() + 1 + 2 * kind) +
                                  3 * std::sin(9 * d.x() * d.y() - kind);
            positions.push_back(Vec3(1.2, 1, 0.8).cwiseProduct(radius * d));
            if (j == 0) continue;
            const u32 a = (j - 1) * around + i, b = (j - 1) * around + (i + 1) % around;
            triangles.push_back({a, a + around, b});
            triangles.push_back({b, a + around, b + around});
        }
    return soup(std::move(positions), std::move(triangles));
}

/// Views of a mesh from `count` directions, rays 1 apart, noise of half a ray distance.
inline std::vector<View> views_of(const TriangleMesh& mesh, u32 count) {
    VirtualScanParams params;
    params.views = {static_cast<double>(count)};
    params.resolution = 1.0;
    params.noise = 0.5;
    params.max_angle = Angle::degrees(75);
    Context context;
    const VirtualScanResult scan = virtual_scan(&mesh, params, context);
    std::vector<View> views(count);
    const Column* number = scan.points.columns.find("view");
    for (std::size_t row = 0; row < scan.points.size(); ++row)
        views[static_cast<std::size_t>(number->number(row, 0))].points.push_back(scan.points.positions[row]);
    for (u32 i = 0; i < count; ++i) {
        views[i].name = "view " + std::to_string(i + 1);
        views[i].to_scanner = scan.directions[i];
    }
    return views;
}

}  // namespace scanmill::test
