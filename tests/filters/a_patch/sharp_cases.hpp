// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Meshes with sharp edges, and the distances of points from the objects that they stand for.

#include "filters/a_patch/cases.hpp"
#include "scanmill/data/half_edges.hpp"

namespace scanmill::test {

/// A mesh that is put together from triangles, each with the normals of its corners.
struct SharpMesh {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    std::vector<double> normals;
    std::vector<Edge> sharp;

    u32 vertex(const Vec3& p) {
        positions.push_back(p);
        return static_cast<u32>(positions.size() - 1);
    }
    void add(const Triangle& t, const std::array<Vec3, 3>& n) {
        triangles.push_back(t);
        for (const Vec3& each : n) normals.insert(normals.end(), each.data(), each.data() + 3);
    }
    void plane(const Triangle& t, const Vec3& n) { add(t, {n, n, n}); }

    TriangleMesh mesh() const {
        TriangleMesh mesh = soup({positions.begin(), positions.end()}, {triangles.begin(), triangles.end()});
        mesh.face_columns.add(
            Column("corner-normals", 9, Buffer<double>(Array<double>(normals.begin(), normals.end()))));
        std::vector<Edge> edges = sharp;
        std::ranges::sort(edges);
        mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
        return mesh;
    }
};

/// The cube [0, 1]³, turned, with its 12 edges.
inline TriangleMesh sharp_cube(double angle = 0) {
    const TriangleMesh plain = turned(cube(), angle, Vec3(1, 2, 3));
    SharpMesh out;
    out.positions.assign(plain.positions.begin(), plain.positions.end());
    std::vector<Vec3> of_triangles;
    for (const Triangle& t : plain.triangles) {
        const Vec3 n = (plain.positions[t[1]] - plain.positions[t[0]])
                           .cross(plain.positions[t[2]] - plain.positions[t[0]])
                           .normalized();
        out.plane(t, n);
        of_triangles.push_back(n);
    }
    const Array<u32> opposites = half_edges::opposites(plain);
    for (u32 half = 0; half < opposites.size(); ++half)
        if (half < opposites[half] && of_triangles[half / 3].dot(of_triangles[opposites[half] / 3]) < 0.5)
            out.sharp.push_back(make_edge(half_edges::start(plain, half), half_edges::end(plain, half)));
    return out.mesh();
}

inline Vec3 circle(double k, u32 sides, double radius, double z) {
    const double angle = 2 * std::numbers::pi * k / sides;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}
inline Vec3 outwards(const Vec3& p) { return Vec3(p.x(), p.y(), 0).normalized(); }

/// Rings of `sides` vertices each.
struct Rings {
    SharpMesh out;
    u32 sides;

    std::vector<u32> ring(double radius, double z, double shift = 0) {
        std::vector<u32> numbers;
        for (u32 k = 0; k < sides; ++k) numbers.push_back(out.vertex(circle(k + shift, sides, radius, z)));
        return numbers;
    }
    void sharp(const std::vector<u32>& ring) {
        for (u32 k = 0; k < sides; ++k) out.sharp.push_back(make_edge(ring[k], ring[(k + 1) % sides]));
    }
    /// A wall from the lower to the upper ring; outwards is `sign` times away from the axis.
    void wall(const std::vector<u32>& low, const std::vector<u32>& high, double sign) {
        const auto add = [&](Triangle t) {
            if (sign < 0) std::swap(t[1], t[2]);
            std::array<Vec3, 3> n;
            for (std::size_t i = 0; i < 3; ++i) n[i] = sign * outwards(out.positions[t[i]]);
            out.add(t, n);
        };
        for (u32 k = 0; k < sides; ++k) {
            const u32 next = (k + 1) % sides;
            add({low[k], low[next], high[next]});
            add({low[k], high[next], high[k]});
        }
    }
    /// A plane ring, seen from above if `sign` is 1; the outer ring is turned by half a side.
    void plate(const std::vector<u32>& inner, const std::vector<u32>& outer, double sign) {
        const auto add = [&](Triangle t) {
            if (sign < 0) std::swap(t[1], t[2]);
            out.plane(t, sign * Vec3::UnitZ());
        };
        for (u32 k = 0; k < sides; ++k) {
            const u32 next = (k + 1) % sides;
            add({inner[k], outer[k], inner[next]});
            add({inner[next], outer[k], outer[next]});
        }
    }
    void disc(const std::vector<u32>& ring, double sign) {
        const u32 centre = out.vertex(Vec3(0, 0, out.positions[ring[0]].z()));
        for (u32 k = 0; k < sides; ++k) {
            Triangle t{centre, ring[k], ring[(k + 1) % sides]};
            if (sign < 0) std::swap(t[1], t[2]);
            out.plane(t, sign * Vec3::UnitZ());
        }
    }
};

/// Radius 1, z from -1 to 1, with sharp rims.
inline TriangleMesh cylinder(u32 sides) {
    Rings rings{{}, sides};
    const auto low = rings.ring(1, -1), high = rings.ring(1, 1);
    rings.wall(low, high, 1);
    rings.disc(high, 1);
    rings.disc(low, -1);
    rings.sharp(low);
    rings.sharp(high);
    return rings.out.mesh();
}
inline double cylinder_distance(const Vec3& p) {
    return std::min(std::abs(std::hypot(p.x(), p.y()) - 1), std::abs(std::abs(p.z()) - 1));
}

/// Apex (0, 0, 1), base of radius 1 in z = 0 with a sharp rim. The apex has no normal.
inline TriangleMesh cone(u32 sides) {
    Rings rings{{}, sides};
    const auto rim = rings.ring(1, 0);
    const u32 apex = rings.out.vertex(Vec3(0, 0, 1));
    for (u32 k = 0; k < sides; ++k) {
        const u32 a = rim[k], b = rim[(k + 1) % sides];
        const auto normal = [&](u32 v) -> Vec3 {
            return (outwards(rings.out.positions[v]) + Vec3::UnitZ()).normalized();
        };
        rings.out.add({a, b, apex}, {normal(a), normal(b), Vec3::Zero()});
    }
    rings.disc(rim, -1);
    rings.sharp(rim);
    return rings.out.mesh();
}

/// A plate 3 in radius, z from -1 to 1, with a hole of radius 1.
inline TriangleMesh plate_with_hole(u32 sides) {
    Rings rings{{}, sides};
    const auto low = rings.ring(1, -1), high = rings.ring(1, 1);
    const auto outer_low = rings.ring(3, -1, 0.5), outer_high = rings.ring(3, 1, 0.5);
    rings.wall(low, high, -1);
    rings.wall(outer_low, outer_high, 1);
    rings.plate(high, outer_high, 1);
    rings.plate(low, outer_low, -1);
    for (const auto* ring : {&low, &high, &outer_low, &outer_high}) rings.sharp(*ring);
    return rings.out.mesh();
}
inline double hole_distance(const Vec3& p) {
    const double radius = std::hypot(p.x(), p.y());
    return std::min({std::abs(radius - 1), std::abs(radius - 3), std::abs(std::abs(p.z()) - 1)});
}

/// A plate 3 in radius, z from -1 to 0, with a boss of radius 1 up to z = 1.
inline TriangleMesh plate_with_boss(u32 sides) {
    Rings rings{{}, sides};
    const auto foot = rings.ring(1, 0), top = rings.ring(1, 1);
    const auto outer_low = rings.ring(3, -1, 0.5), outer_high = rings.ring(3, 0, 0.5);
    rings.wall(foot, top, 1);
    rings.wall(outer_low, outer_high, 1);
    rings.disc(top, 1);
    rings.plate(foot, outer_high, 1);
    rings.disc(outer_low, -1);
    for (const auto* ring : {&foot, &top, &outer_low, &outer_high}) rings.sharp(*ring);
    return rings.out.mesh();
}
inline double boss_distance(const Vec3& p) {
    const double radius = std::hypot(p.x(), p.y());
    return std::min(
        {std::abs(radius - 1), std::abs(radius - 3), std::abs(p.z() - 1), std::abs(p.z()), std::abs(p.z() + 1)});
}

/// A plate 3 in radius, z from -1 to 1, with a pocket of radius 1 down to z = 0; its distance is that of the boss.
inline TriangleMesh plate_with_pocket(u32 sides) {
    Rings rings{{}, sides};
    const auto low = rings.ring(1, 0), high = rings.ring(1, 1);
    const auto outer_low = rings.ring(3, -1, 0.5), outer_high = rings.ring(3, 1, 0.5);
    rings.wall(low, high, -1);
    rings.wall(outer_low, outer_high, 1);
    rings.disc(low, 1);
    rings.plate(high, outer_high, 1);
    rings.disc(outer_low, -1);
    for (const auto* ring : {&low, &high, &outer_low, &outer_high}) rings.sharp(*ring);
    return rings.out.mesh();
}

}  // namespace scanmill::test
