// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/registered_clouds.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "merge/scan_poses.hpp"
#include "register/misplaced_views.hpp"
#include "register/register_to_target.hpp"
#include "register/register_views.hpp"
#include "register/scanner_side.hpp"
#include "register/view_checks.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/spatial/unit_vectors.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

namespace {

using Views = std::span<const std::shared_ptr<const PointCloud>>;

constexpr std::size_t most_named = 5;  // views in a warning

/// The names in messages: those of the frames, else by number.
std::vector<std::string> names_of(Views views) {
    std::vector<std::string> names;
    std::map<std::string, std::size_t> first;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const std::string& name = views[i]->frame.name;
        names.push_back(name.empty() ? fmt::format("view {}", i + 1) : name);
        if (const auto [earlier, is_new] = first.emplace(names.back(), i); !is_new)
            throw Error("views {} and {} are both called '{}'", earlier->second + 1, i + 1, name)
                .hint("name frames after their files, `frame: \"{stem}\"`, and rename files of one name");
    }
    return names;
}

void require_one_unit(Views views, std::span<const std::string> names) {
    for (std::size_t i = 1; i < views.size(); ++i)
        if (views[i]->frame.unit != views[0]->frame.unit)
            throw Error("'{}' is in {} and '{}' in {}", names[0], symbol(views[0]->frame.unit), names[i],
                        symbol(views[i]->frame.unit))
                .hint("declare the units at the workflow's input, or convert the files first");
}

/// The sum of the directions in the column `approach`, else in `normal`; 0 without both.
Vec3 sum_of_directions(const PointCloud& view) {
    for (const char* column : {"approach", "normal"}) {
        Vec3 sum = Vec3::Zero();
        bool has_any = false;
        for (const Vec3& direction : unit_vectors(view.columns, column)) {
            sum += direction;
            has_any |= !direction.isZero(0);
        }
        if (has_any) return sum;
    }
    return Vec3::Zero();
}

/// The first view whose directions to the scanner nearly cancel each other.
std::optional<std::size_t> seen_from_all_sides(Views views) {
    constexpr double least_mean = 0.3;  // views have 0.5 and more, by their normals
    for (std::size_t i = 0; i < views.size(); ++i) {
        const bool has_column = views[i]->columns.find("approach") || views[i]->columns.find("normal");
        const double mean = sum_of_directions(*views[i]).norm() / static_cast<double>(views[i]->size());
        if (has_column && mean > 0 && mean < least_mean) return i;
    }
    return std::nullopt;
}

/// Unit vectors to the scanner: for each point the column `approach`, else `normal`, else +z with a warning.
Array<Vec3> directions_of(const PointCloud& cloud, const std::string& name, Context& context) {
    Array<Vec3> directions(cloud.size(), Vec3::Zero());
    for (const char* column : {"approach", "normal"}) {
        const Array<Vec3> given = unit_vectors(cloud.columns, column);
        for (std::size_t i = 0; i < given.size(); ++i)
            if (directions[i].isZero(0)) directions[i] = given[i];
    }
    const auto unknown = [](const Vec3& direction) { return direction.isZero(0); };
    if (const auto count = std::ranges::count_if(directions, unknown)) {
        context.warn(
            fmt::format("{} of {} points of {} have no direction in a column `approach` or `normal`: the scanner "
                        "is assumed on the side of +z",
                        count, directions.size(), name));
        std::ranges::replace_if(directions, unknown, Vec3(Vec3::UnitZ()));
    }
    return directions;
}

struct ViewsToRegister {
    std::vector<ViewToRegister> views;
    /// Names of the views whose scanner is assumed on the side of +z, or on a side found in their points.
    std::vector<std::string> assumed, estimated;
};

ViewsToRegister views_to_register(Views views, std::span<const std::string> names) {
    ViewsToRegister result;
    for (std::size_t i = 0; i < views.size(); ++i) {
        ViewToRegister view{names[i], views[i]->positions.span(), Vec3::UnitZ(), {}};
        const Vec3 direction = sum_of_directions(*views[i]);
        if (!direction.isZero(0)) {
            view.to_scanner = direction;
        } else {
            view.to_scanner = registration::scanner_side(view.points);
            (view.to_scanner == Vec3(Vec3::UnitZ()) ? result.assumed : result.estimated).push_back(names[i]);
        }
        result.views.push_back(view);
    }
    return result;
}

void warn_of_unknown_sides(const ViewsToRegister& views, Context& context) {
    const auto warn = [&](const std::vector<std::string>& which, const char* what) {
        if (which.empty()) return;
        context.warn(fmt::format(
            "{} without a column `approach` or `normal`: {} ({})", count_text(which.size(), "view is", "views are"),
            what, enumerated(std::span<const std::string>(which).first(std::min(which.size(), most_named)))));
    };
    warn(views.assumed, "the scanner is assumed on the side of +z");
    warn(views.estimated, "the side of the scanner is estimated, because +z would see much of the surface edge-on");
}

/// A motion of world coordinates as one of positions relative to the origins of the frames.
RigidMotion local(const RigidTransform& pose, const Vec3& origin, const Vec3& origin_after, LengthUnit unit) {
    return {pose.rotation, pose.rotation * origin + translation_in(unit, pose) - origin_after};
}

RigidTransform world(const RigidMotion& motion, const Vec3& origin, const Vec3& origin_after) {
    RigidTransform pose;
    pose.rotation = motion.rotation;
    pose.translation = origin_after + motion.translation - motion.rotation * origin;
    return pose;
}

std::vector<Frame> frames_of(Views views) {
    std::vector<Frame> frames;
    for (const auto& view : views) frames.push_back(view->frame);
    return frames;
}

std::vector<ScanPose> poses_in(const std::filesystem::path& file, Context& context) {
    return read_poses(file, [&](std::string sentence) { context.warn(std::move(sentence)); });
}

void report_counts(std::size_t views, std::size_t placed, Context& context) {
    context.metric("views", static_cast<double>(views));
    context.metric("placed", static_cast<double>(placed));
    context.metric("refused", static_cast<double>(views - placed));
}

RegisterViewsParams options_of(const RegisterParams& params) {
    RegisterViewsParams options;
    options.overlap = params.overlap.value();
    if (params.resolution) options.resolution = params.resolution->value();
    options.seed_tries = params.seed_tries;
    options.as_is = params.as_is;
    options.whole_views = params.whole_views;
    return options;
}

/// The motions of `params.poses`.
Transforms given_motions(Views views, const RegisterParams& params, Context& context) {
    if (params.start)
        throw Error("`poses` are taken as they are, so `start` has no use beside them").hint("give one of them");
    const std::vector<ScanPose> file = poses_in(*params.poses, context);
    const std::vector<std::optional<RigidTransform>> poses = merging::poses_of(frames_of(views), file, context);
    Transforms result;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const std::string& name = views[i]->frame.name;
        if (poses[i]) {
            result.motions.push_back(*poses[i]);
            result.motions.back().from = name;
        } else {
            const auto pose = std::ranges::find_if(file, [&](const ScanPose& each) { return is_of(each, name); });
            result.refused.push_back({name, *pose->refused});
        }
    }
    report_counts(views.size(), result.motions.size(), context);
    std::vector<std::string> refused;
    for (const RefusedFrame& each : result.refused) refused.push_back(fmt::format("'{}' ({})", each.from, each.reason));
    if (!refused.empty()) {
        const std::string sentence = fmt::format("the file of poses refuses {} of {}: {}", refused.size(),
                                                 count_text(views.size(), "view", "views"), fmt::join(refused, ", "));
        if (params.on_refusal == RegisterParams::OnRefusal::fail)
            throw Error("{}", sentence).hint("remove these views, or choose 'on-refusal: leave-out'");
        context.doubt(sentence);
    }
    return result;
}

/// Doubts poses of a file if single views fit the others better elsewhere. Views that cannot be registered are not
/// tested.
void test_motions(Views views, const Transforms& given, const RegisterParams& params, Context& context) {
    std::vector<std::shared_ptr<const PointCloud>> placed;
    for (const auto& view : views)
        if (std::ranges::find(given.motions, view->frame.name, &RigidTransform::from) != given.motions.end())
            placed.push_back(view);
    const auto has_unit_of_first = [&](const auto& view) { return view->frame.unit == placed[0]->frame.unit; };
    if (placed.size() < 3 || seen_from_all_sides(placed) || !std::ranges::all_of(placed, has_unit_of_first)) return;
    const std::vector<std::string> names = names_of(placed);
    ViewsToRegister to_test = views_to_register(placed, names);
    for (std::size_t i = 0; i < placed.size(); ++i)
        to_test.views[i].start =
            local(given.motions[i], placed[i]->frame.origin, placed[0]->frame.origin, placed[0]->frame.unit);
    const bool sides_are_known = to_test.assumed.empty() && to_test.estimated.empty();
    std::vector<std::string> misplaced;
    try {
        double spacing = 0;
        for (const auto& [view, distance] : misplaced_views(to_test.views, options_of(params), spacing, context))
            if (distance || sides_are_known)
                misplaced.push_back(
                    distance ? fmt::format("'{}' fits them {:.3g} {} ({:.1f} spacings) away from its pose", names[view],
                                           *distance, symbol(placed[0]->frame.unit), *distance / spacing)
                             : fmt::format("lines of sight contradict '{}'", names[view]));
    } catch (const Error&) {
        return;  // equal views, or views without a surface, cannot be tested
    }
    if (!misplaced.empty())
        context.doubt(fmt::format(
            "{} of {} {} not fit the others where the file of poses puts {}: {}; without `poses` "
            "the views are registered",
            misplaced.size(), count_text(names.size(), "view", "views"), by_count(misplaced.size(), "does", "do"),
            by_count(misplaced.size(), "it", "them"), fmt::join(misplaced, ", ")));
}

/// Every view stays where it is.
Transforms unmoved(Views views, Context& context) {
    Transforms result;
    for (const auto& view : views) {
        RigidTransform pose;
        pose.unit = view->frame.unit;
        pose.from = view->frame.name;
        pose.to = views[0]->frame.name;
        result.motions.push_back(pose);
    }
    report_counts(views.size(), views.size(), context);
    return result;
}

std::string reason_of(const RegisteredView& view, std::span<const std::string> names) {
    std::string text(name_of(view.refusal));
    if (view.best_with < names.size())
        text += fmt::format(": best with '{}', overlap {:.0f} %, in front {:.1f} %, missing {:.1f} %, slide {:.4f}",
                            names[view.best_with], 100 * view.best.overlap, 100 * view.best.front,
                            100 * view.best.missing, view.best.slide);
    if (view.refusal == ViewRefusal::slides)
        text += fmt::format(", like {}", view.best.free_directions == 1   ? "a body of revolution or an extrusion"
                                         : view.best.free_directions == 2 ? "a cylinder"
                                                                          : "a plane or a sphere");
    if (view.scale) text += fmt::format("; its size is {:.3g} times that of the others: {}?", *view.scale, view.units);
    return text;
}

void refuse(const RegisterViewsResult& found, std::span<const std::string> names, const RegisterParams& params,
            Context& context) {
    std::vector<std::string> reasons;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (!found.views[i].pose)
            reasons.push_back(fmt::format("'{}' ({})", names[i], reason_of(found.views[i], names)));
    if (reasons.empty()) return;
    const std::string sentence = fmt::format("{} of {} cannot be placed surely: {}", reasons.size(),
                                             count_text(names.size(), "view", "views"), fmt::join(reasons, ", "));
    if (params.on_refusal == RegisterParams::OnRefusal::fail || found.placed < 2)
        throw Error("{}", sentence)
            .hint(
                "add views that overlap with them, lower `overlap`, give poses with `start`, choose 'on-refusal: "
                "leave-out', or 'whole-views: false' if the scanner's field cuts views off");
    context.doubt(sentence);
}

/// A doubt that names the pairs that no other way from view to view confirms. Where missing points do not contradict a
/// pose, flat pieces of different faces can look alike.
void doubt_unconfirmed(const RegisterViewsResult& found, std::span<const std::string> names, Context& context) {
    std::vector<std::string> unconfirmed;
    for (const RegisteredPair& pair : found.pairs) {
        DisjointSets groups(names.size());
        for (const RegisteredPair& other : found.pairs)
            if (&other != &pair) groups.unite(other.from, other.to);
        if (groups.find(pair.from) != groups.find(pair.to))
            unconfirmed.push_back(fmt::format("'{}' with '{}'", names[pair.from], names[pair.to]));
    }
    if (!unconfirmed.empty())
        context.doubt(fmt::format("{} of views {} confirmed by no other views: {}; look at them",
                                  count_text(unconfirmed.size(), "pair", "pairs"),
                                  by_count(unconfirmed.size(), "is", "are"), fmt::join(unconfirmed, ", ")));
}

void report(const RegisterViewsResult& found, Context& context) {
    report_counts(found.views.size(), found.placed, context);
    context.metric("pairs", static_cast<double>(found.pairs.size()));
    for (std::size_t i = 0; i < found.views.size(); ++i) {
        const RegisteredView& view = found.views[i];
        const auto name = [&](std::string_view metric) {
            return i == 0 ? std::string(metric) : fmt::format("{}@{}", metric, i + 1);
        };
        if (!view.pose || found.kept_as_is) continue;
        context.metric(name("overlap"), view.overlap, Unit::ratio);
        context.metric(name("residual"), view.residual, Unit::length);
        context.metric(name("confidence"), view.confidence, Unit::number);
    }
    if (!found.kept_as_is) context.metric("rms", found.rms, Unit::length);
}

}  // namespace

Transforms registered_clouds(Views views, const RegisterParams& params, Context& context) {
    if (views.empty()) throw Error("needs views; there are none").hint("wire the scans: 'in: {points: views}'");
    if (params.poses) {
        Transforms given = given_motions(views, params, context);
        test_motions(views, given, params, context);
        return given;
    }
    if (views.size() == 1) return unmoved(views, context);
    const std::vector<std::string> names = names_of(views);
    require_one_unit(views, names);
    if (params.start && params.as_is)
        throw Error("`start` and `as-is` contradict each other: the poses come from the file, or are as they are")
            .hint("give one of them");
    if (const auto view = seen_from_all_sides(views)) {
        if (!params.as_is)
            throw Error("'{}' was scanned from several sides, so it is no view", names[*view])
                .hint("give the views of each position of the scanner, or place the whole scan with a `target`");
        context.warn(
            fmt::format("'{}' was scanned from several sides, so lines of sight cannot test the views; they stay "
                        "as they are",
                        names[*view]));
        return unmoved(views, context);
    }
    const LengthUnit unit = views[0]->frame.unit;
    const Vec3& origin = views[0]->frame.origin;
    ViewsToRegister to_register = views_to_register(views, names);
    warn_of_unknown_sides(to_register, context);
    std::vector<ViewToRegister>& inputs = to_register.views;
    if (params.start) {
        const std::vector<std::optional<RigidTransform>> poses =
            merging::poses_of(frames_of(views), poses_in(*params.start, context), context);
        for (std::size_t i = 0; i < views.size(); ++i)
            if (poses[i]) inputs[i].start = local(*poses[i], views[i]->frame.origin, origin, unit);
    } else if (params.as_is) {
        for (std::size_t i = 0; i < views.size(); ++i)
            inputs[i].start = RigidMotion{Eigen::Matrix3d::Identity(), views[i]->frame.origin - origin};
    }
    const RegisterViewsResult found = register_views(inputs, options_of(params), context);
    if (params.as_is && !found.kept_as_is)
        context.warn(
            found.contradicting
                ? fmt::format("'{}' and '{}' contradict each other as they are; the views are registered anew",
                              names[found.contradicting->first], names[found.contradicting->second])
                : "no pairs that determine the poses connect all views as they are; the views are registered anew");
    if (found.is_unconnected)
        context.doubt(fmt::format(
            "the {} overlap too little, or slide on each other, so their poses cannot be tested or found; they "
            "stay as they are",
            count_text(names.size(), "view", "views")));
    refuse(found, names, params, context);
    if (!params.whole_views && !found.kept_as_is) doubt_unconfirmed(found, names, context);

    const auto first =
        std::ranges::find_if(found.views, [](const RegisteredView& view) { return view.pose.has_value(); });
    const Frame& target = views[static_cast<std::size_t>(first - found.views.begin())]->frame;
    Transforms result;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const RegisteredView& view = found.views[i];
        const Frame& frame = views[i]->frame;
        if (!view.pose) {
            result.refused.push_back({names[i], reason_of(view, names)});
            continue;
        }
        RigidTransform pose =
            found.kept_as_is && !params.start ? RigidTransform() : world(*view.pose, frame.origin, target.origin);
        pose.unit = unit;
        pose.from = frame.name;
        pose.to = target.name;
        if (!found.kept_as_is) pose.rms = view.residual;
        result.motions.push_back(pose);
    }
    for (const RegisteredPair& pair : found.pairs) {
        const Frame &from = views[pair.from]->frame, &to = views[pair.to]->frame;
        PoseEdge edge{world(pair.motion, from.origin, to.origin),
                      pair.measures.overlap,
                      pair.measures.front,
                      pair.measures.missing,
                      pair.measures.slide,
                      pair.measures.score()};
        edge.pose.unit = unit;
        edge.pose.from = names[pair.from];
        edge.pose.to = names[pair.to];
        result.edges.push_back(edge);
    }
    report(found, context);
    return result;
}

namespace {

using SamplesOf = std::function<TargetSamples(double spacing)>;

Transforms placed_on(const SamplesOf& samples, const Frame& target, Views scans, const RegisterParams& params,
                     Context& context) {
    if (scans.size() != 1)
        throw Error("a target takes one scan; there are {}", scans.size())
            .hint("register the views first, merge them, and place the merged points on the target");
    const std::vector<std::string> names = names_of(scans);
    const Frame& frame = scans[0]->frame;
    if (frame.unit != target.unit)
        throw Error("'{}' is in {} and the target in {}", names[0], symbol(frame.unit), symbol(target.unit))
            .hint("declare the units at the workflow's inputs, or convert the files first");
    if (params.poses || params.as_is)
        throw Error("`poses` and `as-is` are for views without a target")
            .hint("`start` takes a file with a pose to begin with");
    const Array<Vec3> to_scanner = directions_of(*scans[0], fmt::format("'{}'", names[0]), context);
    ScanToPlace scan{names[0], scans[0]->positions.span(), to_scanner};
    if (params.start) {
        const auto poses = merging::poses_of(frames_of(scans), poses_in(*params.start, context), context);
        if (poses[0]) scan.start = local(*poses[0], frame.origin, target.origin, frame.unit);
    }
    const RegisterToTargetResult found = register_to_target(scan, samples, options_of(params), context);
    const std::string numbers = fmt::format(
        "{:.1f} % of the points fit, {:.1f} % in the next best pose, {:.1f} % of the target in front, slide {:.4f}",
        100 * found.fit, 100 * found.rival, 100 * found.front, found.slide);
    if (found.refusal != TargetRefusal::none)
        throw Error("'{}' cannot be placed surely on the target ({}): {}", names[0], name_of(found.refusal), numbers)
            .hint(found.refusal == TargetRefusal::ambiguous
                      ? "the part looks alike in several poses: `start` takes a file with a rough pose that decides, "
                        "`align` pairs of points"
                      : "scan more of the part, or start `icp` from a pose near the right one");
    RigidTransform pose = world(found.pose, frame.origin, target.origin);
    pose.unit = frame.unit;
    pose.from = frame.name;
    pose.to = target.name;
    report_counts(1, 1, context);
    context.metric("overlap", found.fit, Unit::ratio);
    context.metric("rival", found.rival, Unit::ratio);
    context.metric("confidence", found.confidence(), Unit::number);
    return pose;
}

}  // namespace

Transforms registered_to(const TriangleMesh& target, Views scans, const RegisterParams& params, Context& context) {
    return placed_on([&](double spacing) { return samples_of(target, spacing); }, target.frame, scans, params, context);
}

Transforms registered_to(const PointCloud& target, Views scans, const RegisterParams& params, Context& context) {
    registration::require_surface(target.positions.span(), "target");
    const Array<Vec3> to_scanner = directions_of(target, "the target", context);
    return placed_on([&](double spacing) { return samples_of(target.positions.span(), to_scanner, spacing); },
                     target.frame, scans, params, context);
}

}  // namespace scanmill
