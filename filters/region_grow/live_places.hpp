// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The places that a triangle may still take: a search that grows cheaper as the surface closes over them.

#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// A tree over the places as they are numbered, which is along a curve through space. Places that are neither unused
/// nor of the front are forgotten when a search meets them; so none may come back while this is used.
class LivePlaces {
public:
    /// Cost: linear, 7 to 14 bytes per place.
    explicit LivePlaces(const Surface& surface);

    /// Appends the live places at a squared distance from `place` below `squared`, itself not among them, by number.
    void within(u32 place, double squared, std::vector<u32>& found);

private:
    static constexpr std::size_t leaf_size = 16;
    struct Node {
        Vec3 low, high;
        bool live;
    };

    void visit(std::size_t node, u32 place, double squared, std::vector<u32>& found);
    bool visit_leaf(std::size_t leaf, u32 place, double squared, std::vector<u32>& found) const;

    const Surface& surface_;
    /// Node i has the children 2 i + 1 and 2 i + 2; leaves come last.
    std::size_t leaves_;
    std::vector<Node> nodes_;
};

}  // namespace scanmill::growing
