// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A filter that can stream, for tests of what decides whether it does.

#include <filesystem>
#include <optional>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct TestStreamParams {
    /// Streams only when there is one.
    std::optional<Length> length;
    /// Does nothing, but may be in spacings.
    Length more;
    /// A file that every run appends a line to: "stream" or "whole", length, number of points.
    std::filesystem::path log;
    /// Goes on until it is cancelled.
    bool waits = false;
};

/// The first point and the last.
PointCloud test_stream(const PointCloud& cloud, const TestStreamParams& params, Context& context);
PointCloud test_stream(const PointStream& scan, const TestStreamParams& params, Context& context);

}  // namespace scanmill
