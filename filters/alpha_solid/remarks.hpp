// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the user should know about an alpha-solid although it stands: a sentence for each, none for a clean one.

#include "alpha_solid/alpha_solid.hpp"

namespace scanmill::alpha {

/// Warns about: a given alpha whose solid is not valid, in one sentence with the nearest that works; points and cells
/// left out (points beyond the asked share are told with the alpha); and, of a valid or chosen alpha, a repaired or
/// hull solid and an ambiguous choice.
void remark(const AlphaSolidResult& result, const AlphaSolidParams& params, Context& context);

/// A radius of the interval near `alpha`, written in as few digits (at least 4) as still give one of it. Pre: least is
/// above 0, not above largest; alpha is outside of them.
std::string text_within(const AlphaInterval& interval, double alpha);

}  // namespace scanmill::alpha
