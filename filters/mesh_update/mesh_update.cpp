// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/mesh_update.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "mesh_update/changes.hpp"
#include "mesh_update/local_rebuild.hpp"
#include "mesh_update/replacement.hpp"
#include "mesh_update/resample.hpp"
#include "mesh_update/updated_mesh.hpp"
#include "mesh_update/whole_rebuild.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/distance/swept_distance.hpp"
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
/// Above this share of the new surface farther than a spacing from everything that was given, a result is doubtful.
constexpr double most_far = 0.03;

/// The local rebuild splits long edges of facets this near to a border, in lengths of the longest edge that stays: the
/// collar and the guard are three such edges wide each.
constexpr double resampling_reach = 9;

/// Clouds that are updated as one: usually a single cloud.
struct CloudGroup {
    std::vector<u32> numbers;  ///< of its clouds
    Array<u32> rows;  ///< of its points, among the points of all clouds
    Buffer<Vec3> positions;
    CloudSurface surface;
    std::vector<LoopOverlap> loops;  ///< of the loops of the surface that are used
    CloudAngles angles;
};

void require_parameters(const MeshUpdateParams& params) {
    const auto require = [](bool is_right, const char* name, const auto& value, const char* range) {
        if (!is_right) throw Error("{} must be {}; it is {}", name, range, value).hint("the defaults suit most scans");
    };
    require(params.max_distance.amount() > 0, "max-distance", params.max_distance.amount(), "above 0");
    require(params.trim >= 0 && std::isfinite(params.trim), "trim", params.trim, "0 or more");
    require(params.density > 0 && std::isfinite(params.density), "density", params.density, "above 0");
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
        reconstruct_clouds();
        context_.progress(0.2);
        context_.metric("boundary-seconds", watch_.lap(), Unit::seconds);
        Array<u32> opposites = closed_opposites(given_);
        double least = groups_[0].surface.spacing;
        for (const CloudGroup& group : groups_) least = std::min(least, group.surface.spacing);
        const Resampled resampled = resample(params_.density * least);
        result_.resampled = resampled.added;
        if (resampled.added > 0) opposites = half_edges::opposites(resampled.mesh);
        context_.check_cancelled();
        const Model model(resampled.mesh, std::move(opposites), context_.threads());
        max_distance_ =
            params_.max_distance
                .resolved({given_.frame.unit, [&] { return bounding_box(given_.positions.span()).diagonal(); },
                           [&] { return edge_spacing(resampled.mesh); }})
                .value();
        refuse_intersections(model);
        context_.progress(0.3);
        context_.metric("model-seconds", watch_.lap(), Unit::seconds);
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
        std::vector<bool> is_used(given_.positions.size());
        for (const Triangle& t : given_.triangles)
            for (const u32 vertex : t) is_used[vertex] = true;
        result_.initial = static_cast<std::size_t>(std::ranges::count(is_used, true));
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
            self_intersections(mesh.positions.span(), mesh.triangles.span(), model.tree, context_, 1);
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

    /// The positions of all clouds, one after another, relative to the model's origin.
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
        NestedContext nested(context_);
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
        for (CloudGroup& group : groups_) {
            std::vector<CloudLoop> used;
            for (CloudLoop& loop : group.surface.loops) {
                LoopOverlap overlap = overlap_of(model, group.surface, loop, max_distance_, context_);
                if (!lies_on_model(group, loop, overlap)) continue;
                if (params_.overlap == MeshUpdateParams::Overlap::candidates)
                    add_candidates(model, group.surface, loop, max_distance_, overlap, context_);
                used.push_back(std::move(loop));
                group.loops.push_back(std::move(overlap));
            }
            group.surface.ignored_loops += group.surface.loops.size() - used.size();
            group.surface.loops = std::move(used);
        }
    }

    /// Whether the loop is used; a loop that is no hole and does not lie on the model is a doubt.
    bool lies_on_model(const CloudGroup& group, const CloudLoop& loop, LoopOverlap& overlap) {
        const std::size_t points = overlap.edges.size();
        if (static_cast<double>(overlap.hanging) > largest_hanging * static_cast<double>(points)) {
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
        const double offset = median(overlap.offsets), allowed = largest_offset * group.surface.spacing;
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
        for (CloudGroup& group : groups_) {
            if (group.loops.empty()) {
                doubt("hanging", group, group.positions[0], "none of its loops lies on the model",
                      "the scan must overlap the unchanged model along its whole border");
                continue;
            }
            group.angles = mean_angles(model, segmentation_, group.surface, group.loops, context_);
            if (group.angles.undivided_loop) {
                const CloudLoop& loop = group.surface.loops[*group.angles.undivided_loop];
                doubt("no separation", group, loop_start(group, loop),
                      fmt::format("a loop of {} edges does not divide the model", loop.half_edges.size()),
                      "the border of the cloud must surround the change on the model; a scan on both sides of a handle "
                      "does not");
            }
            const Choice choice = chosen_groups(group.angles, params_.angle_gap.in_radians());
            if (!choice.ambiguity.empty())
                doubt("ambiguous", group, loop_start(group, group.surface.loops[0]), choice.ambiguity,
                      "the scan must overlap the unchanged model by several spacings along its whole border");
            for (const GroupAngle& angle : group.angles.groups) {
                // Fragments between two barriers belong to neither cloud.
                if (angle.share < least_group_share) continue;
                const bool is_chosen = std::ranges::binary_search(choice.replaced, angle.group);
                (is_chosen ? replacer : keeper)[angle.group] = &group;
                if (is_chosen) is_replaced_[angle.group] = true;
            }
        }
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
        require_kept_groups();
    }

    /// Something must stay in every component of the model that loses a group.
    void require_kept_groups() {
        if (!result_.doubt.empty()) return;
        for (u32 g = 0; g < segmentation_.count; ++g) {
            const auto same = [&](u32 other) { return segmentation_.component[other] == segmentation_.component[g]; };
            bool keeps = !is_replaced_[g];
            for (u32 other = 0; other < segmentation_.count; ++other) keeps |= same(other) && !is_replaced_[other];
            if (!keeps)
                throw Error("the clouds replace all {} of a component of the model",
                            count_text(segmentation_.count, "group", "groups"))
                    .hint("a scan of the whole object needs no model: use delaunay and tight-cocone");
        }
    }

    Vec3 loop_start(const CloudGroup& group, const CloudLoop& loop) const {
        return group.surface.mesh.positions[half_edges::start(group.surface.mesh, loop.half_edges[0])];
    }

    void discard_vertices(const Model& model) {
        discarded_ = vertices_of_groups(model, segmentation_, is_replaced_);
        for (const CloudGroup& group : groups_) {
            const PointTree tree(group.positions.span(), context_.threads());
            std::vector<u32> overlap;
            for (const LoopOverlap& loop : group.loops)
                overlap.insert(overlap.end(), loop.facets.begin(), loop.facets.end());
            discard_under(model, overlap, group.surface, tree, params_.trim, discarded_, context_);
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
        const bool is_local = params_.rebuild == MeshUpdateParams::Rebuild::local;
        Array<Vec3> all(model.mesh.positions.begin(), model.mesh.positions.end());
        all.insert(all.end(), positions_.begin(), positions_.end());
        for (u32 i = 0; i < positions_.size(); ++i) rows.push_back(static_cast<u32>(model_vertices + i));
        const Rebuilt rebuilt =
            is_local ? rebuild_local(model, rows, discarded)
                     : rebuild_whole(all, given_.frame, rows, model.mesh.triangles.size(), params_, context_);
        result_.unused = result_.kept + result_.added - rebuilt.rows.size();
        const Difference changed = difference(model.mesh, rebuilt);
        result_.mesh = updated_mesh(model, clouds_, all, segmentation_, rebuilt, changed.is_new, context_);
        result_.updated = true;
        list_changes(model, rebuilt, changed);
        doubt_result(model);
    }

    /// `rows`: of kept vertices and points, ascending.
    Rebuilt rebuild_local(const Model& model, std::span<const u32> rows, std::span<const u32> discarded) {
        const u32 model_vertices = static_cast<u32>(model.mesh.positions.size());
        const LocalRebuild part = rebuild_locally(model.mesh, model.opposite, model.tree, positions_,
                                                  local_changes(model), discarded, params_, context_);
        std::vector<u32> number(model_vertices + positions_.size(), half_edges::boundary);
        std::vector<bool> is_gone(number.size());
        for (const u32 vertex : part.dropped) is_gone[vertex] = true;
        std::vector<bool> is_point_used(positions_.size());
        for (const Triangle& t : part.triangles)
            for (const u32 vertex : t)
                if (vertex >= model_vertices) is_point_used[vertex - model_vertices] = true;
        Rebuilt rebuilt;
        for (const u32 row : rows) {
            if (is_gone[row] || (row >= model_vertices && !is_point_used[row - model_vertices])) continue;
            number[row] = static_cast<u32>(rebuilt.rows.size());
            rebuilt.rows.push_back(row);
        }
        const auto add = [&](const Triangle& t) {
            rebuilt.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
        };
        rebuilt.replaced.assign(part.replaced.begin(), part.replaced.end());
        rebuilt.triangles.reserve(model.mesh.triangles.size() - part.replaced.size() + part.triangles.size());
        auto replaced = part.replaced.begin();
        for (u32 facet = 0; facet < model.mesh.triangles.size(); ++facet)
            if (replaced != part.replaced.end() && *replaced == facet)
                ++replaced;
            else
                add(model.mesh.triangles[facet]);
        rebuilt.fixed = rebuilt.triangles.size();
        for (const Triangle& t : part.triangles) add(t);
        return rebuilt;
    }

    /// The facets that go, divided among the clouds: connected facets go together, and so do all those of a cloud.
    std::vector<LocalChange> local_changes(const Model& model) const {
        std::vector<u32> removed;
        std::vector<u8> is_removed(model.mesh.triangles.size(), u8(0));
        for (u32 facet = 0; facet < is_removed.size(); ++facet) {
            const Triangle& t = model.mesh.triangles[facet];
            if (segmentation_.of_facet[facet] != Groups::overlap &&
                discarded_[t[0]] + discarded_[t[1]] + discarded_[t[2]] == 0)
                continue;
            is_removed[facet] = 1;
            removed.push_back(facet);
        }
        DisjointSets facets(removed.size()), clouds(groups_.size());
        const auto index_of = [&](u32 facet) {
            return static_cast<u32>(std::ranges::lower_bound(removed, facet) - removed.begin());
        };
        for (u32 i = 0; i < removed.size(); ++i)
            for (u32 h = 3 * removed[i]; h < 3 * removed[i] + 3; ++h)
                if (const u32 beside = model.opposite[h] / 3; is_removed[beside] == 1)
                    facets.unite(i, index_of(beside));
        std::vector<u32> cloud_of(removed.size(), half_edges::boundary);
        for (u32 g = 0; g < groups_.size(); ++g)
            for (const LoopOverlap& loop : groups_[g].loops)
                for (const u32 facet : loop.facets) {
                    u32& cloud = cloud_of[facets.find(index_of(facet))];
                    if (cloud == half_edges::boundary)
                        cloud = g;
                    else
                        clouds.unite(cloud, g);
                }
        std::vector<LocalChange> changes(groups_.size());
        for (u32 i = 0; i < removed.size(); ++i)
            if (const u32 cloud = cloud_of[facets.find(i)]; cloud != half_edges::boundary)
                changes[clouds.find(cloud)].removed.push_back(removed[i]);
        for (u32 g = 0; g < groups_.size(); ++g) {
            LocalChange& change = changes[clouds.find(g)];
            change.points.insert(change.points.end(), groups_[g].rows.begin(), groups_[g].rows.end());
            change.spacing = std::max(change.spacing, groups_[g].surface.spacing);
        }
        std::erase_if(changes, [](const LocalChange& change) { return change.points.empty(); });
        return changes;
    }

    void list_changes(const Model& model, const Rebuilt& rebuilt, const Difference& difference) {
        const TriangleMesh& mesh = result_.mesh;
        const std::size_t model_vertices = model.mesh.positions.size();
        std::vector<Triangle> before, after;
        for (const u32 facet : difference.old_facets) before.push_back(model.mesh.triangles[facet]);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            if (difference.is_new[i] == 1) after.push_back(mesh.triangles[i]);
        std::vector<u32> common;
        for (const u32 row : rebuilt.rows) common.push_back(row < model_vertices ? row : no_common_vertex);
        const std::span<const u32> source = mesh.vertex_columns.find("source")->values<u32>();
        u32 hint = NearestTriangle::none;
        for (const Change& change : updating::changes({model.mesh.positions.span(), before},
                                                      {mesh.positions.span(), after}, common, context_)) {
            MeshChange listed;
            listed.volume_added = change.volume_added;
            listed.volume_removed = change.volume_removed;
            double squared = -1;
            for (const u32 triangle : change.new_triangles) {
                bool has_points = false;
                for (const u32 vertex : after[triangle]) {
                    if (common[vertex] != no_common_vertex) continue;
                    has_points = true;
                    const NearestTriangle nearest = model.tree.nearest(mesh.positions[vertex], hint);
                    hint = nearest.slot;
                    if (nearest.squared_distance <= squared) continue;
                    squared = nearest.squared_distance;
                    listed.position = mesh.positions[vertex];
                    listed.cloud = source[vertex];
                }
                if (has_points)
                    listed.area += area_vector(mesh.positions.span(), after[triangle]).norm() / 2;
                else
                    ++result_.remeshed;
            }
            listed.deviation = std::sqrt(std::max(squared, 0.0));
            if (listed.area > 0) result_.changes.push_back(listed);
        }
        doubt_distance(model, difference, after);
    }

    /// Doubts a result that is not the rest of the model joined with the surfaces of the clouds.
    void doubt_result(const Model& model) {
        if (static_cast<double>(result_.unused) > most_unused * static_cast<double>(result_.added))
            context_.doubt(fmt::format("{} kept vertices and points of the clouds are not on the surface: the clouds "
                                       "are noisy, or not registered with the model",
                                       result_.unused),
                           "mesh");
        // The surface of a noisy cloud has pinholes, and handles beside them; the rest of it is then taken for a
        // sphere.
        long expected = euler_of_rest(model, segmentation_, is_replaced_), without_handles = expected;
        for (const CloudGroup& group : groups_) {
            const CloudEuler found = euler_of(group.surface);
            expected += found.as_found;
            without_handles += group.surface.ignored_loops > 0 ? found.as_sphere : found.as_found;
        }
        // Every edge of a closed mesh has two triangles.
        const long found =
            static_cast<long>(result_.mesh.positions.size()) - static_cast<long>(result_.mesh.triangles.size()) / 2;
        if (found != expected && found != without_handles)
            context_.doubt(fmt::format("the result has the Euler characteristic {}; the rest of the model and the "
                                       "surfaces of the clouds give {}",
                                       found, without_handles),
                           "mesh");
    }

    /// Doubts new triangles away from everything that was given. `after`: the new triangles.
    void doubt_distance(const Model& model, const Difference& difference, std::span<const Triangle> after) {
        Array<Vec3> positions;
        Array<Triangle> given;
        double spacing = 0;
        for (const CloudGroup& group : groups_) {
            const u32 first = static_cast<u32>(positions.size());
            positions.insert(positions.end(), group.surface.mesh.positions.begin(), group.surface.mesh.positions.end());
            for (const Triangle& t : group.surface.mesh.triangles)
                given.push_back({first + t[0], first + t[1], first + t[2]});
            spacing = std::max(spacing, group.surface.spacing);
        }
        for (const u32 facet : difference.old_facets) {
            const std::int32_t group = segmentation_.of_facet[facet];
            if (group != Groups::overlap && is_replaced_[static_cast<std::size_t>(group)]) continue;
            const u32 first = static_cast<u32>(positions.size());
            for (const Vec3& corner : model.corners(facet)) positions.push_back(corner);
            given.push_back({first, first + 1, first + 2});
        }
        const TriangleTree tree(positions, given, context_.threads());
        const std::span<const Vec3> vertices = result_.mesh.positions.span();
        double far = 0, all = 0;
        u32 hint = NearestTriangle::none;
        for (const Triangle& t : after) {
            const Vec3 &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
            const double area = area_vector(a, b, c).norm() / 2;
            all += area;
            for (const Vec3& point : {Vec3((a + b + c) / 3), Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2)})
                if (!tree.is_within(point, spacing * spacing, hint)) {
                    far += area;
                    break;
                }
        }
        if (far > most_far * all)
            context_.doubt(
                fmt::format("{:.2g} % of the new surface is farther than {:.4g} {}, the spacing of the cloud, "
                            "from the surfaces of the clouds and from what was kept",
                            100 * far / all, spacing, symbol(given_.frame.unit)),
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
        result_.added = result_.resampled = 0;
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
    Array<Vec3> positions_;  ///< of all clouds, relative to the model's origin
    std::vector<CloudGroup> groups_;
    double max_distance_ = 0;
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
