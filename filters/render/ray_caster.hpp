// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the triangles and discs that rays hit.
///
/// Embree's bounding-volume hierarchy proposes candidates; the arithmetic below, in doubles, decides. Embree computes
/// in floats, so boxes and rays are widened by more than the rounding error of these floats. A search over all items
/// would therefore give the same hits, bit for bit, whatever the number of threads and the instruction set.

#include <array>
#include <limits>
#include <memory>
#include <span>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct Ray {
    Vec3 origin;
    Vec3 direction;  ///< unit length
    double from = 0;  ///< hits nearer than this distance do not count; may be negative, for hits behind the origin
};

/// A disc in space. With a zero normal it faces every ray.
struct Disc {
    Vec3 centre, normal;
    double radius;
};

struct RayHit {
    static constexpr u32 none = ~u32(0);
    /// Row of the triangle, or the number of triangles plus the row of the disc.
    u32 item = none;
    double distance = std::numeric_limits<double>::infinity();
    /// For triangles, the weights of the three corners; they sum to 1.
    std::array<double, 3> weights{};

    bool found() const { return item != none; }
};

/// The hit of a ray and a triangle; no hit if the triangle has no area seen along the ray, or if the hit is nearer than
/// ray.from. Triangles with a common edge leave no gap: a ray through the edge hits at least one of them.
RayHit hit_triangle(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c);
/// The hit of a ray and a disc, rim included; no hit for a disc that is parallel to the ray.
RayHit hit_disc(const Ray& ray, const Disc& disc);

class RayCaster {
public:
    /// The positions, triangles and discs must outlive the object. `instruction_set` is one of Embree's names; it does
    /// not change the hits.
    /// Pre: finite coordinates. Throws Error without an item. Cost: O(n log n) time, about 100 bytes per item.
    RayCaster(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::span<const Disc> discs,
              unsigned threads, const char* instruction_set = "sse2");
    ~RayCaster();
    RayCaster(const RayCaster&) = delete;
    RayCaster& operator=(const RayCaster&) = delete;

    /// The nearest hit; of equally near items, the one with the lowest number. Safe from several threads.
    RayHit first(const Ray& ray) const;
    /// Whether an item is hit nearer than `until`. Safe from several threads.
    bool is_blocked(const Ray& ray, double until) const;

    /// Whether the ray meets the front of the item: the side of a triangle from which its corners are
    /// counter-clockwise, or the side of a disc to which its normal points. Discs without a normal have two fronts.
    bool faces(u32 item, const Ray& ray) const;

    std::size_t triangles() const;
    /// Centre and radius of a ball that contains all items.
    const Vec3& centre() const;
    double radius() const;

private:
    struct Scene;
    std::unique_ptr<Scene> scene_;
};

}  // namespace scanmill
