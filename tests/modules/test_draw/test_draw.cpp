// SPDX-License-Identifier: GPL-3.0-or-later
#include "test_draw/test_draw.hpp"

#include "scanmill/base/error.hpp"

namespace scanmill {

Picture test_draw(const Buffer<Vec3>& positions, const TestDrawParams& params) {
    if (params.fails) throw Error("the picture was not drawn, as asked for").hint("clear `fails`");
    Array<Colour> pixels;
    for (std::size_t i = 0; i < positions.size(); ++i) pixels.push_back({static_cast<u8>(i), 0, 255});
    return {static_cast<u32>(positions.size()), 1, std::move(pixels), params.caption};
}

}  // namespace scanmill
