// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"
#include "threemf/threemf.hpp"

SCANMILL_FORMAT() {
    using namespace scanmill;
    // Its files begin as every ZIP archive does: the extension must tell.
    return {{"3MF", {"3mf"}, {}, {Kind::mesh}, false}, {}, {{Kind::mesh, threemf::write_threemf}}};
}
