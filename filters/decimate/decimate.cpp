// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <chrono>

#include "decimate/removal.hpp"
#include "scanmill/base/parallel.hpp"

#include <atomic>
extern std::atomic<int> g_why[16];
namespace scanmill {

namespace {

using namespace decimating;

constexpr double infinite = std::numeric_limits<double>::infinity();

class Decimator {
public:
    Decimator(Surface& surface, const Limits& limits, u64 target, Context& context)
        : surface_(surface),
          limits_(limits),
          target_(target),
          context_(context),
          keys_(surface.mesh.vertices()),
          touched_(surface.mesh.vertices(), 0) {}

    std::size_t run() {
        Array<u32> all(surface_.mesh.vertices());
        for (u32 v = 0; v < all.size(); ++v) all[v] = v;
        update_keys(all);
        while (!is_enough()) {
            if (!round()) {
                const std::size_t flips = std::getenv("NOFLIP") ? 0 : flip_edges();
                if (flips > 0 && loops_++ < 20) {
                    std::cerr << "triangles " << surface_.mesh.triangles() << " flips " << flips << "\n";
                    Array<u32> left;
                    for (u32 v = 0; v < keys_.size(); ++v)
                        if (surface_.mesh.is_used(v)) left.push_back(v);
                    update_keys(left);
                    continue;
                }
                if (final_) break;
                final_ = true;
                Array<u32> left;
                for (u32 v = 0; v < keys_.size(); ++v)
                    if (surface_.mesh.is_used(v)) left.push_back(v);
                update_keys(left);
                int classes[4] = {}; for (u32 v : left) ++classes[int(surface_.original.vertex_class(v))];
                std::cerr << "left smooth " << classes[0] << " crease " << classes[1] << " corner " << classes[2] << " boundary " << classes[3] << "\n";
                for (auto& w : g_why) w = 0;
            }
        }
        std::cerr << "why holes " << g_why[0] << " line " << g_why[1] << " dp " << g_why[2] << " final " << g_why[3] << " fold " << g_why[4] << " intersect " << g_why[5] << "\n"; std::cerr << "rounds " << rounds_ << " plans " << plans_ << " removed " << removed_ << " conflicts " << conflicts_ << "\n";
        return removed_;
    }

private:
    bool is_enough() const { return surface_.mesh.triangles() <= target_; }

    void update_keys(std::span<const u32> vertices) {
        for_each_chunk(context_.threads(), vertices.size(), 1024, [&](std::size_t begin, std::size_t end) {
            Planner planner(surface_, limits_);
            for (std::size_t i = begin; i < end; ++i)
                keys_[vertices[i]] = static_cast<float>(planner.estimate(vertices[i]));
        });
    }

    /// False if nothing is left to try.
    bool round() {
        ++stamp_;
        context_.check_cancelled();
        candidates_.clear();
        for (u32 v = 0; v < keys_.size(); ++v)
            if (keys_[v] < infinite) candidates_.push_back({keys_[v], v});
        if (candidates_.empty()) return false;
        static const double share = std::getenv("SHARE") ? std::atof(std::getenv("SHARE")) : 0.125;
        const std::size_t most = std::min(candidates_.size(), std::max<std::size_t>(64, static_cast<std::size_t>(static_cast<double>(candidates_.size()) * share)));
        std::nth_element(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(most) - 1, candidates_.end());
        candidates_.resize(most);
        std::sort(candidates_.begin(), candidates_.end());
        picked_.clear();
        for (const auto& [key, v] : candidates_) {
            if (touched_[v] == stamp_) continue;
            bool is_free = true;
            surface_.mesh.ring(v, ring_);
            for (const u32 other : ring_) is_free = is_free && touched_[other] != stamp_;
            if (!is_free) continue;
            touched_[v] = stamp_;
            for (const u32 other : ring_) touched_[other] = stamp_;
            picked_.push_back(v);
        }
        std::sort(picked_.begin(), picked_.end());
        if (plans.size() < picked_.size()) plans.resize(picked_.size());
        for_each_chunk(context_.threads(), picked_.size(), 64, [&](std::size_t begin, std::size_t end) {
            Planner planner(surface_, limits_);
            for (std::size_t i = begin; i < end; ++i) planner.plan(picked_[i], plans[i]);
        });
        plans_ += picked_.size();
        Planner planner(surface_, limits_);
        Array<u32> changed;
        for (std::size_t i = 0; i < picked_.size(); ++i) {
            const u32 v = picked_[i];
            if (plans[i].is_possible && planner.intersects(plans[i], stamp_)) {
                ++conflicts_;
                continue;  // try again
            }
            keys_[v] = infinite;
            if (!plans[i].is_possible) continue;
            if (is_enough()) break;
            surface_.mesh.ring(v, ring_);
            changed.insert(changed.end(), ring_.begin(), ring_.end());
            surface_.apply(plans[i], stamp_);
            ++removed_;
            final_ = false;
        }
        surface_.tidy();
        update_keys(changed);
        ++rounds_;
        return true;
    }

    std::size_t flip_edges() {
        std::size_t flips = 0;
        const EditableMesh& mesh = surface_.mesh;
        std::vector<bool> tried(3 * mesh.rows(), false);
        std::vector<Removal> flip_plans;
        for (;;) {
            ++stamp_;
            std::vector<u32> picked;
            for (u32 h = 0; h < 3 * mesh.rows(); ++h) {
                if (tried[h] || mesh.is_empty(h / 3) || mesh.is_boundary(h) || mesh.opposite(h) < h) continue;
                const u32 a = mesh.start(h), b = mesh.end(h), c = mesh.apex(h), d = mesh.apex(mesh.opposite(h));
                if (touched_[a] == stamp_ || touched_[b] == stamp_ || touched_[c] == stamp_ || touched_[d] == stamp_) continue;
                tried[h] = true;
                if (is_feature(a, b)) continue;
                touched_[a] = touched_[b] = touched_[c] = touched_[d] = stamp_;
                picked.push_back(h);
            }
            if (picked.empty()) return flips;
            if (flip_plans.size() < picked.size()) flip_plans.resize(picked.size());
            for_each_chunk(context_.threads(), picked.size(), 64, [&](std::size_t begin, std::size_t end) {
                Planner planner(surface_, limits_);
                for (std::size_t i = begin; i < end; ++i) planner.plan_flip(picked[i], flip_plans[i]);
            });
            for (std::size_t i = 0; i < picked.size(); ++i) {
                if (!flip_plans[i].is_possible) continue;
                const u32 h = picked[i], o = mesh.opposite(h);
                surface_.apply_flip(h, flip_plans[i], stamp_);
                ++flips;
                for (const u32 x : {h, mesh.after(h), mesh.before(h), o, mesh.after(o), mesh.before(o)}) {
                    tried[x] = false;
                    if (!mesh.is_boundary(x)) tried[mesh.opposite(x)] = false;
                }
            }
        }
    }
    bool is_feature(u32 a, u32 b) const {
        const OriginalSurface& original = surface_.original;
        const auto leads = [&](u32 from, u32 to) {
            bool found = false;
            original.for_each_line(from, [&](u32, u32 next) {
                u32 last = from;
                while (!surface_.mesh.is_used(next)) {
                    const auto [one, other] = original.line_neighbours(next);
                    const u32 further = one == last ? other : one;
                    last = next;
                    next = further;
                }
                found = found || next == to;
            });
            return found;
        };
        return original.vertex_class(a) != VertexClass::smooth && original.vertex_class(b) != VertexClass::smooth && leads(a, b);
    }

    int loops_ = 0;
    Surface& surface_;
    const Limits& limits_;
    u64 target_;
    Context& context_;
    Array<float> keys_;
    Array<u32> touched_;
    u32 stamp_ = 0;
    std::vector<std::pair<float, u32>> candidates_;
    std::vector<u32> picked_, ring_;
    std::vector<Removal> plans;
    std::size_t removed_ = 0, rounds_ = 0, plans_ = 0, conflicts_ = 0;
    bool final_ = false;
};

}  // namespace

DecimateResult decimate(const TriangleMesh& mesh, const PointCloud* points, const DecimateParams& params,
                        Context& context) {
    using clock = std::chrono::steady_clock;
    auto t0 = clock::now();
    const auto lap = [&](const char* what) {
        auto t1 = clock::now();
        std::cerr << what << " " << std::chrono::duration<double>(t1 - t0).count() << "\n";
        t0 = t1;
    };
    Array<u32> opposite = half_edges::opposites(mesh);
    EditableMesh editable(mesh);
    lap("half-edges");
    const double reach = (std::getenv("REACH") ? std::atof(std::getenv("REACH")) : 4.0) * params.max_error.value();
    OriginalSurface original(mesh, opposite, {params.sharp_angle.in_radians(), params.corner_angle.in_radians(), reach},
                             context.threads());
    lap("classify");
    Surface surface(original, std::move(editable), mesh.positions.span(), {});
    lap("surface");
    Limits limits;
    const double rounding = 0x1p-46 * surface_box(mesh).diagonal();
    const double internal = std::getenv("INTERNAL") ? std::atof(std::getenv("INTERNAL")) : 1.0;
    limits.error.outside = (params.outside ? *params.outside : params.max_error).value() * internal + rounding;
    limits.error.inside = (params.inside ? *params.inside : params.max_error).value() * internal + rounding;
    limits.normal_cosine = std::cos(params.normal_deviation.in_radians()) - 1e-9;
    limits.angle_sine = std::sin(params.min_angle.in_radians());
    limits.max_valence = params.max_valence;
    Decimator decimator(surface, limits, params.target_triangles, context);
    DecimateResult result;
    result.removed = decimator.run();
    lap("remove");
    result.mesh.frame = mesh.frame;
    result.mesh.positions = mesh.positions;
    result.mesh.triangles = surface.mesh.compact_triangles();
    result.mesh = without_unused_vertices(result.mesh);
    (void)points;
    return result;
}

}  // namespace scanmill
