// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The number type of exact decisions: it holds every double and is closed under + − ×.

#include <CGAL/MP_Float.h>
#include <CGAL/Mpzf.h>

namespace scanmill::alpha {

// Mpzf is faster and needs GMP.
#ifdef CGAL_HAS_MPZF
using Exact = CGAL::Mpzf;
#else
using Exact = CGAL::MP_Float;
#endif

}  // namespace scanmill::alpha
