// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "load.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::runner {
void add_convert(CLI::App&, Action&) {}
}
