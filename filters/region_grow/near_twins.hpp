// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Scans of one surface laid over each other: where every place has another one far nearer to it than all the rest,
/// once the surface has one of them, it has no use for the others.

#include "region_grow/neighbourhoods.hpp"

namespace scanmill::growing {

/// Per place how many of its nearest neighbours are its twins. A place seems to have twins when one to three neighbours
/// are nearer to it than 0.45 times the next. It lies among twins when most of it and its neighbours (14 of 17) seem to
/// have some. Where most of a place and its neighbours lie so, its twins are those that it seems to have, and all up to
/// 1.6 times the median of these distances round it, but at most half of the median distance of the next ones.
/// Elsewhere it has none: points may happen to be near each other, and bins that the surface cuts obliquely leave small
/// patches of them. Empty when nobody has any.
///
/// `facing`: the given normals, or empty. With them neighbours that do not face as the place does are none in all of
/// this: they are of the other side of something thin. The number is that of the nearest neighbours among which those
/// that face so are the twins. Cost: linear.
Array<u8> count_near_twins(const Samples& samples, const Neighbourhoods& neighbourhoods, std::span<const Vec3> facing,
                           unsigned threads);

}  // namespace scanmill::growing
