// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The filter `test-draw`: a picture that tests can compute themselves.

#include "scanmill/data/picture.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct TestDrawParams {
    std::string caption = "Points";
    bool fails = false;
};

/// One row with a pixel per position; the red of pixel i is i modulo 256. Throws Error if `fails` is set.
Picture test_draw(const Buffer<Vec3>& positions, const TestDrawParams& params);

}  // namespace scanmill
