// SPDX-License-Identifier: GPL-3.0-or-later
// The tests' own filter that draws, called as the engine calls it: through its module.

#include <gtest/gtest.h>

#include "scanmill/plugin/library.hpp"
#include "support/folders.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

TEST(TestDraw, GivesAPixelPerVertex) {
    FilterLibrary library({test::test_plugin_folder()});
    const FilterDeclaration& filter = library.load("test-draw");
    EXPECT_EQ(filter.spec.draws, DrawSpec{"scene"});
    Inputs inputs;
    inputs.add("scene", std::make_shared<const TriangleMesh>(cube()));
    Context context;
    const Outputs outputs = filter.run(inputs, {}, context);
    ASSERT_TRUE(outputs.find("picture"));
    const auto picture = outputs.find("picture")->get<Picture>();
    EXPECT_EQ(picture->width, 8u);
    EXPECT_EQ(picture->height, 1u);
    EXPECT_EQ(picture->pixels[7], (Colour{7, 0, 255}));
    EXPECT_EQ(picture->caption, "Points");
}

}  // namespace
}  // namespace scanmill::test
