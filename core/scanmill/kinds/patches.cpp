// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `patches`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "points": [[0, 0, 0], …],
///      "tets": [{"vertices": [12, 0, 1, 30], "weights": [-0.02, …], "kind": "face", "side": 1, "patch": 0,
///                "edge": null, "combine": "none", "partner": null}, …]}
///
/// Points are world coordinates. The 20 weights c_ijkl are ordered by (i, j, k, l) falling lexicographically: 3000,
/// 2100, …, 0003. `kind` is face, edge, sharp or continuation; `side` is 1 outside the mesh and 0 inside; `patch` is
/// the row of the mesh's triangle, and `edge` the number of its edge, or null. `combine` is none where the tetrahedron
/// has one polynomial; where it has two, it is max or min, and `partner` is the row of `tets` with the same points and
/// the other polynomial, else null. `unit` and `frame` are null if unknown. Numbers are read back bit for bit.
#include "scanmill/data/patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

namespace {

// By PatchKind and by Combine.
constexpr std::array<std::string_view, 4> kind_names_of_tets{"face", "edge", "sharp", "continuation"};
constexpr std::array<std::string_view, 3> combine_names{"none", "max", "min"};

std::size_t number_of_patches(const PatchComplex& patches) {
    std::size_t most = 0;
    for (const u32 triangle : patches.triangles) most = std::max<std::size_t>(most, triangle + std::size_t(1));
    return most;
}

/// Throws Error unless the partner of `row` has the same points and the same rule, and is another row whose partner is
/// `row`; and unless there is one exactly where functions are combined.
void require_partner(const PatchComplex& patches, std::size_t row) {
    const u32 partner = patches.partners[row];
    if ((partner == PatchComplex::no_partner) != (patches.combine[row] == Combine::none))
        throw Error("tetrahedron {} has {}", row,
                    partner == PatchComplex::no_partner ? "no partner to combine with" : "a partner without 'combine'");
    if (partner == PatchComplex::no_partner) return;
    if (partner >= patches.tets.size())
        throw Error("tetrahedron {} has partner {}; there are {} tetrahedra", row, partner, patches.tets.size());
    if (partner == row || patches.partners[partner] != row)
        throw Error("tetrahedron {} has partner {}, which has another one", row, partner);
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

Json tet_json(const PatchComplex& patches, std::size_t row) {
    const u32 edge = patches.edges[row], partner = patches.partners[row];
    return {{"vertices", patches.tets[row]},
            {"weights", patches.weights[row]},
            {"kind", kind_names_of_tets[static_cast<std::size_t>(patches.kinds[row])]},
            {"side", patches.sides[row]},
            {"patch", patches.triangles[row]},
            {"edge", edge == PatchComplex::no_edge ? Json(nullptr) : Json(edge)},
            {"combine", combine_names[static_cast<std::size_t>(patches.combine[row])]},
            {"partner", partner == PatchComplex::no_partner ? Json(nullptr) : Json(partner)}};
}

u32 index_of(const Json& json, u64 below, const std::string& what) {
    if (!json.is_number_unsigned() || json.get<u64>() >= below)
        throw Error("{} is not a whole number from 0 to {}", what, below - 1);
    return json.get<u32>();
}

class PatchesReader {
public:
    PatchComplex read(const Json& document) {
        require_document(document, {"scanmill", "unit", "frame", "points", "tets"});
        PatchComplex patches;
        patches.frame.unit = unit_member(document);
        patches.frame.name = text_member(document, "frame", "the document");
        Array<Vec3> positions;
        for (const Json& point : list_member(document, "points", "the document"))
            positions.push_back(vector_of(point, fmt::format("point {}", positions.size())));
        patches.frame.origin = distant_origin(bounding_box(positions));
        for (Vec3& p : positions) p -= patches.frame.origin;
        points_ = positions.size();
        patches.positions = std::move(positions);
        const Json& tets = list_member(document, "tets", "the document");
        count_ = tets.size();
        for (const Json& tet : tets) read_tet(tet, fmt::format("tetrahedron {}", tets_.size()));
        patches.tets = std::move(tets_);
        patches.weights = std::move(weights_);
        patches.kinds = std::move(kinds_);
        patches.sides = std::move(sides_);
        patches.triangles = std::move(triangles_);
        patches.edges = std::move(edges_);
        patches.combine = std::move(combine_);
        patches.partners = std::move(partners_);
        for (std::size_t row = 0; row < count_; ++row) require_partner(patches, row);
        return patches;
    }

private:
    void read_tet(const Json& json, const std::string& place) {
        if (!json.is_object()) throw Error("{} is not an object", place);
        require_keys(json, place, {"vertices", "weights", "kind", "side", "patch", "edge", "combine", "partner"});
        const Json& vertices = list_member(json, "vertices", place);
        std::array<u32, 4> tet;
        if (vertices.size() != tet.size()) throw Error("{} has {} vertices; 4 are needed", place, vertices.size());
        for (std::size_t i = 0; i < tet.size(); ++i) tet[i] = index_of(vertices[i], points_, place + ": a vertex");
        require_four_points(tet, tets_.size());
        const std::vector<double> numbers =
            numbers_of(member(json, "weights"), PatchWeights().size(), place + ": 'weights'");
        PatchWeights weights;
        std::ranges::copy(numbers, weights.begin());
        const auto kind = name_member<PatchKind>(json, "kind", kind_names_of_tets, place);
        const auto combine = name_member<Combine>(json, "combine", combine_names, place);
        constexpr u64 most = PatchComplex::no_edge;
        const Json &edge = member(json, "edge"), &partner = member(json, "partner");
        tets_.push_back(tet);
        weights_.push_back(weights);
        kinds_.push_back(kind);
        sides_.push_back(static_cast<u8>(index_of(member(json, "side"), 2, place + ": 'side'")));
        triangles_.push_back(index_of(member(json, "patch"), most, place + ": 'patch'"));
        edges_.push_back(edge.is_null() ? PatchComplex::no_edge : index_of(edge, most, place + ": 'edge'"));
        combine_.push_back(combine);
        partners_.push_back(partner.is_null() ? PatchComplex::no_partner
                                              : index_of(partner, count_, place + ": 'partner'"));
    }

    template <class Enum, std::size_t count>
    static Enum name_member(const Json& json, const char* name, const std::array<std::string_view, count>& names,
                            const std::string& place) {
        const std::string text = text_member(json, name, place);
        const auto found = std::ranges::find(names, text);
        if (found == names.end())
            throw Error("{}: unknown {} '{}'; expected {}", place, name, text, fmt::join(names, ", "));
        return static_cast<Enum>(found - names.begin());
    }

    std::size_t points_ = 0, count_ = 0;
    Array<std::array<u32, 4>> tets_;
    Array<PatchWeights> weights_;
    Array<PatchKind> kinds_;
    Array<u8> sides_;
    Array<u32> triangles_, edges_, partners_;
    Array<Combine> combine_;
};

}  // namespace

template <>
struct KindTraits<PatchComplex> : FromPositions<PatchComplex> {
    static constexpr std::string_view name = "patches";
    static void visit(FieldVisitor& visitor, PatchComplex& patches) {
        visitor.frame("frame", patches.frame);
        visitor.positions("positions", patches.positions);
        visitor.plain("tets", patches.tets);
        // A gradient has no unit, so a value of the function is a length.
        constexpr std::size_t each = std::tuple_size_v<PatchWeights>;
        Buffer<double> weights(patches.weights.owner(), reinterpret_cast<const double*>(patches.weights.data()),
                               each * patches.weights.size());
        visitor.lengths("weights", weights, 1);
        patches.weights = Buffer<PatchWeights>(weights.owner(), reinterpret_cast<const PatchWeights*>(weights.data()),
                                               weights.size() / each);
        visitor.plain("kinds", patches.kinds);
        visitor.plain("sides", patches.sides);
        visitor.plain("triangles", patches.triangles);
        visitor.plain("edges", patches.edges);
        visitor.plain("combine", patches.combine);
        visitor.plain("partners", patches.partners);
    }
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
    static void to_json(const PatchComplex& patches, Json& document) {
        document = {{"scanmill", 1},
                    {"unit", unit_json(patches.frame.unit)},
                    {"frame", patches.frame.name.empty() ? Json(nullptr) : Json(patches.frame.name)},
                    {"points", Json::array()},
                    {"tets", Json::array()}};
        for (const Vec3& p : patches.positions) document["points"].push_back(json_of(Vec3(patches.frame.origin + p)));
        for (std::size_t row = 0; row < patches.tets.size(); ++row) document["tets"].push_back(tet_json(patches, row));
    }
    static PatchComplex from_json(const Json& document, const OnWarning&) { return PatchesReader().read(document); }
};

template Kind kind_of<PatchComplex>();

}  // namespace scanmill
