// SPDX-License-Identifier: GPL-3.0-or-later
#include "laz/laz.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    // A compressed point takes about 4 bytes; see Format::memory_per_byte for what it takes in memory.
    constexpr double memory_per_byte = 40;
    return {{.name = "LAZ",
             .extensions = {"laz"},
             .begins = {"LASF"},
             .writes = {},
             .streams = true,
             .memory_per_byte = memory_per_byte},
            laz::read_laz,
            {},
            laz::may_stream_laz,
            laz::open_laz_stream};
}
