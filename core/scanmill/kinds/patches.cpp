// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `patches`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "points": [[0, 0, 0], …],
///      "tets": [{"vertices": [12, 0, 1, 30], "weights": [-0.02, …], "kind": "face", "side": 1, "patch": 0,
///                "edge": null, "combine": "none", "partner": null}, …]}
///
/// Points are world coordinates. The 20 weights c_ijkl are in descending lexicographic order of (i, j, k, l): 3000,
/// 2100, …, 0003. `kind` is face, edge, sharp or continuation. `side` is 1 outside the mesh and 0 inside. `patch` is
/// the row of the mesh's triangle; `edge` is the number of the mesh's edge, or null. For a tetrahedron with one
/// polynomial, `combine` is none and `partner` is null. For a tetrahedron with two, `combine` is max or min, and
/// `partner` is the row of `tets` with the same points and the other polynomial. `unit` and `frame` are null if
/// unknown. Numbers are read back bit for bit.
#include "scanmill/data/patches.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

std::size_t number_of_patches(const PatchComplex& patches) {
    std::size_t most = 0;
    for (const u32 triangle : patches.triangles) most = std::max<std::size_t>(most, triangle + std::size_t(1));
    return most;
}

/// Throws Error if `row` has a partner but no rule to combine functions, or a rule but no partner. Throws Error unless
/// the partner is another row with the same points, side and rule, and its partner is `row`.
void require_partner(const PatchComplex& patches, std::size_t row) {
    const u32 partner = patches.partners[row];
    if ((partner == PatchComplex::no_partner) != (patches.combine[row] == Combine::none))
        throw Error("tetrahedron {} has {}", row,
                    partner == PatchComplex::no_partner ? "no partner to combine with" : "a partner without 'combine'");
    if (partner == PatchComplex::no_partner) return;
    if (partner >= patches.tets.size())
        throw Error("tetrahedron {} has partner {}; there are {} tetrahedra", row, partner, patches.tets.size());
    if (partner == row || patches.partners[partner] != row)
        throw Error("tetrahedron {} has partner {}, which has another partner", row, partner);
    auto one = patches.tets[row], other = patches.tets[partner];
    std::ranges::sort(one);
    std::ranges::sort(other);
    if (one != other || patches.combine[row] != patches.combine[partner] ||
        patches.sides[row] != patches.sides[partner])
        throw Error("tetrahedron {} and its partner {} differ in their points, 'side' or 'combine'", row, partner);
}

/// Throws Error if a point occurs twice in a tetrahedron.
void require_four_points(const std::array<u32, 4>& tet, std::size_t row) {
    for (std::size_t i = 1; i < tet.size(); ++i)
        if (std::find(tet.begin(), tet.begin() + static_cast<std::ptrdiff_t>(i), tet[i]) !=
            tet.begin() + static_cast<std::ptrdiff_t>(i))
            throw Error("tetrahedron {} names point {} twice; its four points must differ", row, tet[i]);
}

/// Throws Error if arrays have different lengths, an index is out of range, or partners do not match.
void require_consistent(const PatchComplex& patches) {
    const std::size_t tets = patches.tets.size();
    if (patches.weights.size() != tets || patches.kinds.size() != tets || patches.sides.size() != tets ||
        patches.triangles.size() != tets || patches.edges.size() != tets || patches.combine.size() != tets ||
        patches.partners.size() != tets)
        throw Error("the patches' arrays do not have one row for each of the {} tetrahedra", tets);
    for (std::size_t row = 0; row < tets; ++row) {
        for (const u32 vertex : patches.tets[row])
            if (vertex >= patches.positions.size())
                throw Error("tetrahedron {} names point {}; there are {}", row, vertex, patches.positions.size());
        require_four_points(patches.tets[row], row);
        require_partner(patches, row);
    }
}

struct TetDocument {
    std::array<u32, 4> vertices{};
    PatchWeights weights{};
    PatchKind kind{};
    u8 side = 0;
    u32 patch = 0;
    u32 edge = PatchComplex::no_edge;
    Combine combine{};
    u32 partner = PatchComplex::no_partner;
};
constexpr auto fields(const TetDocument*) {
    using T = TetDocument;
    return std::tuple{
        field("vertices", &T::vertices, "Rows of the points."),
        field("weights", &T::weights,
              "c_ijkl, with (i, j, k, l) in descending lexicographic order: 3000, 2100, …, 0003."),
        field("kind", &T::kind),
        field("side", &T::side, "1 outside the mesh, 0 inside."),
        field("patch", &T::patch, "The row of the mesh's triangle."),
        field("edge", &T::edge, "The number of the mesh's edge; null if the tetrahedron is over a triangle.")
            .nullable(),
        field("combine", &T::combine, "How the function is combined with the partner's."),
        field("partner", &T::partner, "The row of the other tetrahedron with the same points; null if there is none.")
            .nullable()};
}

struct PatchesDocument {
    Frame frame;
    Array<Vec3> points;
    std::vector<TetDocument> tets;
};
constexpr auto fields(const PatchesDocument*) {
    using T = PatchesDocument;
    return std::tuple{field("frame", &T::frame).flat(), field("points", &T::points, "World coordinates."),
                      field("tets", &T::tets)};
}

template <class Member>
Buffer<Member> column(const std::vector<TetDocument>& tets, Member TetDocument::*member) {
    Array<Member> values;
    for (const TetDocument& tet : tets) values.push_back(tet.*member);
    return values;
}

}  // namespace

template <>
struct KindTraits<PatchComplex> : FromPositions<PatchComplex>, HasDocument<PatchComplex, PatchesDocument> {
    static constexpr std::string_view name = "patches";
    static std::vector<PropertySpec> property_specs() {
        return {{"tetrahedra", Unit::count, "Tetrahedra."}, {"patches", Unit::count, "Triangles of the mesh."}};
    }
    static std::vector<std::optional<double>> property_values(const PatchComplex& patches) {
        return {patches.tets.size(), number_of_patches(patches)};
    }
    static void require_usable(const PatchComplex& patches) {
        require_consistent(patches);
        if (patches.tets.empty()) throw Error("the result has no tetrahedra");
    }
    static constexpr std::string_view json_member = "tets";
    static PatchesDocument document(const PatchComplex& patches) {
        PatchesDocument document{patches.frame, {patches.positions.begin(), patches.positions.end()}, {}};
        for (std::size_t row = 0; row < patches.tets.size(); ++row)
            document.tets.push_back({patches.tets[row], patches.weights[row], patches.kinds[row], patches.sides[row],
                                     patches.triangles[row], patches.edges[row], patches.combine[row],
                                     patches.partners[row]});
        return document;
    }
    static PatchComplex object(const PatchesDocument& document) {
        const std::vector<TetDocument>& tets = document.tets;
        for (std::size_t row = 0; row < tets.size(); ++row)
            if (tets[row].side > 1)
                throw Error("the document: 'tets[{}].side' is {}; expected 0 or 1", row, tets[row].side);
        const PatchComplex patches{document.frame,
                                   document.points,
                                   column(tets, &TetDocument::vertices),
                                   column(tets, &TetDocument::weights),
                                   column(tets, &TetDocument::kind),
                                   column(tets, &TetDocument::side),
                                   column(tets, &TetDocument::patch),
                                   column(tets, &TetDocument::edge),
                                   column(tets, &TetDocument::combine),
                                   column(tets, &TetDocument::partner)};
        require_consistent(patches);
        return patches;
    }
};

template Kind kind_of<PatchComplex>();

}  // namespace scanmill
