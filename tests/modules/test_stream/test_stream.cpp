// SPDX-License-Identifier: GPL-3.0-or-later
#include "test_stream/test_stream.hpp"

#include <chrono>
#include <fstream>
#include <thread>

namespace scanmill {

namespace {

void begin(std::string_view how, std::size_t points, const TestStreamParams& params, Context& context) {
    if (!params.log.empty())
        std::ofstream(params.log, std::ios::app)
            << how << ' ' << (params.length ? params.length->text() : "auto") << ' ' << points << '\n';
    while (params.waits) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        context.check_cancelled();
    }
}

std::vector<u32> ends(std::size_t points) {
    if (points == 1) return {0};
    return {0, static_cast<u32>(points - 1)};
}

}  // namespace

PointCloud test_stream(const PointCloud& cloud, const TestStreamParams& params, Context& context) {
    begin("whole", cloud.size(), params, context);
    return gather(cloud, ends(cloud.size()));
}

PointCloud test_stream(const PointStream& scan, const TestStreamParams& params, Context& context) {
    begin("stream", scan.size(), params, context);
    return scan.gather(ends(scan.size()), context.threads());
}

}  // namespace scanmill
