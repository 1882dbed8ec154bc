// SPDX-License-Identifier: GPL-3.0-or-later
/// Shapes given by formulas as scenes: every ray is intersected with the surface itself, not with a mesh of it.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "virtual_scan/first_root.hpp"
#include "virtual_scan/holed_block.hpp"
#include "virtual_scan/hyperboloid.hpp"
#include "virtual_scan/ray.hpp"
#include "virtual_scan/scene.hpp"

namespace scanmill::scan {

namespace {

using Shape = VirtualScanParams::Shape;

using FirstHit = std::function<std::optional<Hit>(const Ray&)>;

std::optional<Hit> meet_sphere(const Ray& ray, double radius) {
    const double middle = -ray.start.dot(ray.direction);
    const Vec3 nearest = ray.at(middle);  // to the centre
    const double square = radius * radius - nearest.squaredNorm();
    if (square < 0) return {};
    const Vec3 position = nearest - std::sqrt(square) * ray.direction;
    return Hit{position, position / radius};
}

/// (|p|² + R² − r²)² = 4 R² (x² + y²) along the ray: a quartic in the depth, counted from the point nearest the centre.
std::optional<Hit> meet_torus(const Ray& ray, double major, double minor) {
    const Vec3& d = ray.direction;
    const Vec3 o = ray.at(-ray.start.dot(d));
    const double reach = major + minor;
    const double square = reach * reach - o.squaredNorm();
    if (square < 0) return {};
    const double constant = o.squaredNorm() + major * major - minor * minor, four = 4 * major * major;
    const double linear = 2 * o.dot(d);
    const std::array<double, 5> quartic{
        constant * constant - four * (o.x() * o.x() + o.y() * o.y()),
        2 * constant * linear - 2 * four * (o.x() * d.x() + o.y() * d.y()),
        linear * linear + 2 * constant - four * (d.x() * d.x() + d.y() * d.y()),
        2 * linear,
        1,
    };
    const double half = std::sqrt(square) + 1e-6 * reach;
    const std::vector<double> roots = sign_changes(quartic, -half, half, 1e-9 * reach);
    if (roots.empty()) return {};
    // Newton steps along the ray on the distance to the tube, which is better conditioned than the quartic.
    Vec3 position = o + roots.front() * d;
    const auto ring_of = [](const Vec3& p) { return std::sqrt(p.x() * p.x() + p.y() * p.y()); };
    const auto normal_at = [&](const Vec3& p) {
        const double flat = 1 - major / ring_of(p);
        return Vec3(p.x() * flat, p.y() * flat, p.z()).normalized();
    };
    for (int step = 0; step < 3; ++step) {
        const double off = ring_of(position) - major;
        const double distance = std::sqrt(off * off + position.z() * position.z()) - minor;
        const double slope = normal_at(position).dot(d);
        if (std::abs(slope) > 1e-3) position -= distance / slope * d;
    }
    return Hit{position, normal_at(position)};
}

/// The union of boxes: a ray from outside enters it where it first enters one of them.
std::optional<Hit> meet_boxes(const Ray& ray, std::span<const BoundingBox> boxes) {
    double first = std::numeric_limits<double>::infinity();
    std::optional<Hit> hit;
    for (const BoundingBox& box : boxes)
        if (const auto passage = passage_through(ray, box); passage && passage->enter < first) {
            first = passage->enter;
            hit = entry_of(ray, box, *passage);
        }
    return hit;
}

std::optional<Hit> meet_cylinder(const Ray& ray, double radius, double half_height) {
    const Vec3& d = ray.direction;
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    bool through_cap = false;
    const double speed = d.x() * d.x() + d.y() * d.y();
    const double middle = speed > 0 ? -(ray.start.x() * d.x() + ray.start.y() * d.y()) / speed : 0;
    const Vec3 nearest = ray.at(middle);  // to the axis
    const double square = radius * radius - nearest.x() * nearest.x() - nearest.y() * nearest.y();
    if (square < 0) return {};
    if (speed > 0) {
        enter = middle - std::sqrt(square / speed);
        leave = middle + std::sqrt(square / speed);
    }
    if (d.z() == 0) {
        if (std::abs(ray.start.z()) > half_height) return {};
    } else {
        const double top = (half_height - ray.start.z()) / d.z(), bottom = (-half_height - ray.start.z()) / d.z();
        through_cap = std::min(top, bottom) > enter;
        enter = std::max(enter, std::min(top, bottom));
        leave = std::min(leave, std::max(top, bottom));
    }
    if (!(enter <= leave)) return {};
    Vec3 position = ray.at(enter);
    if (!through_cap) return Hit{position, Vec3(position.x(), position.y(), 0) / radius};
    position.z() = std::copysign(half_height, -d.z());
    return Hit{position, Vec3(0, 0, std::copysign(1.0, -d.z()))};
}

struct Kind {
    const char* name;
    std::vector<const char*> dimensions;
    std::vector<double> defaults;
};
Kind kind_of(Shape shape) {
    switch (shape) {
        case Shape::none: break;
        case Shape::sphere: return {"sphere", {"radius"}, {1}};
        case Shape::torus: return {"torus", {"radius", "tube's radius"}, {1, 0.4}};
        case Shape::box: return {"box", {"x", "y", "z"}, {1, 1, 1}};
        case Shape::cylinder: return {"cylinder", {"radius", "height"}, {0.5, 1}};
        case Shape::l_block: return {"l-block", {"size", "thickness"}, {1, 1}};
        case Shape::holed_block:
            return {"block-with-holes",
                    {"x", "y", "z", "large hole's radius", "small holes' radius"},
                    {0.88, 0.95, 0.41, 0.21, 0.05}};
        case Shape::hyperboloid: return {"hyperboloid", {"radius", "height"}, {1, 0.75}};
    }
    return {"none", {}, {}};
}

double dimension_of(const Length& length, const std::string& name) {
    if (length.in() != Length::In::scan_unit)
        throw Error("{} is {}; a shape has no unit, diagonal or spacing to measure by before it has its size", name,
                    length.text())
            .hint(fmt::format("give it in the scan's own unit, as {} u", number_text(length.amount())));
    const double dimension = length.value();
    if (!(dimension > 0) || !std::isfinite(dimension))
        throw Error("{} is {} u; it must be above 0", name, dimension).hint("give it a size, as 1 u");
    if (!(dimension >= least_size && dimension <= largest_size))
        throw Error("{} is {:.3g} u; between {} and {} u is needed for products of lengths to be numbers", name,
                    dimension, least_size, largest_size)
            .hint("give all sizes in another unit, as numbers nearer 1");
    return dimension;
}

std::vector<double> dimensions_of(const Kind& kind, std::span<const Length> size) {
    if (size.empty()) return kind.defaults;
    if (size.size() != kind.dimensions.size())
        throw Error("a {} has {} ({}); size has {}", kind.name,
                    counted(kind.dimensions.size(), "dimension", "dimensions"), fmt::join(kind.dimensions, ", "),
                    size.size())
            .hint(fmt::format("say `size: [{} u]`, or leave size out", fmt::join(kind.defaults, " u, ")));
    std::vector<double> dimensions;
    for (std::size_t i = 0; i < size.size(); ++i)
        dimensions.push_back(dimension_of(size[i], fmt::format("the {} of the {}", kind.dimensions[i], kind.name)));
    return dimensions;
}

/// The shape's first hit and its bounds.
std::pair<FirstHit, BoundingBox> surface_of(Shape shape, const std::vector<double>& size) {
    switch (shape) {
        case Shape::none: break;
        case Shape::sphere:
            return {[r = size[0]](const Ray& ray) { return meet_sphere(ray, r); },
                    {Vec3::Constant(-size[0]), Vec3::Constant(size[0])}};
        case Shape::torus: {
            if (!(size[1] < size[0]))
                throw Error("the torus's tube of radius {} u does not leave a hole at radius {} u", size[1], size[0])
                    .hint("the second size must be below the first");
            const Vec3 corner(size[0] + size[1], size[0] + size[1], size[1]);
            return {[R = size[0], r = size[1]](const Ray& ray) { return meet_torus(ray, R, r); }, {-corner, corner}};
        }
        case Shape::box: {
            const Vec3 corner = Vec3(size[0], size[1], size[2]) / 2;
            const BoundingBox box{-corner, corner};
            return {[box](const Ray& ray) { return meet_boxes(ray, std::span(&box, 1)); }, box};
        }
        case Shape::cylinder: {
            const Vec3 corner(size[0], size[0], size[1] / 2);
            return {[r = size[0], h = size[1] / 2](const Ray& ray) { return meet_cylinder(ray, r, h); },
                    {-corner, corner}};
        }
        case Shape::l_block: {
            const double s = size[0], t = size[1];
            const std::array<BoundingBox, 2> arms{
                {{Vec3::Zero(), Vec3(2 * s, s, t)}, {Vec3::Zero(), Vec3(s, 2 * s, t)}}};
            return {[arms](const Ray& ray) { return meet_boxes(ray, arms); }, {Vec3::Zero(), Vec3(2 * s, 2 * s, t)}};
        }
        case Shape::holed_block: {
            const HoledBlock block = holed_block({size[0], size[1], size[2]}, size[3], size[4]);
            return {[block](const Ray& ray) { return first_hit(ray, block); }, block.box};
        }
        case Shape::hyperboloid: {
            const Hyperboloid surface{size[0], size[1]};
            return {[surface](const Ray& ray) { return first_hit(ray, surface); }, bounds_of(surface)};
        }
    }
    return {};
}

}  // namespace

Scene scene_of(Shape shape, std::span<const Length> size) {
    Scene scene;
    auto [first_hit, box] = surface_of(shape, dimensions_of(kind_of(shape), size));
    scene.box = box;
    for (int corner = 0; corner < 8; ++corner)
        scene.hull.push_back({(corner & 1 ? box.high : box.low).x(), (corner & 2 ? box.high : box.low).y(),
                              (corner & 4 ? box.high : box.low).z()});
    scene.scale.diagonal = [diagonal = box.diagonal()] { return diagonal; };
    scene.hits = [meet = std::move(first_hit)](const View& view) {
        std::vector<Hit> hits;
        for (std::size_t row = 0; row < view.height; ++row)
            for (std::size_t column = 0; column < view.width; ++column)
                if (const auto hit = meet({view.point(view.across(column), view.along(row), 0), view.forward}))
                    hits.push_back(*hit);
        return hits;
    };
    return scene;
}

}  // namespace scanmill::scan
