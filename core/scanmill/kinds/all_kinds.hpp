// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The list of kinds. A new kind adds one line; its header declares the kind's traits and registers it. Messages list
/// kinds in this order.

// clang-format off
#include "scanmill/kinds/points.hpp"
#include "scanmill/kinds/mesh.hpp"
#include "scanmill/kinds/tets.hpp"
#include "scanmill/kinds/features.hpp"
#include "scanmill/kinds/transform.hpp"
#include "scanmill/kinds/metrics.hpp"
// clang-format on
