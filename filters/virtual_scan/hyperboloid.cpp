// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_scan/hyperboloid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scanmill::scan {

namespace {

/// The roots of a x² + b x + c, ascending, as many as there are; without the cancellation of the school's formula.
std::vector<double> roots_of(double a, double b, double c) {
    if (a == 0) return b == 0 ? std::vector<double>{} : std::vector<double>{-c / b};
    const double square = b * b - 4 * a * c;
    if (square < 0) return {};
    const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
    if (q == 0) return {0};
    return {std::min(q / a, c / q), std::max(q / a, c / q)};
}

}  // namespace

BoundingBox bounds_of(const Hyperboloid& surface) {
    const double r = surface.radius;
    return {{-r, -r, 0}, {r, r, std::numbers::sqrt2 * surface.height}};
}

std::optional<Hit> first_hit(const Ray& ray, const Hyperboloid& surface) {
    const Vec3& d = ray.direction;
    const Vec3 o = ray.at(-ray.start.dot(d));  // the point nearest the origin: depths are small from there
    const double r = surface.radius, slope = surface.height / r, square = slope * slope;
    const double a = d.z() * d.z() - square * (d.x() * d.x() - d.y() * d.y());
    const double b = 2 * (o.z() * d.z() - square * (o.x() * d.x() - o.y() * d.y()));
    const double c = o.z() * o.z() - square * (o.x() * o.x() - o.y() * o.y() + r * r);
    for (const double depth : roots_of(a, b, c)) {
        const Vec3 p = o + depth * d;
        if (p.z() < 0 || p.x() * p.x() + p.y() * p.y() > r * r) continue;
        const Vec3 normal = Vec3(-square * p.x(), square * p.y(), p.z()).normalized();
        return Hit{p, normal.dot(d) > 0 ? Vec3(-normal) : normal};
    }
    return {};
}

}  // namespace scanmill::scan
