// SPDX-License-Identifier: GPL-3.0-or-later
// The tests' own filter that streams, called as the engine calls it: through its module.

#include <gtest/gtest.h>

#include "scanmill/formats/files.hpp"
#include "scanmill/plugin/library.hpp"
#include "support/folders.hpp"
#include "support/same_points.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

const PointCloud& points(const Outputs& outputs) { return *outputs.find("points")->get<PointCloud>(); }

TEST(TestStream, GivesTheFirstPointAndTheLast_BothWays) {
    const TemporaryFolder folder;
    FilterLibrary library({test::test_plugin_folder()});
    const FilterDeclaration& filter = library.load("test-stream");
    const ParameterSet parameters{
        {{"length", ParameterScalar(Length(0.5))}, {"log", ParameterScalar((folder / "log").string())}}};
    for (const std::string text : {"1 2 3\n4 5 6\n7 8 9\n", "1 2 3\n"}) {
        const auto path = folder.write("a.xyz", text);
        Inputs inputs;
        inputs.add("points", read_points(path));
        Context context;
        const Outputs whole = filter.run(inputs, parameters, context);
        const Outputs streamed = filter.run_streamed(*open_point_stream(path, {}, 1), parameters, context);
        EXPECT_TRUE(same_points(points(streamed), points(whole)));
        EXPECT_EQ(points(whole).frame.origin + points(whole).positions[points(whole).size() - 1],
                  text.size() > 6 ? Vec3(7, 8, 9) : Vec3(1, 2, 3));
    }
    EXPECT_EQ(content_of(folder / "log"), "whole 0.5 u 3\nstream 0.5 u 3\nwhole 0.5 u 1\nstream 0.5 u 1\n");
}

}  // namespace
}  // namespace scanmill::test
