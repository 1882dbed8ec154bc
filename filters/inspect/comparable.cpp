// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspect/comparable.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::inspecting {

namespace {

/// Ratios of sizes within this share of the ratio of two units suggest these units.
constexpr double unit_tolerance = 0.05;
/// Shares of the points from which on a result is probably not what the user wants.
constexpr double doubtful_share = 0.5;
/// Largest share of the tolerance's width that an instrument's or a nominal's own error should have.
constexpr double largest_chord_share = 0.1;

/// In world coordinates.
std::string range_text(BoundingBox box, const Vec3& origin) {
    box = {box.low + origin, box.high + origin};
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", box.low.x(), box.low.y(), box.low.z(),
                       box.high.x(), box.high.y(), box.high.z());
}

/// "; the scan is 25.4 times as large …" if the sizes have the ratio of two units, else empty.
std::string unit_suspicion(const Extents& extents) {
    const double of_scan = extents.scan.diagonal(), of_nominal = extents.nominal.diagonal();
    if (!(of_scan > 0 && of_nominal > 0)) return "";
    const bool scan_is_larger = of_scan > of_nominal;
    const double ratio = scan_is_larger ? of_scan / of_nominal : of_nominal / of_scan;
    using enum LengthUnit;
    for (const auto& [larger, smaller] : {std::pair(centimetre, millimetre),
                                          {inch, millimetre},
                                          {metre, centimetre},
                                          {metre, millimetre},
                                          {millimetre, micrometre}})
        if (std::abs(ratio / in_unit(1, larger, smaller) - 1) <= unit_tolerance)
            return fmt::format("; the {} is {:.4g} times as large, as if it were in {} and the {} in {}",
                               scan_is_larger ? "scan" : "nominal", ratio, symbol(smaller),
                               scan_is_larger ? "nominal" : "scan", symbol(larger));
    return "";
}

/// The number of triangles whose corners another triangle has in the opposite order.
std::size_t reversed_twins(const TriangleMesh& surface) {
    Array<Triangle> all;
    for (Triangle corners : surface.triangles) {
        std::ranges::rotate(corners, std::ranges::min_element(corners));
        all.push_back(corners);
    }
    std::ranges::sort(all);
    std::size_t twins = 0;
    for (const auto& [a, b, c] : all) twins += b < c && std::ranges::binary_search(all, Triangle{a, c, b});
    return twins;
}

std::string amounts_text(const Inspection& inspected) {
    std::vector<std::string> amounts;
    const auto add = [&](std::size_t count, const std::string& what) {
        if (count > 0) amounts.push_back(fmt::format("{} {}", count, what));
    };
    add(inspected.too_far,
        fmt::format("farther than {:.4g} {} from the nominal", inspected.max_distance, symbol(inspected.unit)));
    add(inspected.beyond_border, "beyond its border");
    add(inspected.undecided, "where its triangles do not decide the sign");
    add(inspected.cut, "cut by sigma");
    return enumerated(amounts);
}

}  // namespace

void require_sound(const InspectParams& params) {
    if (params.tolerance.size() != 2)
        throw Error("tolerance has {}; it needs two", count_text(params.tolerance.size(), "length", "lengths"))
            .hint("give the lowest and the highest allowed deviation: tolerance: [-0.05 mm, 0.1 mm]");
    if (params.bins < 1)
        throw Error("bins is {}; the histogram needs at least 1", params.bins).hint("41 bins suit most scans");
    if (params.sigma && !(*params.sigma > 0))
        throw Error("sigma is {}; it must be above 0", number_text(*params.sigma))
            .hint("set sigma: 3, or none to count all points");
    for (const auto& [name, length] :
         {std::pair("label-distance", &params.label_distance), std::pair("chord-error", &params.chord_error)})
        if (!(length->amount() >= 0))
            throw Error("{} is {}; it must not be negative", name, length->text()).hint("0 u is the smallest value");
    if (params.max_distance && !(params.max_distance->amount() > 0))
        throw Error("max-distance is {}; it must be above 0", params.max_distance->text())
            .hint("give the largest distance at which a point can belong to the part, or auto");
}

void require_tolerance(const InspectParams& params, const Tolerance& tolerance, LengthUnit unit) {
    if (!(std::isfinite(tolerance.low) && std::isfinite(tolerance.high)))
        throw Error("the tolerance is {} to {}; both must be finite", params.tolerance[0].text(),
                    params.tolerance[1].text())
            .hint("give the lowest and the highest allowed deviation: tolerance: [-0.05 mm, 0.1 mm]");
    if (tolerance.low > tolerance.high)
        throw Error("the tolerance begins at {0} {2} and ends at {1} {2}, which is lower", number_text(tolerance.low),
                    number_text(tolerance.high), symbol(unit))
            .hint(fmt::format("the low end comes first: tolerance: [{1} {2}, {0} {2}]", number_text(tolerance.low),
                              number_text(tolerance.high), symbol(unit)));
}

void require_surface(const TriangleMesh& nominal) {
    if (nominal.triangles.empty())
        throw Error("the nominal has no triangles ({}); there is no surface to compare the scan with",
                    count_text(nominal.positions.size(), "vertex", "vertices"))
            .hint("the nominal is a mesh of the CAD model; `scanmill info` shows what a file contains");
    require_consistent(nominal);
    require_finite(nominal.positions.span(), "vertices of the nominal");
    for (const Triangle& triangle : nominal.triangles)
        if (area_vector(nominal.positions.span(), triangle).squaredNorm() > 0) return;
    throw Error("{} of the nominal has {} area; there is no surface to compare the scan with",
                nominal.triangles.size() == 1 ? "the only triangle"
                                              : fmt::format("none of the {} triangles", nominal.triangles.size()),
                by_count(nominal.triangles.size(), "no", "an"))
        .hint("`scanmill info` shows what a file contains");
}

double in_unit_of(const RigidTransform& transform, LengthUnit unit) {
    if (unit == LengthUnit::unknown || transform.unit == LengthUnit::unknown) return *transform.rms;
    return in_unit(*transform.rms, transform.unit, unit);
}

void refuse_without_points(const Inspection& inspected, const Extents& extents, const InspectParams& params) {
    std::string hint;
    const auto add = [&](const std::string& way_out) { hint += (hint.empty() ? "" : "; ") + way_out; };
    const std::string suspicion = unit_suspicion(extents);
    if (inspected.too_far > 0) {
        if (!suspicion.empty()) add("declare the unit of each file (`unit:` at the input or the scan)");
        add("move the scan into the frame of the nominal (align or pose files, then apply-transform), or set a larger "
            "max-distance");
    }
    if (inspected.beyond_border > 0) add("set borders: include to count points beyond the border");
    if (inspected.undecided > 0) add("mend the nominal's triangles with repair");
    if (inspected.cut > 0) add(fmt::format("set a sigma above {}, or none", number_text(params.sigma.value_or(0))));
    const std::string points =
        inspected.points == 1 ? "the only point cannot" : fmt::format("none of the {} points can", inspected.points);
    throw Error("{} be inspected: {}; the scan extends from {}, the nominal from {} ({}){}", points,
                amounts_text(inspected), range_text(extents.scan, extents.origin),
                range_text(extents.nominal, extents.origin), symbol(extents.unit),
                inspected.too_far > 0 ? suspicion : "")
        .hint(hint);
}

void doubt_nominal(const Nominal& nominal, Context& context) {
    const TriangleMesh& surface = nominal.surface();
    if (is_inside_out(surface))
        context.doubt(
            "the nominal is inside out: it is closed and its triangles face inwards, so every sign is reversed; "
            "reverse its triangles with repair");
    if (const std::size_t edges = topology(surface).misoriented_edges; edges > 0)
        context.doubt(
            fmt::format("the triangles of the nominal face different sides at {}, so the signs change there without "
                        "cause; orient them with repair",
                        count_text(edges, "edge", "edges")));
    if (const std::size_t pairs = reversed_twins(surface); pairs > 0)
        context.doubt(fmt::format(
            "{} in both orientations in the nominal, so the signs there depend on the order of the rows; keep the "
            "triangles of one side",
            count_text(pairs, "triangle is", "triangles are")));
}

void doubt_findings(const Inspection& inspected, const Extents& extents, Context& context) {
    const auto share = [&](std::size_t count) {
        return static_cast<double>(count) / static_cast<double>(inspected.points);
    };
    if (share(inspected.too_far) > doubtful_share)
        context.doubt(fmt::format("{} of {} points are farther than {:.4g} {} from the nominal and not counted{}",
                                  inspected.too_far, inspected.points, inspected.max_distance, symbol(inspected.unit),
                                  unit_suspicion(extents)));
    if (share(inspected.undecided) > doubtful_share)
        context.doubt(fmt::format("{} of {} points are nearest to edges whose triangles do not decide the sign",
                                  inspected.undecided, inspected.points));
}

void warn_of_chord_error(const Inspection& inspected, Context& context) {
    const double width = inspected.tolerance.high - inspected.tolerance.low;
    if (inspected.chord_error <= largest_chord_share * width) return;
    context.warn(fmt::format(
        "the nominal's chord error of {0} {2} is {3:.3g} % of the tolerance, which is {1} {2} wide; deviations up to "
        "the chord error are not the part's",
        number_text(inspected.chord_error), number_text(width), symbol(inspected.unit),
        width > 0 ? 100 * inspected.chord_error / width : std::numeric_limits<double>::infinity()));
}

}  // namespace scanmill::inspecting
