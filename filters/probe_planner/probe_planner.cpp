// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/probe_planner.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "probe_planner/contact_range.hpp"
#include "probe_planner/machine.hpp"
#include "probe_planner/reference_points.hpp"
#include "probe_planner/tour.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/dmis/header.hpp"
#include "scanmill/geometry/spatial/direction.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/io/mapped_file.hpp"

namespace scanmill {

namespace {

using namespace probing;

constexpr double pi = std::numbers::pi, degree = pi / 180;
/// Tolerance of limits for angles and cosines, so that rounding does not exclude axis-parallel approaches.
constexpr double rounding = 1e-9;
/// Number of positions of T to try for each touch.
constexpr int false_trials = 1000;

struct Settings {
    Probe probe;
    double error, spacing, retract;
    std::optional<double> approach;
    double least_cosine;  ///< cosine of the largest tilt
    bool two_directions;
    LineChoice lines;
};

double require_length(const char* name, const Length& length, bool may_be_zero) {
    const double value = length.value();
    if (!(may_be_zero ? value >= 0 : value > 0) || !std::isfinite(value))
        throw Error("{} must be {} 0; it is {} u", name, may_be_zero ? "at least" : "above", number_text(value))
            .hint(fmt::format("give a finite length {} 0", may_be_zero ? "of at least" : "above"));
    return value;
}

double length_or(const char* name, const std::optional<Length>& length, double otherwise, bool may_be_zero = false) {
    return length ? require_length(name, *length, may_be_zero) : otherwise;
}

Settings settings_of(const ProbePlannerParams& params) {
    Settings settings;
    Probe& probe = settings.probe;
    probe.radius = require_length("radius", params.radius, false);
    settings.error = require_length("scanner-error", params.scanner_error, true);
    if (!(settings.error < probe.radius))
        throw Error(
            "scanner-error is {} u and radius is {} u: unless the radius is larger, a face may be touched before the "
            "edge",
            number_text(settings.error), number_text(probe.radius))
            .hint("use a larger ball, or a finer scan and smaller voxels with a smaller scanner-error");
    probe.clearance = length_or("clearance", params.clearance, probe.radius, true);
    probe.stylus_radius = length_or("stylus-radius", params.stylus_radius, 0.6 * probe.radius);
    if (!(probe.stylus_radius < probe.radius))
        throw Error("stylus-radius is {} u and radius is {} u: the stylus must be thinner than the ball",
                    number_text(probe.stylus_radius), number_text(probe.radius))
            .hint("the default is 0.6 radius");
    probe.stylus_length = length_or("stylus-length", params.stylus_length, 20 * probe.radius);
    if (!(probe.stylus_length > probe.radius))
        throw Error("stylus-length is {} u and radius is {} u: the stylus ends inside the ball",
                    number_text(probe.stylus_length), number_text(probe.radius))
            .hint("stylus-length is measured from the ball's centre; the default is 20 radius");
    settings.spacing = require_length("spacing", params.spacing, false);
    settings.retract = length_or("retract", params.retract, 4 * probe.radius + settings.error + probe.clearance);
    if (params.approach) {
        settings.approach = params.approach->in_radians();
        if (!(std::abs(*settings.approach) <= pi / 2 + rounding))
            throw Error("approach must be from -90 to 90 deg; it is {}", params.approach->text())
                .hint("0 deg is the bisector of the faces; auto is the smallest safe angle of each touch");
    }
    const double tilt = params.max_tilt.in_radians();
    if (!(tilt >= 0 && tilt <= pi + rounding))
        throw Error("max-tilt must be from 0 to 180 deg; it is {}", params.max_tilt.text())
            .hint("90 deg, the default, excludes approaches from below; 180 deg allows all");
    settings.least_cosine = turn_of(std::min(tilt, pi)).cosine - rounding;
    probe.axis = direction_of(params.machine_axis, "machine-axis");
    if (params.directions != 1 && params.directions != 2)
        throw Error("directions must be 1 or 2; it is {}", params.directions)
            .hint("2 measures an edge across the approach, too");
    settings.two_directions = params.directions == 2;
    if (settings.two_directions && settings.approach)
        throw Error("`directions: 2` chooses two approaches, but `approach` gives one")
            .hint("leave out approach, or use directions: 1");
    using Features = ProbePlannerParams::Features;
    const auto takes = [&](Features kind) { return params.features == Features::all || params.features == kind; };
    settings.lines = {takes(Features::creases), takes(Features::holes), takes(Features::boundaries)};
    return settings;
}

DmisOptions dmis_options(const ProbePlannerParams& params, LengthUnit unit) {
    DmisOptions options;
    options.moves = params.dmis_goto;
    if (params.dmis_decimals) {
        if (*params.dmis_decimals > DmisOptions::most_decimals)
            throw Error("dmis-decimals must be from 0 to {}; it is {}", DmisOptions::most_decimals,
                        *params.dmis_decimals)
                .hint("auto keeps 1e-4 of the radius");
        options.decimals = *params.dmis_decimals;
    }
    if (params.dmis_header)
        with_file_name(*params.dmis_header, [&] {
            options.header = without_byte_order_mark(MappedFile(*params.dmis_header).bytes());
            dmis::require_header(options.header, unit);
        });
    return options;
}

/// Returns the mesh relative to the origin of the features.
TriangleMesh mesh_beside(const TriangleMesh& mesh, const Frame& frame) {
    require_triangles(mesh, "collisions need at least 1");
    TriangleMesh moved;
    moved.triangles = mesh.triangles;
    moved.positions = translated(mesh.positions, mesh.frame.origin - frame.origin);
    return moved;
}

/// Throws Error if the mesh is closed and encloses a negative volume.
void require_outward(const TriangleMesh& mesh) {
    const double volume = signed_volume(mesh.positions.span(), mesh.triangles.span()),
                 diagonal = surface_box(mesh).diagonal();
    if (volume >= -rounding * diagonal * diagonal * diagonal || !topology(mesh).closed) return;
    throw Error("the mesh is inside out: its volume is {:.4g} {}3, so that its convex edges count as concave", volume,
                symbol(mesh.frame.unit))
        .hint("`repair` turns a closed mesh outwards; find the features on its result");
}

/// Throws Error if every reference point is too far from the mesh to be touched.
void require_on_mesh(const ReferencePoints& references, const TriangleTree& mesh, const Settings& settings,
                     LengthUnit unit) {
    double least = std::numeric_limits<double>::infinity();
    for (const ReferencePoint& point : references.points) {
        const double distance = std::sqrt(mesh.nearest(point.position).squared_distance);
        if (distance <= settings.probe.radius + settings.error + 1.5 * point.segment_length) return;
        least = std::min(least, distance);
    }
    throw Error("the lines are not on the mesh: the nearest reference point is {:.4g} {} away from it", least,
                symbol(unit))
        .hint("wire the mesh on which the features were found, in the same position; `apply-transform` moves either");
}

/// Plans the touches of one reference point.
class TouchPlanner {
public:
    TouchPlanner(const Settings& settings, const Machine& machine, const ReferencePoint& reference, u32 number)
        : settings_(settings),
          machine_(machine),
          reference_(reference),
          edge_reach_(settings.error + std::min(1.5 * reference.segment_length, settings.probe.radius)),
          near_(settings.probe.radius + edge_reach_),
          beyond_(std::min(reference.beyond, settings.error)) {
        bisector_ = (reference.left_normal + reference.right_normal).normalized();
        across_ = reference.tangent.cross(bisector_);
        touch_.touch = number;
        touch_.feature = reference.line;
        touch_.position = touch_.start = touch_.centre = reference.position;
        touch_.tangent = reference.tangent;
        touch_.left_normal = reference.left_normal;
        touch_.right_normal = reference.right_normal;
        touch_.interior_angle = reference.interior_angle;
        touch_.assumed = reference.assumed;
    }

    /// Returns one touch, or two from different directions.
    std::vector<ProbeTouch> plan() {
        if (!(reference_.interior_angle < pi - rounding)) return refused(ProbeReason::concave);
        range_ = range_of_disc(reference_.interior_angle, settings_.probe.radius, settings_.error);
        if (reference_.assumed)
            known_range_ =
                range_on_left_face(reference_.interior_angle, settings_.probe.radius, settings_.error, beyond_);
        touch_.phi_min = range_.min;
        touch_.phi_max = range_.max;
        touch_.phi_known_min = known_range_.min;
        touch_.phi_known_max = known_range_.max;
        const std::vector<double> candidates = candidate_angles();
        if (candidates.empty() || !passes_hole(candidates.front())) return refused(ProbeReason::too_narrow);
        if (settings_.two_directions && !is_empty(range_))
            if (std::vector<ProbeTouch> two = two_directions(); !two.empty()) return two;

        ProbeReason reason = ProbeReason::too_tilted;
        for (const double phi : candidates) {
            if (!passes_hole(phi) || !is_tilted_little(phi)) continue;
            reason = ProbeReason::obstructed;
            if (const auto planned = touch_at(phi)) return {*planned};
        }
        return refused(reason);
    }

    /// Sets the touch's false share: the share of random positions of T for which the ball meets a face first. The
    /// positions are uniform in the disc of the scanner's error or on the left face.
    static void try_positions(const Settings& settings, const ReferencePoint& reference, ProbeTouch& touch,
                              Random random) {
        const EdgeFirst edge_first(touch.interior_angle, settings.probe.radius, touch.phi);
        const bool on_face = is_empty({touch.phi_min, touch.phi_max}) && touch.assumed;
        const Vec2 face = on_left_face(touch.interior_angle, 1);
        const double beyond = std::min(reference.beyond, settings.error);
        int missed = 0;
        for (int trial = 0; trial < false_trials; ++trial) {
            Vec2 position;
            if (on_face) {
                position = random.uniform(-beyond, settings.error) * face;
            } else {
                do position = Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
                while (position.squaredNorm() > 1);
                position *= settings.error;
            }
            missed += !edge_first(position);
        }
        touch.false_share = missed / static_cast<double>(false_trials);
    }

private:
    std::vector<ProbeTouch> refused(ProbeReason reason) {
        touch_.reason = reason;
        return {touch_};
    }

    /// Returns the angles to try, the best first: from the preferred angle outwards in steps of 1 degree.
    std::vector<double> candidate_angles() const {
        if (settings_.approach) return {*settings_.approach};
        const bool by_disc = !is_empty(range_);
        const AngleRange& range = by_disc ? range_ : known_range_;
        if (is_empty(range)) return {};
        const double middle = by_disc ? 0 : (range.min + range.max) / 2;
        std::vector<double> angles{middle};
        for (int step = 1; middle + step * degree <= range.max + rounding; ++step) {
            angles.push_back(std::min(middle + step * degree, range.max));
            angles.push_back(std::max(middle - step * degree, range.min));
        }
        return angles;
    }

    Vec3 direction(double phi) const {
        const Turn turn = turn_of(phi);
        return (turn.cosine * bisector_ - turn.sine * across_).normalized();
    }

    bool passes_hole(double phi) const {
        if (std::isnan(reference_.hole_radius)) return true;
        const double psi = (pi - reference_.interior_angle) / 2 - phi;
        return settings_.probe.radius * turn_of(psi).sine <= reference_.hole_radius * (1 + rounding);
    }
    bool is_tilted_little(double phi) const {
        return direction(phi).dot(settings_.probe.axis) >= settings_.least_cosine;
    }

    /// Plans a touch at the angle phi. Empty if the probe would meet the part elsewhere.
    std::optional<ProbeTouch> touch_at(double phi) const {
        const double r = settings_.probe.radius;
        ProbeTouch touch = touch_;
        touch.phi = phi;
        touch.approach = direction(phi);
        touch.centre = reference_.position + r * touch.approach;
        constexpr double least_cosine = 1.0 / 6;  // a start at most 6 h away
        const double distance = settings_.retract / std::max(turn_of(phi).cosine, least_cosine);
        if (!find_start(distance, touch)) return std::nullopt;
        const FirstContact first =
            machine_.first_contact(touch.position, touch.start, touch.approach, edge_reach_, r + settings_.error);
        const bool is_on_face = first.contact == ProbeContact::edge && rests_on_face(first.normal);
        touch.contact = is_on_face ? ProbeContact::elsewhere : first.contact;
        touch.contact_distance = first.distance;
        if (!settings_.approach && touch.contact != ProbeContact::edge) return std::nullopt;
        return touch;
    }

    /// Whether the ball rests on the left or right face, as it does where another part continues the face beyond the
    /// line. `normal` is the direction from the contact to the ball's centre.
    bool rests_on_face(const Vec3& normal) const {
        const double cosine_1 = 0.99984769515639127;
        return reference_.left_normal.dot(normal) > cosine_1 ||
               (!reference_.assumed && reference_.right_normal.dot(normal) > cosine_1);
    }

    bool find_start(double distance, ProbeTouch& touch) const {
        constexpr int most_steps = 8;
        for (int step = 0; step <= most_steps; ++step) {
            touch.start = touch.position + (distance + step * settings_.probe.radius) * touch.approach;
            if (!machine_.is_approach_free(touch.position, touch.start, touch.centre, near_)) return false;
            if (machine_.is_lift_free(touch.start)) return true;
        }
        return false;
    }

    std::vector<ProbeTouch> two_directions() const {
        constexpr double share = 0.9, most = 30 * degree, least_between = 10 * degree;
        const double phi = std::min(share * range_.max, most);
        if (2 * phi < least_between - rounding) return {};
        std::vector<ProbeTouch> touches;
        for (const double angle : {phi, -phi}) {
            if (!passes_hole(angle) || !is_tilted_little(angle)) return {};
            const auto touch = touch_at(angle);
            if (!touch) return {};
            touches.push_back(*touch);
        }
        return touches;
    }

    const Settings& settings_;
    const Machine& machine_;
    const ReferencePoint& reference_;
    const double edge_reach_;  ///< largest distance from T to the edge in the mesh
    const double near_, beyond_;
    Vec3 bisector_, across_;
    AngleRange range_, known_range_;
    ProbeTouch touch_;
};

void count(ProbePlannerResult& result, bool two_directions) {
    const std::vector<ProbeTouch>& touches = result.plan.touches;
    for (std::size_t row = 0; row < touches.size(); ++row) {
        const ProbeTouch& touch = touches[row];
        result.assumed += touch.assumed;
        switch (touch.reason) {
            case ProbeReason::none: break;
            case ProbeReason::concave: ++result.concave; break;
            case ProbeReason::too_narrow: ++result.too_narrow; break;
            case ProbeReason::too_tilted: ++result.too_tilted; break;
            case ProbeReason::obstructed: ++result.obstructed; break;
        }
        if (touch.reason != ProbeReason::none) {
            ++result.unreachable;
            continue;
        }
        const bool is_one_of_two = (row > 0 && touches[row - 1].touch == touch.touch) ||
                                   (row + 1 < touches.size() && touches[row + 1].touch == touch.touch);
        result.single += two_directions && !is_one_of_two;
        result.false_touches += static_cast<std::size_t>(std::lround(touch.false_share * false_trials));
        result.wrong_contacts += touch.contact != ProbeContact::edge;
    }
}

void report(const ProbePlannerResult& result, const Settings& settings, Context& context) {
    const std::size_t touches = result.plan.touches.size();
    context.metric("touches", static_cast<double>(touches));
    const std::pair<const char*, std::size_t> counts[] = {{"assumed", result.assumed},
                                                          {"unreachable", result.unreachable},
                                                          {"too-narrow", result.too_narrow},
                                                          {"concave", result.concave},
                                                          {"obstructed", result.obstructed},
                                                          {"too-tilted", result.too_tilted},
                                                          {"false-touches", result.false_touches},
                                                          {"wrong-contacts", result.wrong_contacts},
                                                          {"left-out-creases", result.left_out_creases},
                                                          {"paired-lines", result.paired_lines},
                                                          {"single", result.single}};
    for (const auto& [name, number] : counts) context.metric(name, static_cast<double>(number));
    context.metric("travel", result.travel, Unit::length);
    context.metric("edge-roughness", result.edge_roughness, Unit::length);
    if (result.edge_roughness > settings.error)
        context.warn(
            fmt::format("the edge roughness of the lines is {:.6g} u (95 % quantile), above scanner-error, {:.6g} u: "
                        "touches may miss edges; raise scanner-error, or scan more finely",
                        result.edge_roughness, settings.error));
    if (result.unreachable == touches)
        context.doubt(
            fmt::format("none of {} can be made: {} concave, {} too narrow, {} too tilted and {} obstructed; {}",
                        count_text(touches, "touch", "touches"), result.concave, result.too_narrow, result.too_tilted,
                        result.obstructed, way_out(result.plan.touches)));
}

}  // namespace

std::string way_out(std::span<const ProbeTouch> touches) {
    std::size_t concave = 0, unsafe = 0, holes = 0, tilted = 0, obstructed = 0;
    for (const ProbeTouch& touch : touches) switch (touch.reason) {
            case ProbeReason::none: break;
            case ProbeReason::concave: ++concave; break;
            case ProbeReason::too_narrow:
                ++(is_empty({touch.phi_min, touch.phi_max}) && is_empty({touch.phi_known_min, touch.phi_known_max})
                       ? unsafe
                       : holes);
                break;
            case ProbeReason::too_tilted: ++tilted; break;
            case ProbeReason::obstructed: ++obstructed; break;
        }
    const std::pair<std::size_t, const char*> ways[] = {
        {unsafe, "a larger ball, or a finer scan with a smaller scanner-error, leaves safe directions"},
        {holes, "a smaller ball passes the holes"},
        {tilted, "a larger max-tilt or another machine-axis permits more directions"},
        {obstructed,
         "a smaller ball, a thinner stylus or another machine-axis keeps clear of the part; on rough lines, a larger "
         "ball reaches more"},
        {concave, "no ball meets a concave edge; choose other features"}};
    return std::ranges::max_element(ways, {}, [](const auto& way) { return way.first; })->second;
}

ProbePlannerResult probe_planner(const FeatureGraph& features, const TriangleMesh& mesh,
                                 const ProbePlannerParams& params, Context& context) {
    const Settings settings = settings_of(params);
    require_same_frame(features.frame, "the features are", mesh.frame, "the mesh");
    DmisOptions dmis = dmis_options(params, features.frame.unit);
    const TriangleMesh part = mesh_beside(mesh, features.frame);
    require_outward(mesh);
    const Machine machine(part, settings.probe, context.threads());
    const ReferencePoints references = find_reference_points(features, settings.lines, settings.spacing, machine.mesh(),
                                                             settings.error, settings.probe.radius, context);
    require_on_mesh(references, machine.mesh(), settings, mesh.frame.unit);

    std::vector<std::vector<ProbeTouch>> planned(references.points.size());
    constexpr std::size_t chunk = 16;
    std::atomic<std::size_t> done = 0;
    for_each_chunk(context.threads(), planned.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            const ReferencePoint& reference = references.points[i];
            planned[i] = TouchPlanner(settings, machine, reference, static_cast<u32>(i)).plan();
            for (std::size_t j = 0; j < planned[i].size(); ++j)
                if (planned[i][j].reason == ProbeReason::none)
                    TouchPlanner::try_positions(settings, reference, planned[i][j], context.random().stream(2 * i + j));
        }
        context.progress(0.9 * static_cast<double>(done += end - begin) / static_cast<double>(planned.size()));
    });

    ProbePlannerResult result;
    ProbePlan& plan = result.plan;
    plan.frame = features.frame;
    if (plan.frame.name.empty()) plan.frame.name = mesh.frame.name;
    plan.radius = settings.probe.radius;
    plan.scanner_error = settings.error;
    plan.clearance = settings.probe.clearance;
    plan.stylus_radius = settings.probe.stylus_radius;
    plan.stylus_length = settings.probe.stylus_length;
    plan.machine_axis = settings.probe.axis;
    plan.dmis = std::move(dmis);
    std::vector<TouchLine> lines;
    for (const Chain& chain : references.chains) {
        TouchLine line{chain.closed, {}};
        for (u32 i = chain.begin; i < chain.end; ++i)
            for (const ProbeTouch& touch : planned[i]) {
                if (touch.reason == ProbeReason::none) line.rows.push_back(static_cast<u32>(plan.touches.size()));
                plan.touches.push_back(touch);
            }
        if (!line.rows.empty()) lines.push_back(std::move(line));
    }
    const std::vector<u32> tour = tour_over(lines, plan.touches, machine.home(), machine.diagonal(), context);
    result.travel = add_moves(plan, tour, machine, context);
    result.edge_roughness = references.edge_roughness;
    result.left_out_creases = references.left_out_creases;
    result.paired_lines = references.paired_lines;
    count(result, settings.two_directions);
    report(result, settings, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
