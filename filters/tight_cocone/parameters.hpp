// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The declaration of tight-cocone's noise mode, for all filters that have it.

#include "scanmill/filter/declare.hpp"
#include "tight_cocone/tight_cocone.hpp"

namespace scanmill::tight_cocones {

/// Pre: Params is TightCoconeParams or derives from it.
template <class Params>
void declare_noise(Declare<Params>& declaration) {
    using P = TightCoconeParams;
    declaration
        .choice("noise", &P::noise,
                {{"none", P::Noise::none, "All points may be on the surface."},
                 {"big-balls", P::Noise::big_balls,
                  "Only the points on the outer side of a noisy sample, at large empty balls, are used. The result is "
                  "smoother, and lies outside of the surface by 0.4 to 1 standard deviations of the noise."}},
                "Treatment of noise.")
        .param("noise-neighbours", &P::noise_neighbours,
               "With big-balls: a ball is compared with the distance to the nearest neighbour of this number; the "
               "point itself is not counted.",
               at_least(1), at_most(1000))
        .param("noise-factor", &P::noise_factor,
               "With big-balls: a ball is large if its radius is more than this times that distance.", above(0));
}

}  // namespace scanmill::tight_cocones
