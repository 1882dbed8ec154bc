// SPDX-License-Identifier: GPL-3.0-or-later
#include "png/png.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {{"PNG", {"png"}, {"\x89PNG\r\n\x1a\n"}, {kind_of<Picture>()}},
            png::read_png,
            {{kind_of<Picture>(), png::write_png}}};
}
