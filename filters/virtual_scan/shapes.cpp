// SPDX-License-Identifier: GPL-3.0-or-later
/// Scenes of shapes that are given by formulas. Every ray is intersected with the surface itself, not with a mesh of
/// it.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "virtual_scan/scene.hpp"
#include "virtual_scan/sign_changes.hpp"

namespace scanmill::scan {

namespace {

using Shape = VirtualScanParams::Shape;

struct Ray {
    Vec3 start, direction;  // a whole line: it may enter shapes before `start`
    Vec3 at(double depth) const { return start + depth * direction; }
};

using FirstHit = std::function<std::optional<Hit>(const Ray&)>;

// Boxes.

struct Passage {
    double enter, leave;  ///< depths; enter ≤ leave
    Vec3 normal;          ///< outwards, of the face through which the ray enters
};

/// Intersects a ray with a box by slabs (Kay, Kajiya 1986). Among faces at the same depth, the lowest axis counts. A
/// ray within a face passes through.
std::optional<Passage> passage_through(const Ray& ray, const BoundingBox& box) {
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    Vec3 normal = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
        const double speed = ray.direction[axis];
        if (speed == 0) {
            if (ray.start[axis] < box.low[axis] || ray.start[axis] > box.high[axis]) return {};
            continue;
        }
        const double near = ((speed > 0 ? box.low : box.high)[axis] - ray.start[axis]) / speed;
        const double far = ((speed > 0 ? box.high : box.low)[axis] - ray.start[axis]) / speed;
        if (near > enter) {
            enter = near;
            normal = Vec3::Zero();
            normal[axis] = speed > 0 ? -1 : 1;
        }
        leave = std::min(leave, far);
    }
    if (!(enter <= leave)) return {};
    return Passage{enter, leave, normal};
}

/// The point at which the ray enters the box: exactly on the plane of the face, whatever the rounding along the ray.
Hit entry_of(const Ray& ray, const BoundingBox& box, const Passage& passage) {
    const auto outwards = passage.normal.array();
    const Vec3 within = ray.at(passage.enter);
    return {(outwards > 0).select(box.high, (outwards < 0).select(box.low, within)), passage.normal};
}

/// Intersects a ray with the union of boxes. A ray from outside enters it where it first enters one of them.
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

// Sphere, torus and cylinder.

std::optional<Hit> meet_sphere(const Ray& ray, double radius) {
    const double middle = -ray.start.dot(ray.direction);
    const Vec3 nearest = ray.at(middle);  // to the centre
    const double square = radius * radius - nearest.squaredNorm();
    if (square < 0) return {};
    const Vec3 position = nearest - std::sqrt(square) * ray.direction;
    return Hit{position, position / radius};
}

/// Solves (|p|² + R² − r²)² = 4 R² (x² + y²) along the ray, a quartic in the depth from the point nearest the centre.
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

// A block with holes drilled through it.

struct HoledBlock {
    struct Hole {
        double x, y, radius;
    };
    BoundingBox box;
    std::array<Hole, 5> holes;  ///< along z; they neither meet each other nor the block's sides
};

/// The distance of the centres of the small holes from the middle, as a share of the block's sides.
constexpr double eccentricity = 0.35;

void require_apart(const Vec3& size, double large_radius, double small_radius) {
    const double side = std::min(size.x(), size.y());
    if (!(2 * large_radius < side))
        throw Error("the large hole of radius {} u does not fit into the block of {} x {} u", large_radius, size.x(),
                    size.y())
            .hint(fmt::format("its radius must be below {} u", side / 2));
    const double to_side = (0.5 - eccentricity) * side;
    const double between = eccentricity * std::sqrt(size.x() * size.x() + size.y() * size.y()) - large_radius;
    const double room = std::min(to_side, between);
    if (!(small_radius < room))
        throw Error("the small holes of radius {} u touch the large one or the sides of the block of {} x {} u",
                    small_radius, size.x(), size.y())
            .hint(fmt::format("with a large hole of radius {} u, the small radius must be below {} u", large_radius,
                              room));
}

/// Returns the hole that contains the point, its wall excluded; nullptr if there is none.
const HoledBlock::Hole* hole_round(const HoledBlock& block, const Vec3& point) {
    for (const HoledBlock::Hole& hole : block.holes) {
        const double x = point.x() - hole.x, y = point.y() - hole.y;
        if (x * x + y * y < hole.radius * hole.radius) return &hole;
    }
    return nullptr;
}

/// The depth at which a ray inside the hole leaves it through its wall. Pre: the ray is not along z.
double way_out(const Ray& ray, const HoledBlock::Hole& hole) {
    const double dx = ray.direction.x(), dy = ray.direction.y();
    const double x = ray.start.x() - hole.x, y = ray.start.y() - hole.y;
    const double speed = dx * dx + dy * dy;
    const double middle = -(x * dx + y * dy) / speed;
    const double nearest_x = x + middle * dx, nearest_y = y + middle * dy;
    const double square = hole.radius * hole.radius - nearest_x * nearest_x - nearest_y * nearest_y;
    return middle + std::sqrt(std::max(square, 0.0) / speed);
}

/// A block around the origin, with the large hole in the middle and the small ones at (± 0.35 x, ± 0.35 y). Throws
/// Error if holes would touch each other or the block's sides. Pre: sizes above 0.
HoledBlock holed_block(const Vec3& size, double large_radius, double small_radius) {
    require_apart(size, large_radius, small_radius);
    const double x = eccentricity * size.x(), y = eccentricity * size.y(), r = small_radius;
    return {{-size / 2, size / 2}, {{{0, 0, large_radius}, {-x, -y, r}, {x, -y, r}, {-x, y, r}, {x, y, r}}}};
}

/// Intersects a ray with the block. The walls of the holes belong to the surface.
std::optional<Hit> meet_holed_block(const Ray& ray, const HoledBlock& block) {
    const auto passage = passage_through(ray, block.box);
    if (!passage) return {};
    const Hit entry = entry_of(ray, block.box, *passage);
    const HoledBlock::Hole* hole = hole_round(block, entry.position);
    if (!hole) return entry;
    if (ray.direction.x() == 0 && ray.direction.y() == 0) return {};
    // Holes do not meet. So the solid or the outside lies behind the wall of this one.
    const double depth = way_out(ray, *hole);
    if (!(depth < passage->leave)) return {};
    Vec3 position = ray.at(depth);
    const Vec3 outwards = Vec3(position.x() - hole->x, position.y() - hole->y, 0).normalized();
    position.x() = hole->x + hole->radius * outwards.x();
    position.y() = hole->y + hole->radius * outwards.y();
    return Hit{position, -outwards};
}

// The upper half of a hyperboloid of one sheet above a disc: an open saddle whose curvatures are known. Source: Wang
// 2006, section 4.4.1, whose h is height · radius here.

/// z = height / radius · √(x² − y² + radius²) where x² + y² ≤ radius².
struct Hyperboloid {
    double radius, height;
};

/// The real roots of a x² + b x + c, ascending; without the cancellation of the textbook formula.
std::vector<double> roots_of(double a, double b, double c) {
    if (a == 0) return b == 0 ? std::vector<double>{} : std::vector<double>{-c / b};
    const double square = b * b - 4 * a * c;
    if (square < 0) return {};
    const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
    if (q == 0) return {0};
    return {std::min(q / a, c / q), std::max(q / a, c / q)};
}

BoundingBox bounds_of(const Hyperboloid& surface) {
    const double r = surface.radius;
    return {{-r, -r, 0}, {r, r, std::numbers::sqrt2 * surface.height}};
}

/// Intersects a ray with the surface. Hits from either side count; the normal is turned against the ray.
std::optional<Hit> meet_hyperboloid(const Ray& ray, const Hyperboloid& surface) {
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

// Bodies of revolution about the z axis with one circular edge, of known angle, at z = 0. Source: Wang 2006,
// section 5.3.

/// A cone over the disc of `radius` around 0, with its apex at height `height` · `up`, where `up` is 1 or -1.
struct Cone {
    double radius, height, up;
};

/// Tolerance at the circular edge: despite rounding, a ray that passes there must not pass between two surfaces.
constexpr double edge_rounding = 1e-12;

/// The point where the ray enters the cone through its slope.
std::optional<Hit> meet_cone(const Ray& ray, const Cone& cone) {
    const Vec3& d = ray.direction;
    const Vec3 o = ray.at(-ray.start.dot(d));
    const double slope = cone.up / cone.height, square = cone.radius * cone.radius;
    // x² + y² = radius² w² with w = 1 - slope z, at w = along + depth * change.
    const double along = 1 - slope * o.z(), change = -slope * d.z();
    const double a = d.x() * d.x() + d.y() * d.y() - square * change * change;
    const double b = 2 * (o.x() * d.x() + o.y() * d.y() - square * along * change);
    const double c = o.x() * o.x() + o.y() * o.y() - square * along * along;
    for (const double depth : roots_of(a, b, c)) {
        const Vec3 p = o + depth * d;
        const double w = 1 - slope * p.z();
        if (!(w >= -edge_rounding && w <= 1 + edge_rounding)) continue;
        const Vec3 gradient(p.x(), p.y(), square * w * slope);
        const Vec3 normal = gradient == Vec3::Zero() ? Vec3(0, 0, cone.up) : Vec3(gradient.normalized());
        if (normal.dot(d) < 0) return Hit{p, normal};
    }
    return {};
}

std::optional<Hit> earlier(const Ray& ray, const std::optional<Hit>& a, const std::optional<Hit>& b) {
    if (!a || !b) return a ? a : b;
    return (b->position - a->position).dot(ray.direction) < 0 ? b : a;
}

/// Intersects a ray with two equal cones with a common base.
std::optional<Hit> meet_bicone(const Ray& ray, double radius, double height) {
    return earlier(ray, meet_cone(ray, {radius, height, 1}), meet_cone(ray, {radius, height, -1}));
}

/// Intersects a ray with a cone above the lower half of a sphere.
std::optional<Hit> meet_cone_on_hemisphere(const Ray& ray, double radius, double height) {
    std::optional<Hit> below = meet_sphere(ray, radius);
    if (below && below->position.z() > edge_rounding * radius) below.reset();
    return earlier(ray, meet_cone(ray, {radius, height, 1}), below);
}

// Shapes by name.

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
        case Shape::bicone: return {"bicone", {"radius", "height"}, {1, 1}};
        case Shape::cone_on_hemisphere: return {"cone-on-hemisphere", {"radius", "height"}, {1, 0.5}};
    }
    return {"none", {}, {}};
}

double dimension_of(const Length& length, const std::string& name) {
    if (length.in() != Length::In::scan_unit)
        throw Error("{} is {}; a shape has no unit, diagonal or spacing before it has its size", name, length.text())
            .hint(fmt::format("give it in the scan's own unit, as {} u", number_text(length.amount())));
    const double dimension = length.value();
    if (!(dimension > 0) || !std::isfinite(dimension))
        throw Error("{} is {} u; it must be above 0", name, dimension).hint("give it a size, for example 1 u");
    if (!(dimension >= least_size && dimension <= largest_size))
        throw Error("{} is {:.3g} u; {:.0e} to {:.0e} u is supported", name, dimension, least_size, largest_size)
            .hint("give all sizes in another unit, as numbers nearer 1");
    return dimension;
}

std::vector<double> dimensions_of(const Kind& kind, std::span<const Length> size) {
    if (size.empty()) return kind.defaults;
    if (size.size() != kind.dimensions.size())
        throw Error("a {} has {} ({}); size has {}", kind.name,
                    count_text(kind.dimensions.size(), "dimension", "dimensions"), fmt::join(kind.dimensions, ", "),
                    size.size())
            .hint(fmt::format("write `size: [{} u]`, or omit size", fmt::join(kind.defaults, " u, ")));
    std::vector<double> dimensions;
    for (std::size_t i = 0; i < size.size(); ++i)
        dimensions.push_back(dimension_of(size[i], fmt::format("the {} of the {}", kind.dimensions[i], kind.name)));
    return dimensions;
}

/// Returns a function that finds the first hit of a ray on the shape, and the bounds of the shape.
std::pair<FirstHit, BoundingBox> surface_of(Shape shape, const std::vector<double>& size) {
    switch (shape) {
        case Shape::none: break;
        case Shape::sphere:
            return {[r = size[0]](const Ray& ray) { return meet_sphere(ray, r); },
                    {Vec3::Constant(-size[0]), Vec3::Constant(size[0])}};
        case Shape::torus: {
            if (!(size[1] < size[0]))
                throw Error("the torus's tube of radius {} u leaves no hole in a ring of radius {} u", size[1], size[0])
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
            return {[block](const Ray& ray) { return meet_holed_block(ray, block); }, block.box};
        }
        case Shape::hyperboloid: {
            const Hyperboloid surface{size[0], size[1]};
            return {[surface](const Ray& ray) { return meet_hyperboloid(ray, surface); }, bounds_of(surface)};
        }
        case Shape::bicone: {
            const Vec3 corner(size[0], size[0], size[1]);
            return {[r = size[0], h = size[1]](const Ray& ray) { return meet_bicone(ray, r, h); }, {-corner, corner}};
        }
        case Shape::cone_on_hemisphere:
            return {[r = size[0], h = size[1]](const Ray& ray) { return meet_cone_on_hemisphere(ray, r, h); },
                    {Vec3::Constant(-size[0]), Vec3(size[0], size[0], size[1])}};
    }
    return {};
}

}  // namespace

Scene scene_of(Shape shape, std::span<const Length> size) {
    Scene scene;
    const Kind kind = kind_of(shape);
    auto [first_hit, box] = surface_of(shape, dimensions_of(kind, size));
    if (const double longest = (box.high - box.low).maxCoeff(); longest > largest_size)
        throw Error("the longest side of the {} is {:.3g} u; at most {:.0e} u is supported", kind.name, longest,
                    largest_size)
            .hint("give all sizes in another unit, as numbers nearer 1");
    scene.box = box;
    for (int corner = 0; corner < 8; ++corner)
        scene.hull.push_back({(corner & 1 ? box.high : box.low).x(), (corner & 2 ? box.high : box.low).y(),
                              (corner & 4 ? box.high : box.low).z()});
    scene.scale.diagonal = [diagonal = box.diagonal()] { return diagonal; };
    scene.hits = [first_hit = std::move(first_hit)](const View& view) {
        std::vector<Hit> hits;
        for (std::size_t row = 0; row < view.height; ++row)
            for (std::size_t column = 0; column < view.width; ++column)
                if (const auto hit = first_hit({view.point(view.across(column), view.along(row), 0), view.forward}))
                    hits.push_back(*hit);
        return hits;
    };
    return scene;
}

}  // namespace scanmill::scan
