// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// E57 (ASTM E2807), the exchange format of terrestrial scanners: recognised, so that its refusal can say how to
/// convert it; not read.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_e57(std::string_view head, u64 file_size);
/// Throws Error, always.
LoadedFile refuse_e57(const FileBytes& file, const ReadOptions& options);

}  // namespace scanmill
