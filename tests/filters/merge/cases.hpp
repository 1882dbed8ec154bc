// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the tests call merge.

#include "merge/merge.hpp"

namespace scanmill::test {

using Clouds = std::vector<PointCloud>;

struct Merged : MergeResult {
    std::vector<std::string> warnings;
    Metrics metrics;
    std::vector<Doubt> doubts;
};

inline Merged merged(const Clouds& clouds, const MergeParams& params = {}, unsigned threads = 1) {
    std::vector<std::shared_ptr<const PointCloud>> inputs;
    for (const PointCloud& cloud : clouds) inputs.push_back(std::make_shared<const PointCloud>(cloud));
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    MergeResult result = merge(inputs, params, context);
    return {std::move(result), context.warnings(), context.metrics(), context.doubts()};
}

inline MergeParams within(double distance, MergeParams::Prefer prefer = MergeParams::Prefer::none) {
    MergeParams params;
    params.within = distance;
    params.prefer = prefer;
    return params;
}

inline MergeParams posed(std::vector<RigidTransform> poses) {
    MergeParams params;
    params.poses = std::move(poses);
    return params;
}

inline PointCloud with_uncertainty(PointCloud cloud, Array<float> values) {
    cloud.columns.add(Column("uncertainty", 1, Buffer<float>(std::move(values))));
    return cloud;
}

}  // namespace scanmill::test
