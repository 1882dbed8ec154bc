// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"
#include "threemf/threemf.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    // 3MF files begin like every ZIP archive, so only the extension identifies them.
    return {{"3MF", {"3mf"}, {}, {kind_of<TriangleMesh>()}, false},
            {},
            {{kind_of<TriangleMesh>(), threemf::write_threemf}}};
}
