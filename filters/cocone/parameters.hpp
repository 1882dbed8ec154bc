// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The declaration of cocone's parameters, for all filters that have them.

#include "cocone/cocone.hpp"
#include "scanmill/filter/declare.hpp"

namespace scanmill::cocones {

/// Pre: Params is CoconeParams or derives from it.
template <class Params>
void declare_parameters(Declare<Params>& declaration) {
    const auto field = [](auto CoconeParams::*member) {
        return static_cast<std::remove_reference_t<decltype(std::declval<Params&>().*member)> Params::*>(member);
    };
    declaration
        .param("cone-angle", field(&CoconeParams::cone_angle),
               "Half-opening of a point's cocone about the tangent plane. A wider one admits more candidates.",
               at_least(5), at_most(40))
        .param("prune-angle", field(&CoconeParams::prune_angle),
               "Triangles that meet with a larger angle between their normals do not continue each other.",
               at_least(90), at_most(170))
        .param("normal-angle", field(&CoconeParams::normal_angle),
               "A point is flat if the pole directions of its cocone neighbours differ from its own by at most this.",
               at_least(10), at_most(90))
        .param("ratio", field(&CoconeParams::ratio),
               "A point is flat if the distance to its nearer pole is at least this times the reach of its Voronoi "
               "cell in "
               "the tangent plane.",
               at_least(1))
        .param("gap-angle", field(&CoconeParams::gap_angle),
               "A point whose 16 nearest neighbours leave a wider gap in the tangent plane is a boundary point.",
               at_least(60), at_most(180))
        .param("lid-factor", field(&CoconeParams::lid_factor),
               "Triangles between boundary points with a longer edge span an opening and are left out; in mean "
               "distances to the six nearest neighbours.",
               above(0));
}

}  // namespace scanmill::cocones
