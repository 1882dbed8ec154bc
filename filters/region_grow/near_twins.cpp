// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/near_twins.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "scanmill/base/parallel.hpp"

namespace scanmill::growing {

namespace {

constexpr std::size_t most_twins = 3;
/// Of the distance to the nearest other place. Of points at random a quarter are as near to one of their nearest, of a
/// thinned scan's one in forty.
constexpr double near_share = 0.45;
/// Of a place and its neighbours, what makes most of them. Of the vertices where a surface leaves the cells of a grid,
/// as marching cubes and VRIP make them, patches of two thirds seem to have twins: of a dragon's 436,000 places that
/// would be 29,000; four fifths leave 800.
constexpr std::size_t part = 14, of_places = 17;
/// Of the median distance of twins: copies that were moved by up to some length lie at two thirds of it on average.
constexpr double twins_reach = 1.6;
/// Of the median distance of the next ones: what is nearer to those is none.
constexpr double nearer_than_others = 0.5;
constexpr std::size_t chunk = 1 << 12;

/// Where a place's twins end and the others begin; 0 where it has none.
struct Gap {
    double twins = 0, others = 0;
};

bool face_alike(std::span<const Vec3> facing, u32 a, u32 b) { return facing.empty() || facing[a].dot(facing[b]) > 0; }

Gap widest_gap(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> facing, u32 place) {
    Gap widest;
    double least = near_share, before = 0;
    std::size_t seen = 0;
    for (const u32 other : neighbourhoods.of(place)) {
        if (!face_alike(facing, place, other)) continue;
        const double distance = (samples.positions[other] - samples.positions[place]).norm();
        if (seen > 0 && before < least * distance) {
            least = before / distance;
            widest = {before, distance};
        }
        before = distance;
        if (++seen > most_twins) break;
    }
    return widest;
}

class Twins {
public:
    Twins(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> facing, unsigned threads)
        : samples_(samples),
          neighbourhoods_(neighbourhoods),
          facing_(facing),
          gaps_(samples.size()),
          counts_(samples.size()) {
        for_each_chunk(threads, gaps_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place)
                gaps_[place] = widest_gap(samples, neighbourhoods, facing, static_cast<u32>(place));
        });
        Array<u8> among_twins(counts_.size());
        for_each_chunk(threads, counts_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t place = begin; place < end; ++place)
                among_twins[place] = most(static_cast<u32>(place), [&](u32 other) { return gaps_[other].twins > 0; });
        });
        for_each_chunk(threads, counts_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            std::vector<Gap> room;
            for (std::size_t i = begin; i < end; ++i) {
                const u32 place = static_cast<u32>(i);
                const bool laid_over = most(place, [&](u32 other) { return among_twins[other] > 0; });
                counts_[i] = laid_over ? count(place, room) : u8(0);
            }
        });
    }
    Array<u8> counts() && { return std::move(counts_); }

private:
    /// Whether most of the place and its neighbours are such.
    template <class Such>
    bool most(u32 place, const Such& such) const {
        const auto near = neighbourhoods_.of(place);
        const auto number = static_cast<std::size_t>(std::ranges::count_if(near, such)) + (such(place) ? 1 : 0);
        return of_places * number >= part * (near.size() + 1);
    }

    u8 count(u32 place, std::vector<Gap>& gaps) const {
        const auto near = neighbourhoods_.of(place);
        gaps.clear();
        if (gaps_[place].twins > 0) gaps.push_back(gaps_[place]);
        for (u32 other : near)
            if (gaps_[other].twins > 0) gaps.push_back(gaps_[other]);
        if (gaps.empty()) return 0;
        const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
        std::ranges::nth_element(gaps, middle, {}, &Gap::twins);
        const double twins = middle->twins;
        std::ranges::nth_element(gaps, middle, {}, &Gap::others);
        const double radius =
            std::max(gaps_[place].twins, std::min(twins_reach * twins, nearer_than_others * middle->others));
        std::size_t number = 0;
        for (std::size_t i = 0; i < near.size(); ++i) {
            if ((samples_.positions[near[i]] - samples_.positions[place]).norm() > radius) break;
            if (face_alike(facing_, place, near[i])) number = i + 1;
        }
        return static_cast<u8>(number);
    }

    const Samples& samples_;
    const Neighbourhoods& neighbourhoods_;
    std::span<const Vec3> facing_;
    Array<Gap> gaps_;
    Array<u8> counts_;
};

}  // namespace

Array<u8> count_near_twins(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> facing,
                           unsigned threads) {
    Array<u8> counts = Twins(samples, neighbourhoods, facing, threads).counts();
    if (std::ranges::all_of(counts, [](u8 count) { return count == 0; })) return {};
    return counts;
}

}  // namespace scanmill::growing
