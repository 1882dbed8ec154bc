// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/strip.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace scanmill::tessellation {

namespace {

constexpr double share_along = 2. / 3;  // share of max_error, for lines along rows
constexpr int most_bisections = 60;

/// The tetrahedra at an edge and the points of the surface there.
class EdgeLines {
public:
    EdgeLines(const PatchComplex& patches, const PatchStructure& structure, const EdgeTets& edge, double zero)
        : edge_(edge),
          zero_(zero) {
        for (std::size_t of = 0; of < (edge.is_border() ? 1 : 2); ++of) {
            const TriangleTets& t = structure.triangles[edge.triangles[of]];
            is_whole_[of] = t.count == 1;
            for (std::size_t side = 0; side < 2; ++side) {
                thirds_[of][side].emplace(patches, t.rows[side][is_whole_[of] ? 0 : edge.numbers[of]]);
                if (edge.rows[side][of] != none) gaps_[of][side].emplace(patches, edge.rows[side][of]);
            }
        }
        set_crossings();
    }

    /// Shares of the edge, ascending, at which the surface crosses it between its ends.
    const std::vector<double>& crossings() const { return crossings_; }

    Sample sample(std::array<double, 2> share) const {
        Sample sample{share};
        const double one = value(0, share[0]);
        if (!edge_.is_sharp) {
            sample.side = one <= zero_;
            sample.is_on_surface =
                std::abs(one) <= zero_ || std::ranges::find(crossings_, share[0]) != crossings_.end();
            return sample;
        }
        const double other = value(1, share[0]);
        sample.is_on_surface = std::abs(one) <= zero_ && std::abs(other) <= zero_;
        sample.side = side_of(one, other, edge_.combine, zero_);
        return sample;
    }

    /// Adds the points of a sample, and their numbers by column.
    void lift(Strip& strip, Sample& sample) const {
        if (sample.is_on_surface)
            lift_on_surface(strip, sample);
        else if (edge_.is_border())
            add(strip, thirds_[0][sample.side]->hit(sample.side, on_edge(0, sample.share[0]), apex(), zero_).point);
        else if (!gaps_[0][sample.side])
            lift_open(strip, sample);
        else
            edge_.is_sharp ? lift_crease(strip, sample) : lift_fan(strip, sample);
    }

    /// The distance between the surface and a point of a triangle in the first or second half of the strip, above
    /// samples on `side`.
    double distance_at(const Vec3& point, std::size_t half, u8 side) const {
        const auto& gap = gaps_[half][side];
        const PatchCell* cell = gap ? &gap->own() : &thirds_[half][side]->own();
        // If the crease is above the other triangle, the function is continued there.
        if (gap && edge_.is_sharp && cell->coordinates(point)[3] < 0 && thirds_[1 - half][side]->has_other())
            cell = &thirds_[1 - half][side]->other();
        return std::abs(cell->first_order_distance(point));
    }

private:
    static Barycentric apex() { return {0, 0, 0, 1}; }

    /// Coordinates of a point of the edge in the triangle's tetrahedra.
    Barycentric on_edge(std::size_t of, double share) const {
        const u32 first = is_whole_[of] ? edge_.numbers[of] : 1, second = is_whole_[of] ? (first + 1) % 3 : 2;
        Barycentric at = Barycentric::Zero();
        at[of == 0 ? first : second] = 1 - share;
        at[of == 0 ? second : first] = share;
        return at;
    }
    /// Coordinates of a point of the edge in the tetrahedra of the gap.
    static Barycentric in_gap(std::size_t of, double share) {
        return of == 0 ? Barycentric(0, 1 - share, share, 0) : Barycentric(0, share, 1 - share, 0);
    }

    const PatchWeights& weights(std::size_t of) const { return thirds_[of][1]->own().weights(); }
    double value(std::size_t of, double share) const { return patch_value(weights(of), on_edge(of, share)); }

    /// On the edge a function is 3 s (1 - s) ((1 - s) f(a, a, b) + s f(a, b, b)).
    void set_crossings() {
        for (std::size_t of = 0; of < (edge_.is_sharp ? 2 : 1); ++of) {
            const Barycentric a = on_edge(of, 0), b = on_edge(of, 1);
            const double one = patch_blossom(weights(of), a, a, b), two = patch_blossom(weights(of), a, b, b);
            if (!((one < 0 && two > 0) || (one > 0 && two < 0))) continue;
            const double share = one / (one - two);
            // Before or after the crossing, the edge is on the surface up to rounding.
            if (std::min(std::abs(one) * share, std::abs(two) * (1 - share)) <= zero_) continue;
            // The other function, which is not 0 at the crossing, may hold there instead.
            if (edge_.is_sharp && value(1 - of, share) * (edge_.combine == Combine::max ? 1 : -1) > zero_) continue;
            crossings_.push_back(share);
        }
        std::ranges::sort(crossings_);
        crossings_.erase(std::ranges::unique(crossings_).begin(), crossings_.end());
    }

    static u32 add(Strip& strip, const SurfacePoint& point, const Vec3& second_normal = Vec3::Zero()) {
        strip.points.push_back(point);
        strip.second_normals.push_back(second_normal);
        strip.numbers.push_back(static_cast<u32>(strip.points.size() - 1));
        return strip.numbers.back();
    }

    void lift_on_surface(Strip& strip, const Sample& sample) const {
        const double share = sample.share[0];
        const Barycentric at = on_edge(0, share);
        const PatchCell& cell = thirds_[0][1]->own();
        const SurfacePoint point{cell.point(at), cell.gradient(at).normalized(), 1};
        if (edge_.is_sharp)
            add(strip, point, thirds_[1][1]->own().gradient(on_edge(1, share)).normalized());
        else
            add(strip, point);
        for (unsigned k = 1; k < strip.columns(); ++k) strip.numbers.push_back(strip.numbers.back());
    }

    /// Lifts along lines to two segments: from the first apex to the point between both apexes, and from there to the
    /// second apex.
    void lift_fan(Strip& strip, const Sample& sample) const {
        for (unsigned k = 0; k < strip.columns(); ++k) {
            const bool is_second = 2 * k > strip.fan;
            const double across = static_cast<double>(is_second ? strip.fan - k : k) / strip.fan;
            add(strip,
                gaps_[is_second][sample.side]
                    ->hit(sample.side, in_gap(is_second, sample.share[0]), {2 * across, 0, 0, 1 - 2 * across}, zero_)
                    .point);
        }
    }

    /// Closes a gap without tetrahedra between the points on the two faces, in two segments that meet in the middle
    /// column: in a crease, like a mitre joint, if there is one between the lines to the two apexes. Else in one
    /// straight segment, or, if that would pass over the triangles, in two segments over the edge: if the points are on
    /// different sides of the mesh, or the two apexes on their side lie beyond each other.
    void lift_open(Strip& strip, Sample& sample) const {
        sample.is_open = true;
        const std::array bases{on_edge(0, sample.share[0]), on_edge(1, sample.share[0])};
        const std::array<bool, 2> are_bases{is_zero(0, bases[0]), is_zero(1, bases[1])};
        std::array<SurfacePoint, 2> points;
        std::array<u8, 2> sides;
        for (std::size_t of = 0; of < 2; ++of) sides[of] = thirds_[of][1]->side_at(bases[of], zero_);
        // A point on the mesh is on either side.
        for (std::size_t of = 0; of < 2; ++of)
            if (are_bases[of]) sides[of] = sides[1 - of];
        for (std::size_t of = 0; of < 2; ++of)
            points[of] = thirds_[of][sides[of]]->hit(sides[of], bases[of], apex(), zero_).point;
        const bool are_one = (points[0].position - points[1].position).norm() <= zero_;
        const Vec3 middle = thirds_[0][1]->own().point(bases[0]);
        const std::array lines{line_to_apex(0, sides[0], middle), line_to_apex(1, sides[1], middle)};
        const double turn = along().dot(lines[0].cross(lines[1]));
        const bool is_bent = sides[0] != sides[1] || (sides[0] == 1 ? turn : -turn) <= 0;
        const std::optional<Vec3> mitre =
            are_one || is_bent || !edge_.is_sharp ? std::nullopt : mitre_of(points, middle, lines);
        // The crease: the mitre, a point on the edge, or the end at which a straight segment turns more.
        SurfacePoint crease = points[0];
        bool is_first = true, is_last = are_one;
        if (mitre) {
            is_first = false;
            crease.position = *mitre;
        } else if (is_bent && !are_one) {
            is_first = false;
            crease.position = middle;
            crease.side = 1;
        } else if (!are_one) {
            const Vec3 across = points[1].position - points[0].position;
            is_last = std::abs(across.dot(points[0].normal)) < std::abs(across.dot(points[1].normal));
            is_first = !is_last;
            crease.position = points[is_last].position;
        }
        if (!edge_.is_sharp && !is_first) crease.normal = (points[0].normal + points[1].normal).normalized();
        const Vec3 beyond = edge_.is_sharp ? points[1].normal : Vec3::Zero();
        const auto fill = [&](unsigned columns, const SurfacePoint& point, const Vec3& second_normal) {
            if (columns == 0) return;
            add(strip, point, second_normal);
            strip.numbers.resize(strip.numbers.size() + columns - 1, strip.numbers.back());
        };
        const unsigned half = strip.fan / 2, before = is_first ? 0 : half, after = is_last ? 0 : half;
        fill(before, points[0], Vec3::Zero());
        fill(strip.columns() - before - after, crease, beyond);
        fill(after, points[1], Vec3::Zero());
    }

    bool is_zero(std::size_t of, const Barycentric& base) const {
        return std::abs(patch_value(weights(of), base)) <= zero_;
    }
    /// The vector from one end of the edge to the other.
    Vec3 along() const {
        const PatchCell& cell = thirds_[0][1]->own();
        return cell.point(on_edge(0, 1)) - cell.point(on_edge(0, 0));
    }
    Vec3 line_to_apex(std::size_t of, u8 side, const Vec3& from) const {
        return thirds_[of][side]->own().point(apex()) - from;
    }

    /// The point where the tangent planes of two points meet in the triangle of the edge point `middle` and the two
    /// apexes, to which the lines lead. Empty if they do not meet there, or not between the two points.
    static std::optional<Vec3> mitre_of(const std::array<SurfacePoint, 2>& points, const Vec3& middle,
                                        const std::array<Vec3, 2>& lines) {
        std::array<double, 2> height;  // of the edge point below the planes
        std::array<std::array<double, 2>, 2> slope;  // of the lines, by plane
        for (std::size_t of = 0; of < 2; ++of) {
            height[of] = points[of].normal.dot(points[of].position - middle);
            for (std::size_t line = 0; line < 2; ++line) slope[of][line] = points[of].normal.dot(lines[line]);
        }
        const double determinant = slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
        if (determinant == 0) return std::nullopt;
        const double one = (height[0] * slope[1][1] - height[1] * slope[0][1]) / determinant,
                     other = (slope[0][0] * height[1] - slope[1][0] * height[0]) / determinant;
        if (!(one >= 0 && other >= 0 && one + other <= 1)) return std::nullopt;
        const Vec3 mitre = middle + one * lines[0] + other * lines[1];
        const Vec3 across = points[1].position - points[0].position;
        const Vec3 from = mitre - (points[0].position + points[1].position) / 2;
        if (from.squaredNorm() > across.squaredNorm() || 2 * std::abs(from.dot(across)) > across.squaredNorm())
            return std::nullopt;
        return mitre;
    }

    // Creases. The way from the inside of the first triangle to the inside of the second has three parts. The first has
    // lines from points of the first triangle to its apex. The second has lines from the edge to points between the
    // apexes. The third has lines from points of the second triangle to its apex. On this way, the function that holds
    // changes from the first triangle's to the second's.

    struct Place {
        std::size_t zone;  ///< 0: first triangle, 1: gap, 2: second triangle
        double at;  ///< share of the way from the edge to the base point, or from the first apex to the second
    };
    struct Found {
        SurfacePoint point;
        bool is_second, is_on_edge, is_missed;
        double lead;  ///< of the first triangle's function: negative where the second's holds
    };

    Found found(const Sample& sample, const Place& place) const {
        if (place.zone == 1) {
            const auto hit = gaps_[0][sample.side]->hit(sample.side, in_gap(0, sample.share[0]),
                                                        {place.at, 0, 0, 1 - place.at}, zero_);
            return {hit.point, hit.is_other, hit.is_at_base, hit.is_missed, hit.lead};
        }
        const std::size_t of = place.zone / 2;
        Barycentric base = (1 - place.at) * on_edge(of, sample.share[0]);
        base[0] += place.at;
        const u8 side = thirds_[of][1]->side_at(base, zero_);
        const auto hit = thirds_[of][side]->hit(side, base, apex(), zero_);
        return {hit.point, hit.is_other != (of == 1), false, hit.is_missed, of == 1 ? -hit.lead : hit.lead};
    }

    /// Finds where the function changes, between a position where the first triangle's holds and one where the second's
    /// does. Returns the nearest numbers on both sides of the change. Empty if the crease leaves the tetrahedra beside
    /// the edge.
    std::optional<std::array<Place, 2>> change(const Sample& sample) const {
        Place low{1, 0}, high{1, 1};
        const bool is_whole = is_whole_[0] || is_whole_[1];
        if (found(sample, low).is_second) {
            high = {0, 0};
            low = {0, 1};
        } else if (!found(sample, high).is_second) {
            low = {2, 0};
            high = {2, 1};
        }
        if (low.zone != 1 && (is_whole || found(sample, low).is_second || !found(sample, high).is_second))
            return std::nullopt;
        // Ridders' method; bisection where a function has no zero on a line.
        double at_low = found(sample, low).lead, at_high = found(sample, high).lead;
        const auto narrow = [&](double at) {
            const Place place{low.zone, at};
            const Found here = found(sample, place);
            (here.is_second ? high : low) = place;
            (here.is_second ? at_high : at_low) = here.lead;
            return here.lead;
        };
        for (int step = 0; step < most_bisections; ++step) {
            const double start = low.at, end = high.at, middle = (start + end) / 2;
            if (middle == start || middle == end) break;
            const double product = at_low * at_high, lead = narrow(middle);
            const double at = middle + (middle - start) * (lead / std::sqrt(lead * lead - product));
            if (at > std::min(low.at, high.at) && at < std::max(low.at, high.at)) narrow(at);
        }
        return std::array{low, high};
    }

    /// The gradient of one of the two triangles' functions at a point near the crease.
    Vec3 gradient(const Sample& sample, std::size_t of, const Place& place, const Vec3& point) const {
        const std::size_t third = place.zone / 2;
        if (place.zone == 1) return gaps_[of][sample.side]->own().gradient(point);
        const TetFunctions& functions = *thirds_[third][sample.side];
        return (of == third ? functions.own() : functions.other()).gradient(point);
    }
    double distance(const Sample& sample, const Place& place, const Vec3& point) const {
        const std::size_t third = place.zone / 2;
        if (place.zone == 1)
            return std::max(std::abs(gaps_[0][sample.side]->own().first_order_distance(point)),
                            std::abs(gaps_[1][sample.side]->own().first_order_distance(point)));
        const TetFunctions& functions = *thirds_[third][sample.side];
        return std::max(std::abs(functions.own().first_order_distance(point)),
                        std::abs(functions.other().first_order_distance(point)));
    }

    void lift_crease(Strip& strip, Sample& sample) const {
        const auto change = this->change(sample);
        if (!change) {
            lift_open(strip, sample);
            return;
        }
        const Place& crease = (*change)[0];
        // If a plane of the object contains the line, the surface jumps along it. One of the two ends is then on the
        // crease.
        const std::array<Found, 2> ends{found(sample, (*change)[0]), found(sample, (*change)[1])};
        const unsigned half = strip.fan / 2;
        std::vector<Found> way;
        for (unsigned k = 0; k < strip.columns(); ++k) {
            const double share = static_cast<double>(k < half ? k : strip.fan - k) / half;  // from the face
            way.push_back(k == half ? ends[0] : found(sample, on_way(crease, share, k < half)));
        }
        if (ends[1].is_missed || std::ranges::any_of(way, &Found::is_missed)) {
            lift_open(strip, sample);
            return;
        }
        const bool take_second =
            distance(sample, crease, ends[1].point.position) < distance(sample, crease, ends[0].point.position);
        SurfacePoint point = ends[take_second].point;
        const std::array<Vec3, 2> normals{gradient(sample, 0, crease, point.position).normalized(),
                                          gradient(sample, 1, crease, point.position).normalized()};
        point.normal = normals[0];
        if (crease.zone != 1) sample.inset[crease.zone / 2] = crease.at;

        u32 on_crease = none, on_edge = none;
        for (unsigned k = 0; k < strip.columns(); ++k) {
            const bool is_before = k < half;
            // If the crease is above a triangle, all columns of that triangle's half are on the crease.
            if (k == half || (is_before && crease.zone == 0) || (!is_before && crease.zone == 2)) {
                if (on_crease == none)
                    on_crease = add(strip, point, normals[1]);
                else
                    strip.numbers.push_back(on_crease);
                continue;
            }
            const Found& here = way[k];
            if (here.is_on_edge && on_edge != none) {
                strip.numbers.push_back(on_edge);
                continue;
            }
            add(strip, here.point);
            if (here.is_on_edge) on_edge = strip.numbers.back();
        }
    }

    /// The position at `share` of the way to the crease from the face of the first or second triangle.
    static Place on_way(const Place& crease, double share, bool is_first) {
        const double start = is_first ? 0 : 1;
        if (crease.zone == 1) return {1, start + share * (crease.at - start)};
        // The way leads first through the gap, then over the other triangle.
        if (share <= 0.5) return {1, start + 2 * share * (1 - 2 * start)};
        return {crease.zone, (2 * share - 1) * crease.at};
    }

    const EdgeTets& edge_;
    double zero_;
    std::array<bool, 2> is_whole_{};
    std::array<std::array<std::optional<TetFunctions>, 2>, 2> thirds_, gaps_;  ///< by triangle and side
    std::vector<double> crossings_;
};

/// Returns equally spaced samples, and one where the surface crosses the edge. The nearest sample is moved to the
/// crossing if it is nearer than a quarter of the spacing.
std::vector<std::array<double, 2>> shares_of(const std::vector<double>& crossings, unsigned segments) {
    std::vector<std::array<double, 2>> shares;
    for (unsigned k = 1; k < segments; ++k)
        shares.push_back({static_cast<double>(k) / segments, static_cast<double>(segments - k) / segments});
    std::vector<bool> is_free(shares.size(), true);
    for (const double crossing : crossings) {
        const double at = crossing * segments, nearest = std::floor(at + 0.5);
        const auto number = static_cast<std::size_t>(std::max(nearest, 1.0)) - 1;
        if (nearest >= 1 && nearest < segments && is_free[number] && std::abs(at - nearest) < 0.25) {
            shares[number] = {crossing, 1 - crossing};
            is_free[number] = false;
        } else {
            shares.push_back({crossing, 1 - crossing});
        }
    }
    std::ranges::sort(shares, {}, [](const auto& share) { return share[0]; });
    return shares;
}

Errors errors_of(const Strip& strip, const PatchComplex& patches, const EdgeTets& edge, const EdgeLines& lines) {
    Errors errors;
    const std::size_t last = strip.samples.size() + 1;
    const auto position = [&](std::size_t s, unsigned k) -> const Vec3& {
        if (s == 0) return patches.positions[edge.a];
        if (s == last) return patches.positions[edge.b];
        return strip.points[strip.number(s - 1, k)].position;
    };
    for (std::size_t s = 0; s < last; ++s) {
        const bool is_first_on_surface = s == 0 || strip.samples[s - 1].is_on_surface;
        const std::size_t other = is_first_on_surface ? s + 1 : s;
        const u8 side = other > 0 && other < last ? strip.samples[other - 1].side : u8(1);
        // Between points on the edge, all columns coincide.
        const bool is_flat = is_first_on_surface && (s + 1 == last || strip.samples[s].is_on_surface);
        // In an open strip, only the borders of the faces are on the surface.
        const bool is_open = (s > 0 && strip.samples[s - 1].is_open) || (s + 1 < last && strip.samples[s].is_open);
        for (unsigned k = 0; k < (is_flat ? 1 : strip.columns()); ++k) {
            if (is_open && k > 0 && k + 1 < strip.columns()) continue;
            const bool is_second = 2 * k >= strip.fan && !edge.is_border();
            const auto at = [&](const Vec3& p) { return lines.distance_at(p, is_second, side); };
            const Vec3 &a = position(s, k), &d = position(s + 1, k);
            errors.along = std::max(errors.along, distance_on_segment(a, d, at));
            // The crease is on the surfaces of both functions.
            if (edge.is_sharp && 2 * k == strip.fan)
                errors.along =
                    std::max(errors.along,
                             distance_on_segment(a, d, [&](const Vec3& p) { return lines.distance_at(p, 0, side); }));
            if (is_flat || is_open || k + 1 == strip.columns()) continue;
            const Vec3 &b = position(s, k + 1), &c = position(s + 1, k + 1);
            errors.across = std::max(errors.across, distance_on_segment(a, b, at));
            errors.inside =
                std::max({errors.inside, distance_on_segment(a, c, at), at((a + b + c) / 3), at((a + c + d) / 3)});
        }
    }
    return errors;
}

}  // namespace

bool refine(unsigned& along, unsigned& across, const Errors& errors, double max_error, unsigned most,
            unsigned most_across) {
    // With more columns, the triangles follow the lines along the rows. These lines get a smaller share of the error.
    const bool is_long = errors.along > share_along * max_error, can_lengthen = 2 * along <= most;
    const bool are_rows_enough = !is_long || (!can_lengthen && errors.inside > errors.along);
    const bool widen =
        2 * across <= most_across && (errors.across > max_error || (errors.inside > max_error && are_rows_enough));
    const bool lengthen = can_lengthen && (is_long || (errors.inside > max_error && !widen));
    if (lengthen) along *= 2;
    if (widen) across *= 2;
    return lengthen || widen;
}

void build(Strip& strip, const PatchComplex& patches, const PatchStructure& structure, const EdgeTets& edge,
           double zero, std::optional<double> max_error, unsigned most) {
    const EdgeLines lines(patches, structure, edge, zero);
    for (;;) {
        strip.samples.clear();
        strip.numbers.clear();
        strip.points.clear();
        strip.second_normals.clear();
        for (const auto& share : shares_of(lines.crossings(), strip.segments)) {
            strip.samples.push_back(lines.sample(share));
            lines.lift(strip, strip.samples.back());
        }
        if (!max_error) return;
        const Errors errors = errors_of(strip, patches, edge, lines);
        strip.worst = errors.worst();
        if (!refine(strip.segments, strip.fan, errors, *max_error, most, edge.is_border() ? 0 : most)) return;
    }
}

}  // namespace scanmill::tessellation
