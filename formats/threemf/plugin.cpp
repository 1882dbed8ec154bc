// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/format_plugin.hpp"
#include "threemf/threemf.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    // Its files begin like every ZIP archive, so only the extension identifies them.
    return {{"3MF", {"3mf"}, {}, {Kind::mesh}, false}, {}, {{Kind::mesh, threemf::write_threemf}}};
}
