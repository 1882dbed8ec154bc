// SPDX-License-Identifier: GPL-3.0-or-later
#include "edge_flip/edge_flip.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/mesh/creases.hpp"
#include "scanmill/geometry/mesh/editable_mesh.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"
#include "scanmill/geometry/mesh/noisy_normals.hpp"
#include "scanmill/geometry/mesh/sharp_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace {

using Criterion = EdgeFlipParams::Criterion;

constexpr double least_gain = 1e-9;  // in radians, or as a share of the length
constexpr double straight = 1e-6;  // radians below π at which two angles form a straight line
/// Ratio of a triangle's height to its longest edge below which it has no normal (as in facet_normals.hpp).
constexpr double no_height = 1e-9;
/// Tolerances for rounding in planes: cosines of dihedral deviations, and distances as shares of lengths.
constexpr double cosine_rounding = 1e-12, distance_rounding = 1e-9;

/// An angle in [0, π], given by its cosine and sine, both times the same positive factor.
struct Direction {
    double cosine, sine;
};
/// Pre: the angles differ by less than π.
bool is_less(const Direction& a, const Direction& b) { return a.cosine * b.sine > a.sine * b.cosine; }

/// The least angle of a triangle. `one` and `two`: the edges from one of its corners. `normal`: their cross product. It
/// is equally long at all three corners, so the least angle has the largest dot product.
Direction least_angle(const Vec3& one, const Vec3& two, const Vec3& normal) {
    const double dot = one.dot(two);
    return {std::max({dot, one.squaredNorm() - dot, two.squaredNorm() - dot}), normal.norm()};
}

/// Whether the sum of the angles from `one` to `middle` and from `middle` to `two` is less than π - straight. The
/// cross products of the two angles have the lengths `one_sine` and `two_sine`.
bool is_convex(const Vec3& one, const Vec3& middle, const Vec3& two, double one_sine, double two_sine) {
    const double one_cosine = one.dot(middle), two_cosine = two.dot(middle);
    if (one_cosine <= 0 && two_cosine <= 0) return false;
    const double cosine = one_cosine * two_cosine - one_sine * two_sine;
    const double sine = one_cosine * two_sine + one_sine * two_cosine;
    return sine + straight * cosine > 0;
}

/// The squared distance between the segments from `a` along `u` and from `c` along `v`. Pre: u and v are not zero.
/// (Ericson 2005, Real-time collision detection, section 5.1.9.)
double squared_distance(const Vec3& a, const Vec3& u, const Vec3& c, const Vec3& v) {
    const Vec3 r = a - c;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), ur = u.dot(r), vr = v.dot(r);
    const double denominator = uu * vv - uv * uv;
    double s = denominator > 0 ? std::clamp((uv * vr - ur * vv) / denominator, 0.0, 1.0) : 0;
    double t = (uv * s + vr) / vv;
    if (t < 0 || t > 1) {
        t = std::clamp(t, 0.0, 1.0);
        s = std::clamp((uv * t - ur) / uu, 0.0, 1.0);
    }
    return (r + s * u - t * v).squaredNorm();
}

/// Two triangles at an edge, (a, b, c) and (b, a, d), and those at the other diagonal, (c, a, d) and (d, b, c).
struct Quadrilateral {
    Vec3 a, ab, ac, ad, bc, bd, cd;
    Vec3 abc, bad, cad, dbc;  ///< normals, as long as twice the areas

    Quadrilateral(const Vec3& a_, const Vec3& b, const Vec3& c, const Vec3& d)
        : a(a_),
          ab(b - a),
          ac(c - a),
          ad(d - a),
          bc(c - b),
          bd(d - b),
          cd(d - c),  //
          abc(ab.cross(ac)),
          bad(ad.cross(ab)),
          cad(ad.cross(ac)),
          dbc(bc.cross(bd)) {}

    bool gains_angle() const {
        const auto lesser = [](const Direction& one, const Direction& two) { return is_less(one, two) ? one : two; };
        const Direction now = lesser(least_angle(ab, ac, abc), least_angle(ab, ad, bad));
        const Direction then = lesser(least_angle(ac, ad, cad), least_angle(bc, bd, dbc));
        return is_less({now.cosine - least_gain * now.sine, now.sine + least_gain * now.cosine}, then);
    }
    bool gets_shorter() const {
        constexpr double factor = (1 - least_gain) * (1 - least_gain);
        return cd.squaredNorm() < ab.squaredNorm() * factor;
    }
    bool is_convex() const {
        const double c_sine = abc.norm(), d_sine = bad.norm();
        return scanmill::is_convex(ac, ab, ad, c_sine, d_sine) && scanmill::is_convex(bc, -ab, bd, c_sine, d_sine);
    }
    bool deviates(double share) const {
        const double shorter = std::min(ab.squaredNorm(), cd.squaredNorm());
        const double limit = share + distance_rounding;
        return squared_distance(a, ab, a + ac, cd) > limit * limit * shorter;
    }
};

/// Zero for a triangle without area. `longest`: the squared length of its longest edge.
Vec3 unit_normal(const Vec3& normal, double longest) {
    const double length = normal.norm();
    return length > no_height * longest ? Vec3(normal / length) : Vec3::Zero();
}
Vec3 unit_normal(const Vec3& normal, const Vec3& e, const Vec3& f, const Vec3& g) {
    return unit_normal(normal, std::max({e.squaredNorm(), f.squaredNorm(), g.squaredNorm()}));
}

enum class Decision : u8 { stays, flips, sharp, connected, folding, deviating, too_long };

class Flipping {
public:
    Flipping(const TriangleMesh& mesh, Array<u32> opposite, const std::vector<bool>& is_sharp,
             const EdgeFlipParams& params)
        : mesh_(mesh, std::move(opposite)),
          positions_(mesh.positions.begin(), mesh.positions.end()),
          criterion_(params.criterion),
          keep_cosine_(elementary::turn_of(params.keep_angle.in_radians()).cosine),
          deviation_(params.deviation.value()),
          flags_(3 * mesh.triangles.size(), 0),
          queue_(3 * mesh.triangles.size()) {
        if (params.max_edge) squared_max_edge_ = params.max_edge->value() * params.max_edge->value();
        has_sharp_ = !mesh.sharp_edges.empty();
        for (std::size_t h = 0; h < flags_.size(); ++h)
            if (is_sharp[h]) flags_[h] = sharp;
    }

    /// Judges the mesh in spite of its noise: creases stay, and unreliable triangles take the normals of
    /// neighbourhoods.
    void respect(const Creases& creases) {
        for (std::size_t h = 0; h < flags_.size(); ++h)
            if (creases.sharp[h]) flags_[h] |= sharp, has_sharp_ = true;
        if (creases.unreliable == 0) return;
        normals_.assign(mesh_.rows(), Vec3(Vec3::Zero()));
        for (u32 row = 0; row < mesh_.rows(); ++row)
            if (creases.normals[row] != creases.own_normals[row]) normals_[row] = creases.normals[row];
    }

    void run(Context& context) {
        for (u32 row = 0; row < mesh_.rows(); ++row)
            if (own_normal(row).isZero(0)) push(longest_edge(row));
        for (u32 h = 0; h < half_edges(); ++h)
            if (h < mesh_.opposite(h)) push(h);
        do {
            empty_queue(context);
            // A flip can also permit flips of edges that are not at its triangles.
            left_ = {};
            for (u32 h = 0; h < half_edges(); ++h) {
                if (h % check_interval == 0) context.check_cancelled();
                if (h < mesh_.opposite(h)) count(h, decide(h));
            }
        } while (queued_ > 0);
    }

    double least_angle() const {
        Direction least{-1, 1};
        for (u32 row = 0; row < mesh_.rows(); ++row) {
            const auto [one, two, normal] = shape(row);
            if (const Direction angle = scanmill::least_angle(one, two, normal); is_less(angle, least)) least = angle;
        }
        return angle_of(least.cosine, least.sine);
    }

    Array<Triangle> triangles() const { return mesh_.compact_triangles(); }
    Array<EdgeFlip> flips() { return std::move(flips_); }
    const BlockedEdges& left() const { return left_; }

private:
    static constexpr u8 sharp = 1, pending = 2;
    static constexpr u32 check_interval = 1 << 14;

    u32 half_edges() const { return static_cast<u32>(3 * mesh_.rows()); }

    struct Shape {
        Vec3 one, two, normal;
    };
    Shape shape(u32 row) const {
        const auto [a, b, c] = mesh_.triangle(row);
        const Vec3 one = positions_[b] - positions_[a], two = positions_[c] - positions_[a];
        return {one, two, one.cross(two)};
    }
    Vec3 own_normal(u32 row) const {
        const auto [one, two, normal] = shape(row);
        return unit_normal(normal, one, two, two - one);
    }
    bool is_unreliable(u32 row) const { return !normals_.empty() && !normals_[row].isZero(0); }
    Vec3 normal_of(u32 row) const { return is_unreliable(row) ? normals_[row] : own_normal(row); }
    /// The normal of the surface at two triangles. Triangles of their four vertices have no better one.
    Vec3 common_normal(u32 one, u32 two) const { return (normal_of(one) + normal_of(two)).normalized(); }
    u32 longest_edge(u32 row) const {
        const auto length = [&](u32 h) {
            return (positions_[mesh_.end(h)] - positions_[mesh_.start(h)]).squaredNorm();
        };
        u32 longest = 3 * row;
        for (const u32 h : {3 * row + 1, 3 * row + 2})
            if (length(h) > length(longest)) longest = h;
        return longest;
    }

    void push(u32 h) {
        const u32 other = mesh_.opposite(h);
        if (other == half_edges::boundary || ((flags_[h] | flags_[other]) & pending)) return;
        flags_[h] |= pending;
        queue_[(queue_begin_ + queued_++) % queue_.size()] = h;
    }
    u32 pop() {
        const u32 h = queue_[queue_begin_];
        queue_begin_ = (queue_begin_ + 1) % queue_.size();
        --queued_;
        flags_[h] &= static_cast<u8>(~pending);
        return h;
    }

    void empty_queue(Context& context) {
        for (std::size_t examined = 1; queued_ > 0; ++examined) {
            const u32 h = pop();
            if (decide(h) == Decision::flips) flip(h);
            if (examined % check_interval != 0) continue;
            context.check_cancelled();
            const double done = static_cast<double>(examined);
            progress_ = std::max(progress_, done / (done + static_cast<double>(queued_)));
            context.progress(progress_);
        }
    }

    Decision decide(u32 h) const {
        const u32 other = mesh_.opposite(h);
        if (other == half_edges::boundary) return Decision::stays;
        const u32 c = mesh_.apex(h), d = mesh_.apex(other);
        const Quadrilateral quad(positions_[mesh_.start(h)], positions_[mesh_.end(h)], positions_[c], positions_[d]);
        // Checks the criterion first, because it rejects most edges.
        if (!(criterion_ == Criterion::delaunay ? quad.gains_angle() : quad.gets_shorter())) return Decision::stays;
        if (criterion_ == Criterion::paper ? quad.cad.dot(quad.dbc) >= 0 : !quad.is_convex()) return Decision::stays;
        if (flags_[h] & sharp) return Decision::sharp;
        if (!mesh_.can_flip(h)) return Decision::connected;
        if (criterion_ != Criterion::paper) {
            if (folds(h, quad)) return Decision::folding;
            if (quad.deviates(deviation_)) return Decision::deviating;
        }
        if (!(quad.cd.squaredNorm() < squared_max_edge_)) return Decision::too_long;
        return Decision::flips;
    }

    bool folds(u32 h, const Quadrilateral& quad) const {
        Vec3 abc = unit_normal(quad.abc, quad.ab, quad.ac, quad.bc),
             bad = unit_normal(quad.bad, quad.ab, quad.ad, quad.bd);
        Vec3 cad = unit_normal(quad.cad, quad.ac, quad.ad, quad.cd),
             dbc = unit_normal(quad.dbc, quad.bc, quad.bd, quad.cd);
        const Vec3 mean = quad.abc + quad.bad;
        if (!(cad.dot(dbc) > 0 && cad.dot(mean) > 0 && dbc.dot(mean) > 0)) return true;
        const u32 other = mesh_.opposite(h);
        if (is_unreliable(h / 3) || is_unreliable(other / 3)) {
            abc = normal_of(h / 3);
            bad = normal_of(other / 3);
            cad = dbc = common_normal(h / 3, other / 3);
        }
        if (abc.isZero(0) && bad.isZero(0)) return true;
        if (abc.isZero(0)) abc = bad;
        if (bad.isZero(0)) bad = abc;
        double before = std::min(keep_cosine_, abc.dot(bad)), after = cad.dot(dbc);
        const auto add_outer = [&](u32 edge, const Vec3& old_normal, const Vec3& new_normal) {
            const u32 beyond = mesh_.opposite(edge);
            if (beyond == half_edges::boundary) return;
            const Vec3 outer = normal_of(beyond / 3);
            if (outer.isZero(0)) return;
            before = std::min(before, outer.dot(old_normal));
            after = std::min(after, outer.dot(new_normal));
        };
        add_outer(EditableMesh::after(h), abc, dbc);
        add_outer(EditableMesh::before(h), abc, cad);
        add_outer(EditableMesh::after(other), bad, cad);
        add_outer(EditableMesh::before(other), bad, dbc);
        return after < before - cosine_rounding;
    }

    void flip(u32 h) {
        const u32 other = mesh_.opposite(h);
        flips_.push_back({mesh_.start(h), mesh_.end(h), mesh_.apex(h), mesh_.apex(other)});
        const u32 h1 = EditableMesh::after(h), h2 = EditableMesh::before(h);
        const u32 o1 = EditableMesh::after(other), o2 = EditableMesh::before(other);
        if (has_sharp_) {  // each outer edge moves to the next half-edge
            const u8 bc = flags_[h1] & sharp, ca = flags_[h2] & sharp, ad = flags_[o1] & sharp, db = flags_[o2] & sharp;
            const auto set = [&](u32 edge, u8 flag) {
                flags_[edge] = static_cast<u8>((flags_[edge] & pending) | flag);
            };
            set(h1, ca), set(h2, ad), set(o1, db), set(o2, bc);
        }
        if (is_unreliable(h / 3) || is_unreliable(other / 3))
            normals_[h / 3] = normals_[other / 3] = common_normal(h / 3, other / 3);
        mesh_.flip(h);
        for (const u32 edge : {h1, h2, o1, o2}) push(edge);
    }

    void count(u32 h, Decision decision) {
        switch (decision) {
            case Decision::stays: break;
            case Decision::flips: push(h); break;
            case Decision::sharp: ++left_.sharp; break;
            case Decision::connected: ++left_.connected; break;
            case Decision::folding: ++left_.folding; break;
            case Decision::deviating: ++left_.deviating; break;
            case Decision::too_long: ++left_.too_long; break;
        }
    }

    EditableMesh mesh_;
    std::span<const Vec3> positions_;
    Criterion criterion_;
    double keep_cosine_, deviation_, squared_max_edge_ = std::numeric_limits<double>::infinity();
    bool has_sharp_ = false;
    /// By row: the normal of an unreliable triangle, and zero for others. Empty without unreliable triangles.
    Array<Vec3> normals_;
    /// By half-edge: the bits `sharp` (its edge is sharp) and `pending` (it is in the queue). A flip assigns some
    /// half-edges to other edges. A half-edge in the queue then represents its new edge.
    std::vector<u8> flags_;
    /// Ring buffer; contains every half-edge at most once.
    Array<u32> queue_;
    std::size_t queue_begin_ = 0, queued_ = 0;
    double progress_ = 0;
    Array<EdgeFlip> flips_;
    BlockedEdges left_;
};

/// Number of vertices of triangles that lie at the position of an earlier one.
std::size_t repeated_positions(const TriangleMesh& mesh) {
    const std::size_t slots = std::bit_ceil(2 * mesh.positions.size() + 1);
    constexpr u32 empty = ~u32(0);
    std::vector<u32> at(slots, empty);
    std::vector<bool> used(mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) used[vertex] = true;
    std::size_t repeats = 0;
    for (u32 vertex = 0; vertex < mesh.positions.size(); ++vertex) {
        if (!used[vertex]) continue;
        const Vec3& position = mesh.positions[vertex];
        u64 hash = 0;
        for (const double coordinate : {position.x(), position.y(), position.z()})
            hash = (std::rotl(hash, 21) ^ std::bit_cast<u64>(coordinate + 0.0)) * 0x9e3779b97f4a7c15u;  // -0 is 0
        std::size_t slot = (hash ^ (hash >> 32)) & (slots - 1);
        while (at[slot] != empty && mesh.positions[at[slot]] != position) slot = (slot + 1) & (slots - 1);
        if (at[slot] == empty)
            at[slot] = vertex;
        else
            ++repeats;
    }
    return repeats;
}

void require_usable(const TriangleMesh& mesh, const EdgeFlipParams& params) {
    const double keep = params.keep_angle.in_degrees(), deviation = params.deviation.value();
    if (!(keep >= 0 && keep <= 60))
        throw Error("keep-angle must be from 0 to 60 deg; it is {:g} deg", keep)
            .hint("leave keep-angle out for the default, which suits most meshes");
    if (!(deviation >= 0))
        throw Error("deviation must be 0 or more; it is {:g}", deviation)
            .hint("`10 %` is a tenth of the shorter diagonal");
    if (params.max_edge && !(params.max_edge->value() > 0))
        throw Error("max-edge must be above 0; it is {:g} u", params.max_edge->value())
            .hint("leave max-edge out to allow new edges of any length");
    if (params.noise && !(params.noise->value() >= 0 && std::isfinite(params.noise->value())))
        throw Error("noise must be 0 or more; it is {:g} u", params.noise->value())
            .hint("leave noise out to have it estimated");
    require_triangles(mesh, "edge-flip needs at least one");
}

void warn_of_left(const BlockedEdges& left, const EdgeFlipParams& params, Context& context) {
    if (left.total() == 0) return;
    std::string reasons;
    const auto add = [&](std::size_t edges, std::string_view reason) {
        if (edges > 0) reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", edges, reason);
    };
    add(left.sharp, "sharp");
    add(left.connected, "with the other diagonal in use as an edge");
    add(left.folding, fmt::format("where triangles would fold, or normals of neighbours would differ by more than {}",
                                  params.keep_angle.text()));
    add(left.deviating,
        fmt::format("where the surface would move by more than {} of the shorter diagonal", params.deviation.text()));
    add(left.too_long, "with the other diagonal not shorter than max-edge");
    context.warn(fmt::format("{} not flipped although the criterion is fulfilled: {}",
                             count_text(left.total(), "edge is", "edges are"), reasons));
}

}  // namespace

EdgeFlipResult edge_flip(const TriangleMesh& mesh, const EdgeFlipParams& params, Context& context) {
    require_usable(mesh, params);
    context.check_cancelled();
    const Array<u32> opposite = half_edges::opposites(mesh);
    const std::vector<bool> is_sharp = declared_sharp_half_edges(mesh, opposite);
    Flipping flipping(mesh, opposite, is_sharp, params);
    // Without noise, normals of triangles are reliable, and keep_angle protects creases.
    if (params.criterion != Criterion::paper) {
        const double noise = params.noise ? params.noise->value() : vertex_noise(mesh, opposite, context);
        const double sharp_angle = FeatureParams().sharp_angle.in_radians();
        if (noise > 0)
            flipping.respect(
                find_creases(mesh, opposite, {.sharp_angle = sharp_angle, .noise = noise, .least_size = 0}, context));
    }
    EdgeFlipResult result;
    result.min_angle_before = flipping.least_angle();
    flipping.run(context);
    result.min_angle_after = flipping.least_angle();
    result.left = flipping.left();
    result.flips = flipping.flips();

    if (const std::size_t repeats = repeated_positions(mesh); repeats > 0)
        context.warn(fmt::format("{} the position of another vertex; the mesh is open there and stays open",
                                 count_text(repeats, "vertex has", "vertices have")));
    warn_of_dropped(mesh.face_columns, "face columns", "flips replace triangles", context);
    warn_of_dropped(mesh.edge_columns, "edge columns", "flips replace edges", context);
    warn_of_left(result.left, params, context);
    result.mesh.frame = mesh.frame;
    result.mesh.positions = mesh.positions;
    result.mesh.vertex_columns = mesh.vertex_columns;
    result.mesh.sharp_edges = mesh.sharp_edges;
    result.mesh.triangles = flipping.triangles();

    context.metric("flips", static_cast<double>(result.flips.size()));
    context.metric("min-angle-before", result.min_angle_before, Unit::angle);
    context.metric("min-angle-after", result.min_angle_after, Unit::angle);
    context.metric("left", static_cast<double>(result.left.total()));
    context.progress(1);
    return result;
}

}  // namespace scanmill
