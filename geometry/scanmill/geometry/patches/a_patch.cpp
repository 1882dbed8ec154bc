// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/patches/a_patch.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace scanmill {

namespace {

// Weights of a polynomial of degree d are numbered like PatchWeights. De Casteljau's step computes the weight of degree
// d - 1 with exponents e from four weights of degree d. It is the sum over m of coordinate m times the weight with
// exponents e + unit(m).

constexpr int number_of(int degree, int i, int j, int k) {
    int number = 0;
    for (int a = degree; a >= 0; --a)
        for (int b = degree - a; b >= 0; --b)
            for (int c = degree - a - b; c >= 0; --c) {
                if (a == i && b == j && c == k) return number;
                ++number;
            }
    return -1;
}

/// For each weight of degree `degree - 1`, the numbers of the four weights of degree `degree` from which it is
/// computed.
template <int degree, int count>
constexpr std::array<std::array<int, 4>, count> raised() {
    std::array<std::array<int, 4>, count> table{};
    int number = 0;
    for (int i = degree - 1; i >= 0; --i)
        for (int j = degree - 1 - i; j >= 0; --j)
            for (int k = degree - 1 - i - j; k >= 0; --k) {
                table[static_cast<std::size_t>(number++)] = {
                    number_of(degree, i + 1, j, k), number_of(degree, i, j + 1, k), number_of(degree, i, j, k + 1),
                    number_of(degree, i, j, k)};
            }
    return table;
}
constexpr auto to_quadratic = raised<3, 10>();
constexpr auto to_linear = raised<2, 4>();

template <std::size_t count, class Table, class From>
std::array<double, count> lowered(const Table& table, const From& from, const Barycentric& at) {
    std::array<double, count> to;
    for (std::size_t n = 0; n < count; ++n) {
        const auto& parts = table[n];
        to[n] = at[0] * from[static_cast<std::size_t>(parts[0])] + at[1] * from[static_cast<std::size_t>(parts[1])] +
                at[2] * from[static_cast<std::size_t>(parts[2])] + at[3] * from[static_cast<std::size_t>(parts[3])];
    }
    return to;
}

Eigen::Vector4d linear_part(const PatchWeights& weights, const Barycentric& a, const Barycentric& b) {
    const auto linear = lowered<4>(to_linear, lowered<10>(to_quadratic, weights, a), b);
    return {linear[0], linear[1], linear[2], linear[3]};
}

}  // namespace

double patch_blossom(const PatchWeights& weights, const Barycentric& a, const Barycentric& b, const Barycentric& c) {
    return linear_part(weights, a, b).dot(c);
}

double patch_value(const PatchWeights& weights, const Barycentric& at) { return patch_blossom(weights, at, at, at); }

Eigen::Vector4d patch_derivatives(const PatchWeights& weights, const Barycentric& at) {
    return 3 * linear_part(weights, at, at);
}

PatchCell::PatchCell(const std::array<Vec3, 4>& corners, const PatchWeights& weights)
    : corners_(corners),
      weights_(&weights) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = corners[static_cast<std::size_t>(i)] - corners[3];
    const Eigen::Matrix3d inverse = edges.inverse();
    gradients_.leftCols<3>() = inverse.transpose();
    gradients_.col(3) = -gradients_.leftCols<3>().rowwise().sum();
}

PatchCell::PatchCell(const PatchComplex& patches, std::size_t tet)
    : PatchCell({patches.positions[patches.tets[tet][0]], patches.positions[patches.tets[tet][1]],
                 patches.positions[patches.tets[tet][2]], patches.positions[patches.tets[tet][3]]},
                patches.weights[tet]) {}

Barycentric PatchCell::coordinates(const Vec3& point) const {
    Barycentric at = gradients_.transpose() * (point - corners_[3]);
    at[3] = 1 - at[0] - at[1] - at[2];
    return at;
}

Vec3 PatchCell::point(const Barycentric& at) const {
    return at[0] * corners_[0] + at[1] * corners_[1] + at[2] * corners_[2] + at[3] * corners_[3];
}

Eigen::Matrix3d PatchCell::hessian(const Vec3& point) const {
    // The polar form with the point as one argument and two corners as the others is a weight of degree 2.
    const auto quadratic = lowered<10>(to_quadratic, *weights_, coordinates(point));
    Eigen::Matrix4d second;
    for (int m = 0, number = 0; m < 4; ++m)
        for (int n = m; n < 4; ++n) second(m, n) = second(n, m) = 6 * quadratic[static_cast<std::size_t>(number++)];
    return gradients_ * second * gradients_.transpose();
}

double PatchCell::first_order_distance(const Vec3& point) const {
    const Barycentric at = coordinates(point);
    const Eigen::Vector4d linear = linear_part(*weights_, at, at);
    return linear.dot(at) / (3 * (gradients_ * linear).norm());
}

std::optional<double> zero_of_cubic(const std::array<double, 4>& c) {
    if (c[0] == 0) return 0;
    if (c[3] == 0) return 1;
    if ((c[0] < 0) == (c[3] < 0)) return std::nullopt;
    const double sign = c[0] < 0 ? 1 : -1;  // the polynomial times `sign` rises through its zero
    double low = 0, high = 1, t = c[0] / (c[0] - c[3]);
    for (int step = 0; step < 100; ++step) {
        const double s = 1 - t;
        const double a0 = s * c[0] + t * c[1], a1 = s * c[1] + t * c[2], a2 = s * c[2] + t * c[3];
        const double b0 = s * a0 + t * a1, b1 = s * a1 + t * a2;
        const double value = s * b0 + t * b1, slope = 3 * (b1 - b0);
        if (value == 0) return t;
        (sign * value < 0 ? low : high) = t;
        double next = t - value / slope;
        if (!(next > low && next < high)) next = low + (high - low) / 2;
        if (next == t || !(next > low && next < high)) return t;
        t = next;
    }
    return t;
}

std::array<double, 4> patch_along(const PatchWeights& weights, const Barycentric& from, const Barycentric& to) {
    const Eigen::Vector4d first = linear_part(weights, from, from), last = linear_part(weights, to, to);
    return {first.dot(from), first.dot(to), last.dot(from), last.dot(to)};
}

std::optional<double> patch_hit(const PatchWeights& weights, const Barycentric& from, const Barycentric& to) {
    return zero_of_cubic(patch_along(weights, from, to));
}

std::vector<double> zeros_of_cubic(const std::array<double, 4>& c) {
    // Halves the interval until the weights change sign at most once. A zero at a common end of two parts belongs to
    // the second.
    struct Part {
        double begin, length;
        std::array<double, 4> c;
    };
    constexpr double shortest = 1e-15;
    std::vector<Part> parts{{0, 1, c}};
    std::vector<double> zeros;
    while (!parts.empty()) {
        const Part part = parts.back();
        parts.pop_back();
        const auto& w = part.c;
        if (std::ranges::all_of(w, [](double weight) { return weight == 0; })) {
            zeros.push_back(part.begin);
            break;
        }
        int changes = 0;
        for (std::size_t i = 1; i < 4; ++i) changes += (w[i] < 0) != (w[i - 1] < 0);
        const bool is_end = part.begin + part.length >= 1;
        if (changes == 0 && w[0] != 0 && w[3] != 0) continue;
        if (changes == 1 && w[0] != 0 && w[3] != 0) {
            if (const auto zero = zero_of_cubic(w)) zeros.push_back(part.begin + part.length * *zero);
            continue;
        }
        if (part.length < shortest) {
            if (w[0] == 0 || changes > 0)
                zeros.push_back(part.begin);
            else if (w[3] == 0 && is_end)
                zeros.push_back(1);
            continue;
        }
        const double a0 = (w[0] + w[1]) / 2, a1 = (w[1] + w[2]) / 2, a2 = (w[2] + w[3]) / 2;
        const double b0 = (a0 + a1) / 2, b1 = (a1 + a2) / 2, middle = (b0 + b1) / 2, half = part.length / 2;
        parts.push_back({part.begin + half, half, {middle, b1, a2, w[3]}});
        parts.push_back({part.begin, half, {w[0], a0, b0, middle}});
    }
    return zeros;
}

// ---- PatchSurface

namespace {

BoundingBox box_of(const PatchComplex& patches, std::size_t tet) {
    BoundingBox box;
    for (const u32 v : patches.tets[tet]) box.add(patches.positions[v]);
    return box;
}

/// A tree of the diagonals of the tetrahedra's boxes, as degenerate triangles. A diagonal has the same box as its
/// tetrahedron.
TriangleTree tree_of(const PatchComplex& patches, unsigned threads) {
    Array<Vec3> ends;
    Array<Triangle> diagonals;
    for (std::size_t tet = 0; tet < patches.tets.size(); ++tet) {
        const BoundingBox box = box_of(patches, tet);
        const auto first = static_cast<u32>(ends.size());
        diagonals.push_back({first, first + 1, first});
        ends.push_back(box.low);
        ends.push_back(box.high);
    }
    return TriangleTree(ends, diagonals, threads);
}

constexpr double outside_by = 1e-9;  // a coordinate of a point on a face may be below 0 by rounding
constexpr int pieces_per_diagonal = 64, most_steps = 50, most_halvings = 20;
// The next constants are shares of the diagonal.
constexpr double on_surface = 1e-15, end_of_steps = 1e-13, nearly_end = 1e-7, near_vertex = 1e-5;
constexpr double least_slope = 0.1;  // Newton's method divides by no smaller slope
constexpr double nearly_normal =
    1e-3;  // sine of the angle to the normal at which a foot is accepted if no step comes nearer

/// Rows of the tetrahedra whose boxes contain the point, ascending.
Array<u32> rows_near(const TriangleTree& boxes, const Vec3& point) {
    Array<u32> rows;
    BoundingBox box;
    box.add(point);
    boxes.meeting(box, rows);
    std::ranges::sort(rows);
    return rows;
}

}  // namespace

PatchSurface::PatchSurface(const PatchComplex& patches, unsigned threads)
    : patches_(patches),
      box_(bounding_box(patches.positions.span())),
      tree_(tree_of(patches, threads)) {}

std::optional<u32> PatchSurface::locate(const Vec3& point) const {
    const Array<u32> rows = rows_near(tree_, point);
    std::optional<u32> nearest;
    double smallest = 0;
    for (const double least : {0.0, -outside_by}) {
        for (const u32 row : rows) {
            if (cell(row).coordinates(point).minCoeff() < least) continue;
            const u32 here = active(row, point);
            const double size = std::abs(cell(here).value(point));
            if (nearest && size >= smallest) continue;
            nearest = here;
            smallest = size;
        }
        if (nearest) break;
    }
    return nearest;
}

u32 PatchSurface::active(u32 tet, const Vec3& point) const {
    const u32 partner = patches_.partners[tet];
    if (partner == PatchComplex::no_partner) return tet;
    // If both values are equal, the first row is active.
    const u32 first = std::min(tet, partner), second = std::max(tet, partner);
    const double one = cell(first).value(point), other = cell(second).value(point);
    return (patches_.combine[tet] == Combine::max ? other > one : other < one) ? second : first;
}

std::optional<double> PatchSurface::value(const Vec3& point) const {
    const auto tet = locate(point);
    return tet ? std::optional(cell(*tet).value(point)) : std::nullopt;
}

std::optional<Vec3> PatchSurface::gradient(const Vec3& point) const {
    const auto tet = locate(point);
    return tet ? std::optional(cell(*tet).gradient(point)) : std::nullopt;
}

std::optional<Eigen::Matrix3d> PatchSurface::hessian(const Vec3& point) const {
    const auto tet = locate(point);
    return tet ? std::optional(cell(*tet).hessian(point)) : std::nullopt;
}

bool PatchSurface::is_inside(const Vec3& point) const {
    if (const auto here = value(point)) return *here < 0;
    // The first hit leaves the object if the point is inside, and enters it if the point is outside.
    const Vec3 direction(2 * box_.diagonal(), 0, 0);
    const auto hit = first_hit(point, direction);
    return hit && hit->gradient.dot(direction) > 0;
}

std::optional<PatchSurface::Hit> PatchSurface::hit_in(u32 tet, const Vec3& from, const Vec3& direction) const {
    const PatchCell here = cell(tet);
    const Barycentric start = here.coordinates(from), change = here.coordinates(from + direction) - start;
    double begin = 0, end = 1;
    for (int i = 0; i < 4; ++i) {
        if (change[i] > 0)
            begin = std::max(begin, (-outside_by - start[i]) / change[i]);
        else if (change[i] < 0)
            end = std::min(end, (-outside_by - start[i]) / change[i]);
        else if (start[i] < -outside_by)
            return std::nullopt;
    }
    if (begin > end) return std::nullopt;
    const auto hit_at = [&](double zero, u32 row) {
        const double share = begin + zero * (end - begin);
        const Vec3 point = from + share * direction;
        return Hit{share, row, point, cell(row).gradient(point)};
    };
    const auto along = [&](const Barycentric& first, const Barycentric& by, u32 row) {
        return patch_along(patches_.weights[row], first + begin * by, first + end * by);
    };
    const std::vector<double> zeros = zeros_of_cubic(along(start, change, tet));
    const u32 partner = patches_.partners[tet];
    if (partner == PatchComplex::no_partner)
        return zeros.empty() ? std::nullopt : std::optional(hit_at(zeros.front(), tet));
    // Searches for the first zero of a row's function at which this row is active.
    if (partner < tet) return std::nullopt;  // the call for the partner finds it
    const PatchCell there = cell(partner);
    const Barycentric other_start = there.coordinates(from),
                      other_change = there.coordinates(from + direction) - other_start;
    std::optional<Hit> first;
    const auto offer = [&](const std::vector<double>& zeros_of_one, u32 one, u32 other) {
        for (const double zero : zeros_of_one) {
            const Hit hit = hit_at(zero, one);
            const PatchCell beside = cell(other);
            const double value = beside.value(hit.point) * (patches_.combine[one] == Combine::max ? 1 : -1);
            if (value > outside_by * beside.gradient(hit.point).norm() * box_.diagonal()) continue;
            if (!first || hit.share < first->share) first = hit;
            return;
        }
    };
    offer(zeros, tet, partner);
    offer(zeros_of_cubic(along(other_start, other_change, partner)), partner, tet);
    return first;
}

std::optional<PatchSurface::Hit> PatchSurface::first_hit(const Vec3& from, const Vec3& direction) const {
    // Only the part of the segment within the box matters.
    double begin = 0, end = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = box_.low[axis] - from[axis], high = box_.high[axis] - from[axis];
        if (direction[axis] == 0) {
            if (low > 0 || high < 0) return std::nullopt;
            continue;
        }
        const double one = low / direction[axis], other = high / direction[axis];
        begin = std::max(begin, std::min(one, other));
        end = std::min(end, std::max(one, other));
    }
    if (begin > end) return std::nullopt;
    const double pieces =
        std::ceil(std::max(1.0, (end - begin) * direction.norm() / box_.diagonal() * pieces_per_diagonal));
    Array<u32> rows;
    for (double piece = 0; piece < pieces; ++piece) {
        const double first = begin + (end - begin) * piece / pieces,
                     last = begin + (end - begin) * (piece + 1) / pieces;
        BoundingBox box;
        box.add(from + first * direction);
        box.add(from + last * direction);
        rows.clear();
        tree_.meeting(box, rows);
        std::ranges::sort(rows);
        std::optional<Hit> nearest;
        for (const u32 row : rows) {
            const auto hit = hit_in(row, from, direction);
            if (hit && (!nearest || hit->share < nearest->share)) nearest = hit;
        }
        if (nearest && nearest->share <= last) return nearest;
        // A hit beyond this piece is found again in a later piece. Rounding may put a hit just behind the last piece.
        if (nearest && piece + 1 == pieces) return nearest;
    }
    return std::nullopt;
}

std::optional<PatchSurface::Local> PatchSurface::local(const Vec3& point, std::optional<u32> hint) const {
    std::optional<u32> tet;
    if (hint && cell(*hint).coordinates(point).minCoeff() >= 0)
        tet = active(*hint, point);
    else
        tet = locate(point);
    if (!tet) return std::nullopt;
    const PatchCell here = cell(*tet);
    const Barycentric at = here.coordinates(point);
    return Local{*tet, patch_value(here.weights(), at), here.gradient(at)};
}

bool PatchSurface::retract(Vec3& point, Local& here) const {
    const double enough = on_surface * box_.diagonal();
    for (int step = 0; step < most_steps; ++step) {
        const double squared = here.gradient.squaredNorm();
        if (!(squared > 0)) return false;
        Vec3 change = here.gradient * (-here.value / squared);
        if (change.norm() <= enough) return true;
        // A step that is too long leaves the tetrahedra or passes the surface; it is halved.
        int halvings = 0;
        for (;; ++halvings, change /= 2) {
            if (halvings == most_halvings) return change.norm() <= nearly_end * enough / on_surface;
            const auto there = local(point + change, here.tet);
            if (!there || std::abs(there->value) > std::abs(here.value)) continue;
            point += change;
            here = *there;
            break;
        }
    }
    return false;
}

std::optional<PatchSurface::Foot> PatchSurface::foot(const Vec3& point, const Vec3& start) const {
    const double diagonal = box_.diagonal();
    Vec3 x = start;
    const auto first = local(x, std::nullopt);
    if (!first) return std::nullopt;
    Local here = *first;
    if (!retract(x, here)) return std::nullopt;
    for (int step = 0;; ++step) {
        const double length = here.gradient.norm();
        if (!(length > 0)) return std::nullopt;
        const Vec3 normal = here.gradient / length, to = point - x;
        const double distance = to.norm(), height = normal.dot(to);
        const Vec3 aside = to - height * normal;
        const Foot found{x, height < 0 ? -distance : distance};
        if (aside.norm() <= end_of_steps * diagonal) return found;
        // In the tangent plane the derivative of `aside` is -M. M is I + height * second derivative / length of the
        // gradient. An eigenvalue of M is almost 0 near a centre of curvature. Beyond this centre it is negative, and x
        // is not the nearest point.
        const Vec3 u = aside.normalized(), v = normal.cross(u);
        const Eigen::Matrix3d second = cell(here.tet).hessian(x) * (height / length);
        Eigen::Matrix2d slope;
        slope << 1 + u.dot(second * u), u.dot(second * v), u.dot(second * v), 1 + v.dot(second * v);
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
        axes.computeDirect(slope);
        const Eigen::Vector2d part = axes.eigenvectors().row(0).transpose();
        const Eigen::Vector2d solution =
            axes.eigenvectors() * part.cwiseQuotient(axes.eigenvalues().cwiseMax(least_slope)) * aside.norm();
        Vec3 change = solution[0] * u + solution[1] * v;
        bool is_nearer = false;
        for (int halvings = 0; halvings < most_halvings && step < most_steps && !is_nearer; ++halvings, change /= 2) {
            Vec3 next = x + change;
            const auto there = local(next, here.tet);
            if (!there) continue;
            Local then = *there;
            if (!retract(next, then)) continue;
            is_nearer = (point - next).norm() < distance || aside.norm() <= nearly_end * diagonal;
            if (!is_nearer) continue;
            x = next;
            here = then;
        }
        if (is_nearer) continue;
        if (aside.norm() <= nearly_normal * distance) return found;
        // At x, two functions meet, or the surface ends.
        const auto on_crease = foot_on_crease(point, x, here.tet);
        return on_crease && std::abs(on_crease->distance) <= distance + nearly_end * diagonal ? on_crease
                                                                                              : std::nullopt;
    }
}

std::vector<u32> PatchSurface::with_creases_at(const Vec3& point) const {
    std::vector<u32> found;
    for (const u32 row : rows_near(tree_, point))
        if (patches_.partners[row] != PatchComplex::no_partner && patches_.partners[row] > row &&
            cell(row).coordinates(point).minCoeff() >= -outside_by)
            found.push_back(row);
    return found;
}

Vec3 PatchSurface::step_on_crease(const Vec3& point, const Vec3& x, u32 tet) const {
    const PatchCell one = cell(tet), other = cell(patches_.partners[tet]);
    const Vec3 a = one.gradient(x), b = other.gradient(x), along = a.cross(b);
    if (!(along.squaredNorm() > 0)) return Vec3::Zero();
    Eigen::Matrix3d rows;
    rows << a.transpose(), b.transpose(), along.transpose();
    return rows.inverse() * Vec3(-one.value(x), -other.value(x), along.dot(point - x));
}

std::optional<PatchSurface::Foot> PatchSurface::foot_on_crease(const Vec3& point, const Vec3& start, u32 tet) const {
    if (patches_.partners[tet] == PatchComplex::no_partner) return std::nullopt;
    const double diagonal = box_.diagonal();
    Vec3 x = start;
    const auto found = [&] { return Foot{x, (patches_.combine[tet] == Combine::max ? 1 : -1) * (point - x).norm()}; };
    double before = std::numeric_limits<double>::infinity(), share = 1;
    bool was_whole = false;
    for (int step = 0; step < most_steps; ++step) {
        Vec3 change = step_on_crease(point, x, tet);
        if (change.norm() <= end_of_steps * diagonal) return found();
        // If a full step is not shorter than the last one, the steps pass the nearest point: `point` is near the
        // crease's centre of curvature. Smaller steps then converge.
        if (was_whole && change.norm() >= before) share /= 2;
        before = change.norm();
        change *= share;
        bool has_moved = false;
        for (int halvings = 0; halvings < most_halvings && !has_moved; ++halvings, change /= 2) {
            was_whole = halvings == 0;
            const std::vector<u32> tets = with_creases_at(x + change);
            if (tets.empty()) continue;
            x += change;
            tet = tets.front();
            has_moved = true;
        }
        if (has_moved) continue;
        // Other creases may begin where this one ends.
        const auto& corners = patches_.tets[tet];
        const u32 end =
            *std::ranges::min_element(corners, {}, [&](u32 v) { return (patches_.positions[v] - x).squaredNorm(); });
        const Vec3& vertex = patches_.positions[end];
        if ((vertex - x).norm() > near_vertex * diagonal) return std::nullopt;
        x = vertex;
        bool goes_on = false;
        for (const u32 row : with_creases_at(vertex)) {
            Vec3 next = step_on_crease(point, vertex, row);
            for (int halvings = 0; halvings < most_halvings && !goes_on; ++halvings, next /= 2) {
                const Vec3 there = vertex + next;
                if (cell(row).coordinates(there).minCoeff() < 0 ||
                    (point - there).norm() >= (point - vertex).norm() - nearly_end * next.norm())
                    continue;
                x = there;
                tet = row;
                goes_on = true;
            }
            if (goes_on) break;
        }
        if (!goes_on) return found();
        was_whole = false;
        share = 1;
    }
    return std::nullopt;
}

}  // namespace scanmill
