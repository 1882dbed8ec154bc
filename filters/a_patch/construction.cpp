// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/construction.hpp"

#include <algorithm>

#include "a_patch/refinement.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr int bisecting_rounds = 1;
constexpr double least_even_cosine = 0.5;  // between a triangle and its normals

void sort_unique(auto& list) {
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
}

}  // namespace

void Construction::prepare() {
    smooth_agreeing_edges(mesh_, repairs);
    replace_opposing(mesh_, repairs);
}

void Construction::run() {
    level_normals(mesh_);
    for (;; ++round_) {
        execution_.check_cancelled();
        build();
        Faults found = faults();
        if (!found.empty()) {
            repair(found);
            continue;
        }
        if (!repair_crossing()) break;
    }
    changed_.clear();
}

void Construction::build() {
    hull = make_hull(mesh_, params_.apex_factor, params_.split, execution_);
    weights = make_weights(hull, params_.curvature, execution_);
    doubtful_ = verdicts.doubtful_edges(weights.patches, execution_);
}

Construction::Faults Construction::faults() const {
    Faults found;
    for (const auto& edges : {doubtful_, hull.faults.inverted})
        for (const u32 e : edges) {
            const Edge edge = make_edge(hull.edges[e].a, hull.edges[e].b);
            found.edges.push_back(edge);
            if (hull.edges[e].is_sharp && !hull.edges[e].is_straight)
                found.creases.push_back(edge);
            else if (!hull.edges[e].is_sharp)
                found.curved.insert(found.curved.end(), {hull.edges[e].first, hull.edges[e].second});
        }
    if (round_ < bisecting_rounds)
        found.curved.insert(found.curved.end(), hull.faults.thin.begin(), hull.faults.thin.end());
    sort_unique(found.edges);
    sort_unique(found.creases);
    sort_unique(found.curved);
    return found;
}

void Construction::repair(const Faults& faults) {
    if (round_ < bisecting_rounds) {
        repairs.bisected += bisect_edges(mesh_, faults.creases);
        repairs.bisected += bisect(mesh_, faults.curved);
    } else {
        follow_mesh(mesh_, faults.edges, {}, repairs);
    }
    replace_opposing(mesh_, repairs);
    level_normals(mesh_);
}

std::vector<std::array<u32, 2>> Construction::crossing_pairs(const PatchComplex& patches) const {
    // Parts intersect where sheets are near, where apexes of neighbours lie beyond each other, at curved creases, and
    // where normals turn away from triangles.
    std::vector<bool> is_end(hull.positions.size(), false);
    std::vector<u32> suspects, beside_creases;
    for (const HullEdge& edge : hull.edges) {
        if (edge.second == HullEdge::none || edge.is_straight || !(may_cross(edge.a) || may_cross(edge.b))) continue;
        const bool is_flat = mesh_.is_flat(edge.first) || mesh_.is_flat(edge.second);
        if (is_flat || !hull.is_sound(edge, inside) || !hull.is_sound(edge, outside))
            is_end[edge.a] = is_end[edge.b] = true;
        else if (edge.is_continued())
            beside_creases.insert(beside_creases.end(), {edge.first, edge.second});
    }
    for (u32 f = 0; f < hull.faces.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 v = hull.triangles[f][i];
            const bool turns = hull.normals[f][i].dot(hull.faces[f].normal) < least_even_cosine;
            is_end[v] = is_end[v] || (may_cross(v) && (hull.faces[f].is_thin || turns));
        }
    for (u32 f = 0; f < hull.faces.size(); ++f)
        if (std::ranges::any_of(hull.triangles[f], [&](u32 v) { return is_end[v]; })) suspects.push_back(f);
    return crossing_triangles(patches, hull, suspects, beside_creases, execution_);
}

std::vector<u32> Construction::violating_triangles(const PatchComplex& patches) {
    std::vector<u32> found;
    for (const u32 e : verdicts.doubtful_edges(patches, execution_))
        found.insert(found.end(), {hull.edges[e].first, hull.edges[e].second});
    if (found.empty())
        for (const auto& pair : crossing_pairs(patches)) found.insert(found.end(), pair.begin(), pair.end());
    sort_unique(found);
    return found;
}

/// Adds flat triangles that intersect to `crossing`. Of two other triangles whose parts intersect, opens the curved
/// creases between them, or else makes the one flat whose normals deviate more from its plane. Returns whether the mesh
/// has changed.
bool Construction::repair_crossing() {
    const auto evenness = [&](u32 f) {
        double least = 1;
        for (const Vec3& n : hull.normals[f]) least = std::min(least, n.dot(hull.faces[f].normal));
        return least;
    };
    std::vector<Edge> creases;
    std::vector<u32> folded;
    std::vector<std::array<u32, 2>> flat;
    for (const auto& [f, g] : crossing_pairs(weights.patches)) {
        const std::size_t before = creases.size();
        for (const u32 e : hull.faces[f].edges)
            if (hull.edges[e].is_continued() && (f == g || hull.edges[e].first == g || hull.edges[e].second == g))
                creases.push_back(make_edge(hull.edges[e].a, hull.edges[e].b));
        if (creases.size() > before) continue;
        if (mesh_.is_flat(f) && mesh_.is_flat(g)) {
            flat.push_back({f, g});
            continue;
        }
        const bool is_first = mesh_.is_flat(g) || (!mesh_.is_flat(f) && evenness(f) <= evenness(g));
        folded.push_back(is_first ? f : g);
    }
    sort_unique(creases);
    sort_unique(folded);
    bool has_moved = false;
    for (const auto& pair : flat) {
        bool has_pair_moved = false;
        for (const u32 f : pair) has_pair_moved = move_back(mesh_, f) || has_pair_moved;
        if (!has_pair_moved) crossing.insert(crossing.end(), pair.begin(), pair.end());
        has_moved = has_moved || has_pair_moved;
    }
    sort_unique(crossing);
    if (creases.empty() && folded.empty() && !has_moved) return false;
    changed_.assign(hull.positions.size(), false);
    for (const auto& ends : creases)
        for (const u32 v : ends) changed_[v] = true;
    const auto set_changed = [&](u32 f) {
        for (const u32 v : hull.triangles[f]) changed_[v] = true;
    };
    std::ranges::for_each(folded, set_changed);
    for (const auto& pair : flat) std::ranges::for_each(pair, set_changed);
    follow_mesh(mesh_, creases, folded, repairs);
    if (has_moved) replace_opposing(mesh_, repairs);
    return true;
}

}  // namespace scanmill::a_patches
