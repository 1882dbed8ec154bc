// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/e57/e57.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {
constexpr std::string_view magic = "ASTM-E57";
}

Recognition recognise_e57(std::string_view head, u64) {
    return head.starts_with(magic) ? Recognition::certain : Recognition::no;
}

LoadedFile refuse_e57(const FileBytes& file, const ReadOptions&) {
    if (!file.bytes.starts_with(magic)) throw Error("is no E57 file: it does not begin with {}", magic);
    throw Error("is an E57 file; E57 is not read")
        .hint(fmt::format("convert it with a free program: CloudCompare -SILENT -O {0} -C_EXPORT_FMT PLY -SAVE_CLOUDS, "
                          "or: pdal translate {0} out.las",
                          shell_word(file.path)));
}

}  // namespace scanmill
