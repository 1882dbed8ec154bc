// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_scan/view.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill::scan {

namespace {

std::vector<Vec3> fibonacci_sphere(std::size_t count) {
    // Cosine and sine of the golden angle π (3 − √5). Directions are turned by products instead of angles, because sin
    // and cos differ between processors.
    constexpr double cosine = -0.73736887807831989, sine = 0.67549029426152362;
    std::vector<Vec3> directions;
    double x = 1, y = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1 - static_cast<double>(2 * i + 1) / static_cast<double>(count);
        const double ring = std::sqrt((1 - z) * (1 + z));
        directions.push_back(Vec3(ring * x, ring * y, z).normalized());
        const double turned = cosine * x - sine * y;
        y = sine * x + cosine * y;
        x = turned;
        const double length = std::sqrt(x * x + y * y);
        x /= length;
        y /= length;
    }
    return directions;
}

struct Bounds {
    double left, bottom, right, top;
};
Bounds bounds_of(const View& view, std::span<const Vec3> points) {
    BoundingBox box;
    for (const Vec3& point : points) {
        const Vec3 projected = view.project(point);
        box.low = box.low.cwiseMin(projected);
        box.high = box.high.cwiseMax(projected);
    }
    const auto cell = [&](double position) { return std::floor(position / view.resolution); };
    return {cell(box.low.x()), cell(box.low.y()), cell(box.high.x()), cell(box.high.y())};
}

}  // namespace

std::vector<Vec3> view_directions(std::span<const double> views) {
    constexpr double most = 10000;
    if (views.size() == 1) {
        const double count = views.front();
        if (!(count >= 1 && count <= most) || count != std::floor(count))
            throw Error("views is {}; a single number must be a whole number from 1 to {}", count, most)
                .hint("three numbers per view give directions: [0, 0, 1] looks from above");
        return fibonacci_sphere(static_cast<std::size_t>(count));
    }
    if (views.empty() || views.size() % 3 != 0)
        throw Error("views has {} numbers; expected one (how many views) or three per view (its direction)",
                    views.size())
            .hint("12 looks from all around, [0, 0, 1] from above");
    std::vector<Vec3> directions;
    for (std::size_t i = 0; i < views.size(); i += 3) {
        const Vec3 direction(views[i], views[i + 1], views[i + 2]);
        const double largest = direction.cwiseAbs().maxCoeff();
        if (!direction.allFinite() || largest == 0)
            throw Error("view {} looks from ({} {} {}), which is not a direction", i / 3, views[i], views[i + 1],
                        views[i + 2])
                .hint("three finite numbers, not all 0: [0, 0, 1] looks from above");
        directions.push_back((direction / largest).normalized());
    }
    return directions;
}

View view_from(const Vec3& direction, const Vec3& centre, double resolution) {
    View view;
    view.forward = -direction;
    // `up` is as near to z as possible. Seen from above or below, it is as near to y as possible.
    const Vec3 vertical = std::abs(direction.z()) < 0.999 ? Vec3::UnitZ() : Vec3::UnitY();
    view.right = vertical.cross(direction).normalized();
    view.up = direction.cross(view.right).normalized();
    view.centre = centre;
    view.resolution = resolution;
    return view;
}

double rays_over(const View& view, std::span<const Vec3> points) {
    const Bounds bounds = bounds_of(view, points);
    return (bounds.right - bounds.left + 1) * (bounds.top - bounds.bottom + 1);
}

View covering(View view, std::span<const Vec3> points) {
    const Bounds bounds = bounds_of(view, points);
    view.left = bounds.left;
    view.bottom = bounds.bottom;
    view.width = static_cast<std::size_t>(bounds.right - bounds.left) + 1;
    view.height = static_cast<std::size_t>(bounds.top - bounds.bottom) + 1;
    return view;
}

}  // namespace scanmill::scan
