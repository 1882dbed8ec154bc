// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/mesh_update.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>

#include "mesh_update/listed_changes.hpp"
#include "mesh_update/nested_context.hpp"
#include "mesh_update/rebuilt.hpp"
#include "mesh_update/replacement.hpp"
#include "mesh_update/resample.hpp"
#include "mesh_update/updated_mesh.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/distance/swept_distance.hpp"
#include "scanmill/geometry/mesh/handles.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

using namespace updating;

namespace {

/// Clouds whose loops come this near, in spacings, count as one.
constexpr double joining_distance = 2;
/// Largest share of a loop's points without an overlap facet.
constexpr double largest_hanging = 0.2;
/// Largest median distance of a loop's points from their overlap facets, in spacings of the cloud.
constexpr double largest_offset = 0.5;

/// Above this share of unused points, compared with the points of the clouds, a result is doubtful.
constexpr double most_unused = 0.05;
/// Handles are looked for up to this length, in spacings of the coarsest cloud, and up to this number.
constexpr double longest_handle = 8;
constexpr std::size_t most_handles = 16;
/// Above this share of the new surface farther than a spacing from everything that was given, a result is doubtful.
constexpr double most_far = 0.01;

/// The local rebuild splits long edges of facets this near to a border, in lengths of the longest edge that stays: the
/// collar and the guard are three such edges wide each.
constexpr double resampling_reach = 9;
/// A local rebuild may widen its collar by this factor.
constexpr double widest_collar = 2;

/// Clouds that are updated as one: usually a single cloud.
struct CloudGroup {
    std::vector<u32> numbers;  ///< numbers of its clouds, from 0
    Array<u32> rows;  ///< rows of its points among the points of all clouds
    Buffer<Vec3> positions;
    CloudSurface surface;
    std::vector<LoopOverlap> loops;  ///< overlaps of the used loops, in their order
    CloudAngles angles;
    double offset = 0;  ///< largest median distance of a loop's points from their overlap facets
};

void require_parameters(const MeshUpdateParams& params) {
    const auto require = [](bool is_right, const char* name, const auto& value, const char* range) {
        if (!is_right) throw Error("{} must be {}; it is {}", name, range, value).hint("the defaults suit most scans");
    };
    require(params.max_distance.amount() > 0, "max-distance", params.max_distance.amount(), "above 0");
    require(params.trim >= 0 && std::isfinite(params.trim), "trim", params.trim, "0 or more");
    require(params.density > 0 && std::isfinite(params.density), "density", params.density, "above 0");
    if (params.rebuild == MeshUpdateParams::Rebuild::local && params.noise != MeshUpdateParams::Noise::none)
        throw Error("noise: big-balls has no effect with rebuild: local").hint("use `rebuild: whole`, or noise: none");
    const double gap = params.angle_gap.in_degrees();
    require(gap >= 0 && gap <= 90, "angle-gap", gap, "from 0 to 90 degrees");
}

/// The name of the metric of item `number`, counted from 1.
std::string numbered(std::string_view name, std::size_t number) {
    return number == 1 ? std::string(name) : fmt::format("{}@{}", name, number);
}

/// Seconds since the last call.
class StopWatch {
public:
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last_).count();
        last_ = now;
        return seconds;
    }

private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

class Update {
public:
    Update(const TriangleMesh& given, std::span<const std::shared_ptr<const PointCloud>> clouds,
           const MeshUpdateParams& params, Context& context)
        : given_(given),
          clouds_(clouds),
          params_(params),
          context_(context) {}

    MeshUpdateResult run() {
        require_parameters(params_);
        require_inputs();
        Array<u32> opposites = closed_opposites(given_);
        double of_model = watch_.lap();
        reconstruct_clouds();
        context_.progress(0.2);
        context_.metric("boundary-seconds", watch_.lap(), Unit::seconds);
        double least = groups_[0].surface.spacing;
        for (const CloudGroup& group : groups_) least = std::min(least, group.surface.spacing);
        const double longest = params_.density * least;
        max_distance_ = resolved_max_distance(longest);
        FacetTree tree = facet_tree(given_, longest);
        find_far_clouds(tree);
        if (!result_.doubt.empty()) {
            segmentation_.of_facet.assign(given_.triangles.size(), Groups::overlap);
            context_.metric("model-seconds", of_model + watch_.lap(), Unit::seconds);
            keep({given_, std::move(opposites), std::move(tree)});
            report();
            return std::move(result_);
        }
        const Resampled resampled = resample(longest);
        result_.resampled = resampled.added;
        if (resampled.added > 0) opposites = half_edges::opposites(resampled.mesh);
        context_.check_cancelled();
        const Model model(resampled.mesh, std::move(opposites),
                          resampled.added > 0 ? facet_tree(resampled.mesh, longest) : std::move(tree));
        refuse_intersections(model);
        context_.progress(0.3);
        of_model += watch_.lap();
        context_.metric("model-seconds", of_model, Unit::seconds);
        find_overlaps(model);
        context_.metric("overlap-seconds", watch_.lap(), Unit::seconds);
        choose_groups(model);
        if (result_.doubt.empty()) discard_vertices(model);
        context_.progress(0.4);
        context_.metric("segmentation-seconds", watch_.lap(), Unit::seconds);
        result_.features = loops();
        if (result_.doubt.empty())
            rebuild(model);
        else
            keep(model);
        context_.metric("reconstruction-seconds", watch_.lap(), Unit::seconds);
        report();
        return std::move(result_);
    }

private:
    void require_inputs() {
        require_triangles(given_, "an update needs a closed model");
        if (clouds_.empty()) throw Error("an update needs at least one cloud; there are 0").hint("wire `points`");
        for (std::size_t i = 0; i < clouds_.size(); ++i) {
            const PointCloud& cloud = *clouds_[i];
            try {
                require_points(cloud, "an update needs a local scan");
                require_same_frame(given_.frame, "the model is", cloud.frame, "the cloud");
            } catch (Error& error) {
                if (clouds_.size() > 1) error.add_frame(fmt::format("in {}", name_of(i)));
                throw;
            }
        }
        for (const auto& cloud : clouds_) result_.added += cloud->size();
        require_points(given_.positions.size() + result_.added, "an update needs a model and a scan");
        std::vector<bool> is_used(given_.positions.size());
        for (const Triangle& t : given_.triangles)
            for (const u32 vertex : t) is_used[vertex] = true;
        result_.initial = static_cast<std::size_t>(std::ranges::count(is_used, true));
    }

    /// Edges of a CAD model are as long as its faces; once they are split, `longest` is the limit.
    double resolved_max_distance(double longest) const {
        const LengthScale scale{given_.frame.unit, [&] { return bounding_box(given_.positions.span()).diagonal(); },
                                [&] { return std::min(edge_spacing(given_), longest); }};
        return params_.max_distance.resolved(scale).value();
    }

    /// The local rebuild looks at facets near the clouds only. No point of a cloud that touches the model is farther
    /// from it than the diagonal of the cloud's box.
    FacetTree facet_tree(const TriangleMesh& mesh, double longest) const {
        if (params_.rebuild == MeshUpdateParams::Rebuild::whole) return {mesh, context_.threads()};
        std::vector<BoundingBox> boxes;
        for (const CloudGroup& group : groups_) {
            BoundingBox box = bounding_box(group.positions.span());
            const Vec3 margin =
                Vec3::Constant(box.diagonal() + max_distance_ + widest_collar * resampling_reach * longest);
            boxes.push_back({box.low - margin, box.high + margin});
        }
        const auto is_near = [&](const Triangle& t) {
            BoundingBox own;
            for (const u32 vertex : t) own.add(mesh.positions[vertex]);
            return std::ranges::any_of(boxes, [&](const BoundingBox& box) {
                return (own.low.array() <= box.high.array()).all() && (own.high.array() >= box.low.array()).all();
            });
        };
        Array<u32> facets;
        for (u32 facet = 0; facet < mesh.triangles.size(); ++facet)
            if (is_near(mesh.triangles[facet])) facets.push_back(facet);
        // Clouds far from the model are refused with their distance from it.
        if (facets.empty()) return {mesh, context_.threads()};
        return {mesh, std::move(facets), context_.threads()};
    }

    Resampled resample(double longest) {
        if (params_.rebuild == MeshUpdateParams::Rebuild::whole) return resampled(given_, longest, {}, context_);
        Array<Vec3> borders;
        for (const CloudGroup& group : groups_)
            for (const CloudLoop& loop : group.surface.loops)
                for (const u32 h : loop.half_edges)
                    borders.push_back(group.surface.mesh.positions[half_edges::start(group.surface.mesh, h)]);
        const TriangleTree tree = tree_of_points(borders, context_.threads());
        const auto is_near = [&](const std::array<Vec3, 3>& corners) {
            return is_nearer(tree, corners, resampling_reach * longest);
        };
        return resampled(given_, longest, is_near, context_);
    }

    /// The local rebuild makes no triangle that intersects another; the rest of the model is not looked at.
    void refuse_intersections(const Model& model) {
        if (params_.rebuild == MeshUpdateParams::Rebuild::local) return;
        const TriangleMesh& mesh = model.mesh;
        const SelfIntersections found =
            self_intersections(mesh.positions.span(), mesh.triangles.span(), model.tree.of_all(), context_, 1);
        if (found.count == 0) return;
        const u32 facet = found.pairs[0][0];
        throw Error("the model intersects itself: {} of triangles, the first at {}",
                    count_text(found.count, "pair", "pairs"),
                    position_text(mesh.positions[mesh.triangles[facet][0]], mesh.frame))
            .hint("tight-cocone or poisson makes a model without intersections from its points");
    }

    std::string name_of(std::size_t cloud) const {
        return clouds_.size() == 1 ? "the cloud" : fmt::format("cloud {} of {}", cloud + 1, clouds_.size());
    }
    std::string name_of(const CloudGroup& group) const {
        if (group.numbers.size() == 1) return name_of(group.numbers[0]);
        std::vector<std::string> numbers;
        for (const u32 number : group.numbers) numbers.push_back(std::to_string(number + 1));
        return fmt::format("clouds {} of {}", enumerated(numbers), clouds_.size());
    }

    /// Makes the surface of every cloud, and joins clouds whose loops come near each other.
    void reconstruct_clouds() {
        std::vector<CloudGroup> single;
        for (u32 i = 0; i < clouds_.size(); ++i) {
            const PointCloud& cloud = *clouds_[i];
            const Buffer<Vec3> moved = translated(cloud.positions, cloud.frame.origin - given_.frame.origin);
            CloudGroup group;
            group.numbers = {i};
            group.rows.resize(moved.size());
            std::iota(group.rows.begin(), group.rows.end(), static_cast<u32>(positions_.size()));
            group.positions = moved;
            positions_.insert(positions_.end(), moved.begin(), moved.end());
            group.surface = surface_of(group);
            single.push_back(std::move(group));
        }
        DisjointSets sets(single.size());
        for (u32 i = 0; i < single.size(); ++i)
            for (u32 j = i + 1; j < single.size(); ++j)
                if (come_near(single[i].surface, single[j].surface)) sets.unite(i, j);
        for (u32 i = 0; i < single.size(); ++i) {
            if (sets.find(i) != i) continue;
            CloudGroup group;
            for (u32 j = 0; j < single.size(); ++j)
                if (sets.find(j) == i) group.numbers.push_back(j);
            if (group.numbers.size() == 1) {
                groups_.push_back(std::move(single[i]));
                continue;
            }
            Array<Vec3> joined;
            for (const u32 number : group.numbers) {
                joined.insert(joined.end(), single[number].positions.begin(), single[number].positions.end());
                group.rows.insert(group.rows.end(), single[number].rows.begin(), single[number].rows.end());
            }
            group.positions = std::move(joined);
            group.surface = surface_of(group);
            groups_.push_back(std::move(group));
        }
    }

    CloudSurface surface_of(const CloudGroup& group) {
        const double done = static_cast<double>(group.numbers[0]) / static_cast<double>(clouds_.size());
        NestedContext nested(context_, 0.2 * done, 0.2 * (done + 1 / static_cast<double>(clouds_.size())));
        try {
            return cloud_surface(group.positions, given_.frame, nested);
        } catch (Error& error) {
            error.add_frame(fmt::format("in the surface of {}", name_of(group)));
            throw;
        }
    }

    bool come_near(const CloudSurface& one, const CloudSurface& other) const {
        const auto points = [](const CloudSurface& surface) {
            Array<Vec3> found;
            for (const CloudLoop& loop : surface.loops)
                for (const u32 h : loop.half_edges)
                    found.push_back(surface.mesh.positions[half_edges::start(surface.mesh, h)]);
            return found;
        };
        const PointTree tree(points(one), context_.threads());
        const double distance = joining_distance * std::max(one.spacing, other.spacing);
        NeighbourBuffer buffer;
        return std::ranges::any_of(points(other), [&](const Vec3& point) {
            return tree.nearest_to(point, 1, buffer)[0].squared < distance * distance;
        });
    }

    /// Keeps the first doubt.
    void doubt(std::string_view kind, const CloudGroup& group, const Vec3& position, const std::string& reason,
               std::string hint) {
        if (!result_.doubt.empty()) return;
        result_.doubt =
            fmt::format("{}: {}; {}, at {}", kind, name_of(group), reason, position_text(position, given_.frame));
        hint_ = std::move(hint);
    }

    void find_overlaps(const Model& model) {
        std::optional<CandidateFacets> candidates;
        if (params_.overlap == MeshUpdateParams::Overlap::candidates) candidates.emplace(model, context_.threads());
        for (CloudGroup& group : groups_) {
            std::vector<CloudLoop> used;
            for (CloudLoop& loop : group.surface.loops) {
                LoopOverlap overlap = overlap_of(model, group.surface, loop, max_distance_, context_);
                if (!lies_on_model(group, loop, overlap)) continue;
                if (candidates) candidates->add(group.surface, loop, max_distance_, overlap);
                used.push_back(std::move(loop));
                group.loops.push_back(std::move(overlap));
            }
            group.surface.ignored_loops += group.surface.loops.size() - used.size();
            group.surface.loops = std::move(used);
        }
    }

    /// Doubts clouds in another unit or position before the model is split for them, which could take minutes.
    void find_far_clouds(const FacetTree& tree) {
        u32 hint = NearestTriangle::none;
        for (CloudGroup& group : groups_)
            for (const CloudLoop& loop : group.surface.loops) {
                LoopOverlap overlap;
                overlap.edges.resize(loop.half_edges.size());
                for (const u32 h : loop.half_edges) {
                    const Vec3& point = group.surface.mesh.positions[half_edges::start(group.surface.mesh, h)];
                    const NearestTriangle nearest = tree.nearest(point, hint);
                    hint = nearest.slot;
                    add_distance(overlap, point, std::sqrt(nearest.squared_distance), max_distance_);
                }
                if (hangs(overlap)) lies_on_model(group, loop, overlap);
            }
    }

    static bool hangs(const LoopOverlap& overlap) {
        return static_cast<double>(overlap.hanging) > largest_hanging * static_cast<double>(overlap.edges.size());
    }

    /// Whether the loop is used. A border that does not lie on the model is a doubt; a hole is then ignored.
    bool lies_on_model(CloudGroup& group, const CloudLoop& loop, LoopOverlap& overlap) {
        const std::size_t points = overlap.edges.size();
        if (hangs(overlap)) {
            if (!loop.is_hole)
                doubt("hanging", group, overlap.farthest,
                      fmt::format("{} of {} points of a loop are farther than max-distance, {:.4g} {}, from the model, "
                                  "the farthest {:.4g}",
                                  overlap.hanging, points, max_distance_, symbol(given_.frame.unit),
                                  overlap.farthest_distance),
                      "check the unit, the frame and the registration of the cloud; the scan must overlap the "
                      "unchanged model along its whole border");
            return false;
        }
        const double offset = median(overlap.offsets);
        group.offset = std::max(group.offset, offset);
        const double allowed = largest_offset * group.surface.spacing;
        if (offset > allowed) {
            if (!loop.is_hole)
                doubt(
                    "registration", group, overlap.farthest,
                    fmt::format("the points of a loop are {:.4g} {} from the model on median, more than {:.4g}, half a "
                                "spacing of the cloud, the farthest {:.4g}",
                                offset, symbol(given_.frame.unit), allowed, overlap.farthest_distance),
                    "align the cloud with the model by icp, or smooth its noise first");
            return false;
        }
        return true;
    }

    void divide(const Model& model) {
        Array<u8> is_overlap(model.mesh.triangles.size(), u8(0));
        for (const CloudGroup& group : groups_)
            for (const LoopOverlap& loop : group.loops)
                for (const u32 facet : loop.facets) is_overlap[facet] = 1;
        segmentation_ = segmentation(model, is_overlap, context_);
    }

    /// Ignores holes at which the angles do not decide: pinholes of a noisy cloud rather than parts that were not
    /// scanned. Returns whether there was one.
    bool ignores_holes(const Model& model) {
        bool found = false;
        for (CloudGroup& group : groups_)
            for (std::size_t i = group.loops.size(); i-- > 0;) {
                if (!group.surface.loops[i].is_hole) continue;
                const CloudAngles angles =
                    mean_angles(model, segmentation_, group.surface, std::span(group.loops).subspan(i, 1), context_);
                if (!angles.undivided_loop && chosen_groups(angles, params_.angle_gap.in_radians()).ambiguity.empty())
                    continue;
                group.surface.loops.erase(group.surface.loops.begin() + static_cast<std::ptrdiff_t>(i));
                group.loops.erase(group.loops.begin() + static_cast<std::ptrdiff_t>(i));
                ++group.surface.ignored_loops;
                found = true;
            }
        return found;
    }

    void choose_groups(const Model& model) {
        divide(model);
        while (ignores_holes(model)) divide(model);
        result_.groups = segmentation_.count;
        is_replaced_.assign(segmentation_.count, false);
        std::vector<const CloudGroup*> keeper(segmentation_.count, nullptr);
        std::vector<const CloudGroup*> replacer(segmentation_.count, nullptr);
        std::vector<u32> fragments;
        for (CloudGroup& group : groups_) {
            if (group.loops.empty()) {
                doubt("hanging", group, group.positions[0],
                      fmt::format("none of the {} of its surface lies on the model",
                                  count_text(group.surface.ignored_loops, "border loop", "border loops")),
                      "remove outliers by outlier-removal; scan more densely where the part is thin; the scan must "
                      "overlap "
                      "the unchanged model along its whole border");
                continue;
            }
            group.angles = mean_angles(model, segmentation_, group.surface, group.loops, context_);
            if (group.angles.undivided_loop) {
                const CloudLoop& loop = group.surface.loops[*group.angles.undivided_loop];
                doubt("no separation", group, group.angles.undivided_at,
                      fmt::format("a loop of {} edges does not divide the model", loop.half_edges.size()),
                      "the border of the cloud must surround the change on the model; a scan on both sides of a handle "
                      "does not; for a narrow cloud, lower `density`");
            }
            const Choice choice = chosen_groups(group.angles, params_.angle_gap.in_radians());
            if (!choice.ambiguity.empty())
                doubt("ambiguous", group, loop_start(group, group.surface.loops[0]), choice.ambiguity,
                      "the scan must overlap the unchanged model by several spacings along its whole border");
            for (const GroupAngle& angle : group.angles.groups) {
                const bool is_chosen = std::ranges::binary_search(choice.replaced, angle.group);
                if (angle.share >= least_group_share)
                    (is_chosen ? replacer : keeper)[angle.group] = &group;
                else if (is_chosen)
                    fragments.push_back(angle.group);
                if (is_chosen) is_replaced_[angle.group] = true;
            }
        }
        for (const CloudGroup& group : groups_)
            for (const u32 beyond : groups_beyond_other_barriers(model, group, replacer)) {
                replacer[beyond] = &group;
                is_replaced_[beyond] = true;
            }
        // A fragment of one cloud may be a group of another.
        for (const u32 fragment : fragments)
            if (keeper[fragment]) is_replaced_[fragment] = replacer[fragment] != nullptr;
        for (std::size_t g = 0; g < segmentation_.count; ++g)
            if (keeper[g] && replacer[g])
                doubt("ambiguous", *replacer[g], loop_start(*replacer[g], replacer[g]->surface.loops[0]),
                      fmt::format("it replaces group {}, which {} leaves", g + 1, name_of(*keeper[g])),
                      "update with one of them, then with the other");
        result_.replaced = static_cast<std::size_t>(std::ranges::count(is_replaced_, true));
        for (const CloudGroup& group : groups_)
            for (const GroupAngle& angle : group.angles.groups)
                result_.angles.push_back(
                    {group.numbers[0] + 1, angle.group + 1, angle.mean, bool(is_replaced_[angle.group])});
        require_kept_groups(model);
        warn_of_kept_holes();
    }

    /// Groups on the side of the model that the cloud replaces, behind the barriers of other clouds. A cloud replaces
    /// all that its own barrier separates.
    std::vector<u32> groups_beyond_other_barriers(const Model& model, const CloudGroup& group,
                                                  std::span<const CloudGroup* const> replacer) const {
        if (groups_.size() == 1) return {};
        std::vector<bool> is_own(model.mesh.triangles.size());
        for (const LoopOverlap& loop : group.loops)
            for (const u32 facet : loop.facets) is_own[facet] = true;
        // Sets of groups and of the other clouds' overlap facets; facets follow the groups.
        const std::size_t groups = segmentation_.count;
        DisjointSets sets(groups + model.mesh.triangles.size());
        const auto number = [&](u32 facet) {
            const std::int32_t its = segmentation_.of_facet[facet];
            return static_cast<u32>(its == Groups::overlap ? groups + facet : static_cast<std::size_t>(its));
        };
        for (const CloudGroup& other : groups_)
            for (const LoopOverlap& loop : other.loops)
                for (const u32 facet : loop.facets)
                    for (u32 h = 3 * facet; h < 3 * facet + 3 && !is_own[facet]; ++h)
                        if (const u32 beside = model.opposite[h] / 3; !is_own[beside])
                            sets.unite(number(facet), number(beside));
        std::vector<u32> found;
        for (u32 g = 0; g < groups; ++g)
            for (u32 own = 0; own < groups && replacer[g] != &group; ++own)
                if (replacer[own] == &group && sets.find(g) == sets.find(own)) {
                    found.push_back(g);
                    break;
                }
        return found;
    }

    /// What no cloud shows is kept, also inside a cloud.
    void warn_of_kept_holes() {
        if (!result_.doubt.empty()) return;
        for (const CloudGroup& group : groups_)
            for (const CloudLoop& loop : group.surface.loops)
                if (loop.is_hole)
                    context_.warn(fmt::format("{} has a hole of {} edges at {}; the model is kept there",
                                              name_of(group), loop.half_edges.size(),
                                              position_text(loop_start(group, loop), given_.frame)));
    }

    /// Something must stay in every component of the model that loses a group.
    void require_kept_groups(const Model& model) {
        if (!result_.doubt.empty()) return;
        std::vector<bool> keeps(segmentation_.count, false);
        for (u32 g = 0; g < segmentation_.count; ++g)
            if (!is_replaced_[g]) keeps[segmentation_.component[g]] = true;
        for (u32 facet = 0; facet < segmentation_.of_facet.size(); ++facet) {
            const std::int32_t group = segmentation_.of_facet[facet];
            if (group == Groups::overlap || keeps[segmentation_.component[static_cast<std::size_t>(group)]]) continue;
            throw Error("the clouds replace all of the component of the model at {}",
                        position_text(model.corners(facet)[0], given_.frame))
                .hint("a scan of the whole object needs no model: use delaunay and tight-cocone");
        }
    }

    Vec3 loop_start(const CloudGroup& group, const CloudLoop& loop) const {
        return group.surface.mesh.positions[half_edges::start(group.surface.mesh, loop.half_edges[0])];
    }

    void discard_vertices(const Model& model) {
        const Array<u8> of_groups = vertices_of_groups(model, segmentation_, is_replaced_);
        discarded_ = of_groups;
        for (const CloudGroup& group : groups_) {
            const PointTree tree(group.positions.span(), context_.threads());
            std::vector<u32> overlap;
            for (const LoopOverlap& loop : group.loops)
                overlap.insert(overlap.end(), loop.facets.begin(), loop.facets.end());
            discard_under(model, overlap, group.surface, tree, params_.trim, of_groups, discarded_, context_);
        }
    }

    FeatureGraph loops() const {
        FeatureGraph graph;
        graph.frame = given_.frame;
        Array<Vec3> positions, left;
        Array<u32> vertices;
        for (const CloudGroup& group : groups_)
            for (const CloudLoop& loop : group.surface.loops) {
                const u32 begin = static_cast<u32>(vertices.size());
                for (const u32 h : loop.half_edges) {
                    vertices.push_back(static_cast<u32>(positions.size()));
                    positions.push_back(group.surface.mesh.positions[half_edges::start(group.surface.mesh, h)]);
                    left.push_back(area_vector(group.surface.mesh.positions.span(), group.surface.mesh.triangles[h / 3])
                                       .normalized());
                }
                graph.polylines.push_back({loop.is_hole ? FeatureType::hole : FeatureType::outer_boundary, true, begin,
                                           static_cast<u32>(vertices.size())});
            }
        graph.right_normals = Array<Vec3>(left.size(), Vec3::Zero());
        graph.left_normals = std::move(left);
        graph.positions = std::move(positions);
        graph.vertices = std::move(vertices);
        return graph;
    }

    void rebuild(const Model& model) {
        const std::size_t model_vertices = model.mesh.positions.size();
        std::vector<bool> is_used(model_vertices);
        for (const Triangle& t : model.mesh.triangles)
            for (const u32 vertex : t) is_used[vertex] = true;
        Array<u32> rows, discarded;
        for (u32 vertex = 0; vertex < model_vertices; ++vertex)
            if (is_used[vertex]) (discarded_[vertex] == 1 ? discarded : rows).push_back(vertex);
        result_.discarded = discarded.size();
        result_.kept = rows.size();
        if (rows.empty())
            throw Error("no vertex of the model is kept: {} are discarded", discarded.size())
                .hint("lower `trim`; a scan of the whole object needs no model: use delaunay and tight-cocone");
        Array<Vec3> all(model.mesh.positions.begin(), model.mesh.positions.end());
        all.insert(all.end(), positions_.begin(), positions_.end());
        for (std::size_t i = model_vertices; i < all.size(); ++i) rows.push_back(static_cast<u32>(i));
        find_expected_euler(model);
        const auto rebuilt_from = [&](const Array<u32>& chosen) {
            return params_.rebuild == MeshUpdateParams::Rebuild::whole
                       ? rebuild_whole(model, all, chosen, discarded, segmentation_, params_, context_)
                       : rebuild_around(model, all, chosen, discarded, segmentation_, parts(), params_, context_);
        };
        Rebuilt rebuilt = rebuilt_from(rows);
        if (euler_of_closed(rebuilt) < std::min(expected_euler_, sphere_euler_))
            if (const Array<u32> fewer = without_handles(rebuilt, rows, all, model_vertices);
                fewer.size() < rows.size())
                if (Rebuilt second = rebuilt_from(fewer); is_expected(euler_of_closed(second))) {
                    context_.warn(fmt::format(
                        "{} left out: otherwise the surface has a handle between them",
                        count_text(rows.size() - fewer.size(), "point of a cloud is", "points of the clouds are")));
                    rebuilt = std::move(second);
                }
        for (const std::string& warning : rebuilt.warnings) context_.warn(warning);
        context_.progress(0.9);
        result_.unused = result_.kept + result_.added - rebuilt.rows.size();
        const Difference changed = difference(model.mesh, rebuilt);
        result_.mesh = updated_mesh(model, clouds_, all, segmentation_, rebuilt, changed.is_new, context_);
        result_.updated = true;
        list_changes(model, rebuilt, changed, result_, context_);
        doubt_points(rebuilt, model_vertices);
        doubt_topology(rebuilt);
        doubt_distance(model, changed);
    }

    std::vector<CloudPart> parts() const {
        std::vector<CloudPart> parts;
        for (const CloudGroup& group : groups_) parts.push_back({group.loops, group.rows, group.surface.spacing});
        return parts;
    }

    void doubt_points(const Rebuilt& rebuilt, std::size_t model_vertices) {
        if (params_.noise == MeshUpdateParams::Noise::big_balls) return;  // leaves points out by design
        const auto first = std::ranges::lower_bound(rebuilt.rows, static_cast<u32>(model_vertices));
        const std::size_t used = static_cast<std::size_t>(rebuilt.rows.end() - first);
        const std::size_t distinct = PointTree(positions_, context_.threads()).positions().size();
        const std::size_t unused = distinct - std::min(distinct, used);
        if (static_cast<double>(unused) > most_unused * static_cast<double>(result_.added))
            context_.doubt(fmt::format("{} of {} points of the clouds are not on the surface: they are noisy, or not "
                                       "registered with the model",
                                       unused, result_.added),
                           "mesh");
    }

    /// The result is the rest of the model joined with the surfaces of the clouds. The surface of a noisy cloud has
    /// pinholes, and handles beside them; it may then also be a sphere with its loops cut out.
    void find_expected_euler(const Model& model) {
        expected_euler_ = sphere_euler_ =
            euler_of_rest(model, segmentation_, is_replaced_, result_.initial + result_.resampled);
        for (const CloudGroup& group : groups_) {
            const CloudEuler found = euler_of(group.surface);
            expected_euler_ += found.as_found;
            sphere_euler_ += group.surface.ignored_loops > 0 ? found.as_sphere : found.as_found;
        }
    }
    bool is_expected(long euler) const { return euler == expected_euler_ || euler == sphere_euler_; }
    /// Every edge of a closed mesh has two triangles.
    static long euler_of_closed(const Rebuilt& mesh) {
        return static_cast<long>(mesh.rows.size()) - static_cast<long>(mesh.triangles.size()) / 2;
    }

    /// The rows without the points of clouds on short loops round a handle. At sharp edges, tight cocone may join a few
    /// points into a handle of three or four edges.
    Array<u32> without_handles(const Rebuilt& rebuilt, const Array<u32>& rows, std::span<const Vec3> positions,
                               std::size_t model_vertices) {
        TriangleMesh mesh;
        Array<Vec3> placed;
        for (const u32 row : rebuilt.rows) placed.push_back(positions[row]);
        mesh.positions = std::move(placed);
        mesh.triangles = rebuilt.triangles;
        double spacing = 0;
        for (const CloudGroup& group : groups_) spacing = std::max(spacing, group.surface.spacing);
        std::vector<bool> is_on_handle(positions.size());
        for (const HandleLoop& loop : handle_loops(mesh, longest_handle * spacing, most_handles, context_))
            for (const u32 vertex : loop.vertices)
                if (rebuilt.rows[vertex] >= model_vertices) is_on_handle[rebuilt.rows[vertex]] = true;
        Array<u32> left;
        for (const u32 row : rows)
            if (!is_on_handle[row]) left.push_back(row);
        return left;
    }

    void doubt_topology(const Rebuilt& rebuilt) {
        const long found = euler_of_closed(rebuilt);
        if (!is_expected(found))
            context_.doubt(fmt::format("the result has the Euler characteristic {}; the rest of the model and the "
                                       "surfaces of the clouds give {}",
                                       found, sphere_euler_),
                           "mesh");
    }

    void doubt_distance(const Model& model, const Difference& changed) {
        std::vector<const CloudSurface*> surfaces;
        double spacing = 0;
        for (const CloudGroup& group : groups_) {
            surfaces.push_back(&group.surface);
            spacing = std::max(spacing, group.surface.spacing);
        }
        std::vector<u32> kept;
        for (const u32 facet : changed.old_facets)
            if (const std::int32_t group = segmentation_.of_facet[facet];
                group == Groups::overlap || !is_replaced_[static_cast<std::size_t>(group)])
                kept.push_back(facet);
        const double share = far_share(model, kept, surfaces, result_.mesh, changed.is_new, spacing, context_);
        context_.metric("far-surface", share, Unit::ratio);
        if (share > most_far)
            context_.doubt(fmt::format("{:.2g} % of the new surface is farther than {:.4g} {}, the spacing of the {}, "
                                       "from the clouds and from what was kept",
                                       100 * share, spacing, symbol(given_.frame.unit),
                                       groups_.size() == 1 ? "cloud" : "coarsest cloud"),
                           "mesh");
    }

    /// Returns the given model with the columns of an update.
    void keep(const Model& model) {
        if (params_.on_doubt == MeshUpdateParams::OnDoubt::fail)
            throw Error("{}", result_.doubt).hint(hint_ + "; `on-doubt: keep` returns the model unchanged");
        context_.warn(result_.doubt + "; the model is returned unchanged");
        const Array<u8> would_go = vertices_of_groups(model, segmentation_, is_replaced_);
        result_.mesh = kept_mesh(given_, model, segmentation_, would_go, context_);
        result_.kept = result_.initial;
        result_.added = result_.resampled = result_.replaced = 0;
    }

    void report() {
        const auto count = [&](std::string_view name, std::size_t value) {
            context_.metric(name, static_cast<double>(value));
        };
        count("updated", result_.updated ? 1 : 0);
        count("initial", result_.initial);
        count("resampled", result_.resampled);
        count("added", result_.added);
        count("discarded", result_.discarded);
        count("kept", result_.kept);
        count("unused-points", result_.unused);
        count("groups", result_.groups);
        count("replaced", result_.replaced);
        std::size_t loops = 0, ignored = 0, edges = 0, paper = 0;
        for (const CloudGroup& group : groups_) {
            loops += group.surface.loops.size();
            ignored += group.surface.ignored_loops;
            edges += group.surface.boundary_edges;
            paper += group.surface.paper_edges;
        }
        for (std::size_t i = 0; i < groups_.size(); ++i)
            context_.metric(numbered("border-offset", i + 1), groups_[i].offset, Unit::length);
        for (std::size_t i = 0; i < result_.angles.size(); ++i) {
            const MeshUpdateAngle& angle = result_.angles[i];
            context_.metric(numbered("mean-angle", i + 1), angle.mean, Unit::angle);
            context_.metric(numbered("angle-cloud", i + 1), angle.cloud);
            context_.metric(numbered("angle-group", i + 1), angle.group);
            context_.metric(numbered("angle-replaced", i + 1), angle.is_replaced ? 1 : 0, Unit::boolean);
        }
        for (std::size_t i = 0; i < result_.changes.size(); ++i) {
            const MeshChange& change = result_.changes[i];
            context_.metric(numbered("area", i + 1), change.area, Unit::area);
            context_.metric(numbered("volume-added", i + 1), change.volume_added, Unit::volume);
            context_.metric(numbered("volume-removed", i + 1), change.volume_removed, Unit::volume);
            context_.metric(numbered("deviation", i + 1), change.deviation, Unit::length);
            const Vec3 world = given_.frame.origin + change.position;
            context_.metric(numbered("deviation-x", i + 1), world.x(), Unit::length);
            context_.metric(numbered("deviation-y", i + 1), world.y(), Unit::length);
            context_.metric(numbered("deviation-z", i + 1), world.z(), Unit::length);
            context_.metric(numbered("change-cloud", i + 1), change.cloud);
        }
        if (result_.updated) count("remeshed", result_.remeshed);
        count("loops", loops);
        count("ignored-loops", ignored);
        count("boundary-edges", edges);
        count("paper-edges", paper);
    }

    const TriangleMesh& given_;
    std::span<const std::shared_ptr<const PointCloud>> clouds_;
    const MeshUpdateParams& params_;
    Context& context_;
    StopWatch watch_;
    Array<Vec3> positions_;  ///< points of all clouds, relative to the model's origin
    std::vector<CloudGroup> groups_;
    double max_distance_ = 0;
    long expected_euler_ = 0, sphere_euler_ = 0;
    Array<u8> discarded_;
    Groups segmentation_;
    std::vector<bool> is_replaced_;
    std::string hint_;
    MeshUpdateResult result_;
};

}  // namespace

MeshUpdateResult mesh_update(const TriangleMesh& model, std::span<const std::shared_ptr<const PointCloud>> clouds,
                             const MeshUpdateParams& params, Context& context) {
    return Update(model, clouds, params, context).run();
}

}  // namespace scanmill
