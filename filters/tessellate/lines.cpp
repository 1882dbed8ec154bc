// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/base/error.hpp"

namespace scanmill::tessellation {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Parameter at which a cubic with at most one sign change gets the sign; `never` if it does not.
double change_to(double sign, const std::array<double, 4>& weights, double zero) {
    if (sign * weights[3] < 0) return never;
    if (sign * weights[0] >= -zero) return 0;
    return zero_of_cubic(weights).value_or(never);
}

}  // namespace

u8 side_of(double one, double other, Combine combine, double zero) {
    if (std::abs(one) <= zero) one = 0;
    if (std::abs(other) <= zero) other = 0;
    const double value = combine == Combine::max ? std::max(one, other) : std::min(one, other);
    if (value != 0 || one == other) return value <= 0;
    return combine == Combine::max;
}

TetFunctions::TetFunctions(const PatchComplex& patches, u32 row) : own_(patches, row), combine_(patches.combine[row]) {
    const u32 partner = patches.partners[row];
    if (partner == PatchComplex::no_partner) return;
    other_.emplace(patches, partner);
    const auto& corners = patches.tets[partner];
    for (std::size_t i = 0; i < 4; ++i) order_[i] = std::ranges::find(corners, patches.tets[row][i]) - corners.begin();
}

Barycentric TetFunctions::in_other(const Barycentric& at) const {
    Barycentric there;
    for (std::size_t i = 0; i < 4; ++i) there[order_[i]] = at[static_cast<Eigen::Index>(i)];
    return there;
}

u8 TetFunctions::side_at(const Barycentric& base, double zero) const {
    const double value = patch_value(own_.weights(), base);
    return other_ ? side_of(value, patch_value(other_->weights(), in_other(base)), combine_, zero) : value <= zero;
}

TetFunctions::Hit TetFunctions::hit(u8 side, const Barycentric& base, const Barycentric& to, double zero) const {
    const double sign = side == 1 ? 1 : -1;
    double t = change_to(sign, patch_along(own_.weights(), base, to), zero);
    double lead = 0;
    if (other_) {
        const double there = change_to(sign, patch_along(other_->weights(), in_other(base), in_other(to)), zero);
        // The larger function is positive where one function is positive, and negative where both are.
        if (there != t) lead = (combine_ == Combine::max) == (side == 1) ? there - t : t - there;
        if (lead < 0) t = there;
    }
    const bool is_other = lead < 0;
    const bool is_missed = t == never;
    if (is_missed && !other_)
        throw Error("the patches have no surface on a line from the mesh to an apex")
            .hint("the weights are not those that 'a-patch' makes");
    if (is_missed) t = 1;
    const Barycentric at = (1 - t) * base + t * to;
    const Vec3 gradient = is_other ? other_->gradient(in_other(at)) : own_.gradient(at);
    return {{own_.point(at), gradient.normalized(), t == 0 ? u8(1) : side}, t == 0, is_other, lead, is_missed};
}

}  // namespace scanmill::tessellation
