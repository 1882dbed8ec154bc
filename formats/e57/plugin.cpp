// SPDX-License-Identifier: GPL-3.0-or-later
#include "e57/e57.hpp"
#include "scanmill/plugin/format_modules.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    return {.spec = {.name = "E57", .extensions = {"e57"}, .begins = {"ASTM-E57"}, .writes = {}, .has_views = true},
            .read = e57_format::read_e57,
            .writers = {},
            .count_views = e57_format::count_scans};
}
