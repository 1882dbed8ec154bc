// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What makes a view useless for registration.

#include <span>
#include <string_view>

#include "scanmill/data/frame.hpp"

namespace scanmill::registration {

/// Throws Error with the view's name for no points, fewer than 3 points, coordinates that are not finite (with the
/// first row), points that are all equal, and points on a line.
void require_surface(std::span<const Vec3> points, std::string_view name);

}  // namespace scanmill::registration
