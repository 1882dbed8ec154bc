// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `picture`.
#include "scanmill/data/picture.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/kind_traits.hpp"
#include "scanmill/record/json.hpp"

namespace scanmill {

template <>
struct KindTraits<Picture> : NotGeometric<Picture>, NoJson<Picture> {
    static constexpr std::string_view name = "picture";
    static std::vector<PropertySpec> property_specs() {
        return {{"width", Unit::count, "Number of pixels in a row."}, {"height", Unit::count, "Number of rows."}};
    }
    static std::vector<std::optional<double>> property_values(const Picture& picture) {
        return {picture.width, picture.height};
    }
    static void require_usable(const Picture& picture) {
        const std::size_t pixels = std::size_t(picture.width) * picture.height;
        if (pixels == 0)
            throw Error("the picture is empty: {} x {} pixels", picture.width, picture.height)
                .hint("this is a fault of the filter that made it");
        if (picture.pixels.size() != pixels)
            throw Error("the picture has {} pixels; expected {} x {} = {}", picture.pixels.size(), picture.width,
                        picture.height, pixels)
                .hint("this is a fault of the filter that made it");
    }
};

template Kind kind_of<Picture>();

}  // namespace scanmill
