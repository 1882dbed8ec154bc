// SPDX-License-Identifier: GPL-3.0-or-later
// What a cache makes of scans that are streamed: they are known by the keys of scans that were read whole.
#include <gmock/gmock.h>

#include "engine/run/streamed_run_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using enum Origin;

TEST_F(StreamedRun, TheSameAgain_ComputesNothing) {
    const std::string file = written(folder_ / "a.ply", helix(1000));
    for (const bool first_whole : {false, true}) {
        use_cache(first_whole ? "whole-first" : "streamed-first");
        EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", file, first_whole)), ElementsAre(ran, ran));
        EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", file, !first_whole)), ElementsAre(cached, cached));
        EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", file, first_whole)), ElementsAre(cached, cached));
    }
}

TEST_F(StreamedRun, AnotherParameter_OpensTheScanAgain) {
    const std::string file = written(folder_ / "a.ply", helix(1000));
    run_thin("bin-size: 0.1 u", file);
    EXPECT_THAT(origins(run_thin("bin-size: 0.2 u", file)), ElementsAre(ran, ran));
}

TEST_F(StreamedRun, ValueThatWasKept_ChangesNothing) {
    const std::string file = scan("a.xyz");
    run("  - test-step:\n", {file});  // reads it whole, and keeps it
    EXPECT_THAT(origins(run_logging(file)), ElementsAre(cached, ran));
    EXPECT_EQ(logged(), "stream 0.03 u 4\n") << "as is said before anything runs";
}

TEST_F(StreamedRun, ValueThatWasKept_IsTakenWhereTheFileHasToBeReadWhole) {
    const std::string file = scan("a.xyz", small_scan + "1 2 nan\n");
    const std::string inputs = "{scan: {kind: points, invalid: drop}}";
    run("  - test-step:\n", {file}, "", inputs);
    EXPECT_THAT(origins(run("  - test-stream: {log: " + log() + "}\n", {file}, "", inputs)), ElementsAre(cached, ran));
    EXPECT_THAT(logged(), HasSubstr("whole"));
}

TEST_F(StreamedRun, OtherBytesOfTheSamePoints_AreCutOffBelow) {
    PointCloud cloud = without_columns(helix(1000));
    EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", written(folder_ / "a.ply", cloud))), ElementsAre(ran, ran));
    EXPECT_THAT(origins(run_thin("bin-size: 0.1 u", written(folder_ / "a.xyz", cloud))), ElementsAre(ran, same_inputs));
}

}  // namespace
}  // namespace scanmill::test
