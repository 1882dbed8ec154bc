// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_scan/holed_block.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"

namespace scanmill::scan {

namespace {

/// Of the small holes' centres, from the middle, as a share of the block's sides.
constexpr double eccentricity = 0.35;

void require_apart(const Vec3& size, double large_radius, double small_radius) {
    const double side = std::min(size.x(), size.y());
    if (!(2 * large_radius < side))
        throw Error("the large hole of radius {} u does not fit into the block of {} x {} u", large_radius, size.x(),
                    size.y())
            .hint(fmt::format("its radius must be below {} u", side / 2));
    const double to_side = (0.5 - eccentricity) * side;
    const double between = eccentricity * std::hypot(size.x(), size.y()) - large_radius;
    const double room = std::min(to_side, between);
    if (!(small_radius < room))
        throw Error("the small holes of radius {} u meet the large one or the sides of the block of {} x {} u",
                    small_radius, size.x(), size.y())
            .hint(fmt::format("beside a large hole of radius {} u theirs must be below {} u", large_radius, room));
}

/// The hole that the point is within, without its wall.
const HoledBlock::Hole* hole_round(const HoledBlock& block, const Vec3& point) {
    for (const HoledBlock::Hole& hole : block.holes) {
        const double x = point.x() - hole.x, y = point.y() - hole.y;
        if (x * x + y * y < hole.radius * hole.radius) return &hole;
    }
    return nullptr;
}

/// The depth at which a ray that is within the hole leaves it through its wall. Pre: the ray is not along z.
double way_out(const Ray& ray, const HoledBlock::Hole& hole) {
    const double dx = ray.direction.x(), dy = ray.direction.y();
    const double x = ray.start.x() - hole.x, y = ray.start.y() - hole.y;
    const double speed = dx * dx + dy * dy;
    const double middle = -(x * dx + y * dy) / speed;
    const double nearest_x = x + middle * dx, nearest_y = y + middle * dy;
    const double square = hole.radius * hole.radius - nearest_x * nearest_x - nearest_y * nearest_y;
    return middle + std::sqrt(std::max(square, 0.0) / speed);
}

}  // namespace

HoledBlock holed_block(const Vec3& size, double large_radius, double small_radius) {
    require_apart(size, large_radius, small_radius);
    const double x = eccentricity * size.x(), y = eccentricity * size.y(), r = small_radius;
    return {{-size / 2, size / 2}, {{{0, 0, large_radius}, {-x, -y, r}, {x, -y, r}, {-x, y, r}, {x, y, r}}}};
}

std::optional<Hit> first_hit(const Ray& ray, const HoledBlock& block) {
    const auto passage = passage_through(ray, block.box);
    if (!passage) return {};
    const Hit entry = entry_of(ray, block.box, *passage);
    const HoledBlock::Hole* hole = hole_round(block, entry.position);
    if (!hole) return entry;
    if (ray.direction.x() == 0 && ray.direction.y() == 0) return {};
    // Holes do not meet: what is behind this one's wall is solid, or outside.
    const double depth = way_out(ray, *hole);
    if (!(depth < passage->leave)) return {};
    Vec3 position = ray.at(depth);
    const Vec3 outwards = Vec3(position.x() - hole->x, position.y() - hole->y, 0).normalized();
    position.x() = hole->x + hole->radius * outwards.x();
    position.y() = hole->y + hole->radius * outwards.y();
    return Hit{position, -outwards};
}

}  // namespace scanmill::scan
