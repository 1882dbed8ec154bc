// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/las/detail/las_content.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

namespace {

bool is_of_laszip(const LasRecord& record) { return record.user == "laszip encoded"; }
bool is_of_copc(const LasRecord& record) { return record.user == "copc"; }

[[noreturn]] void refuse_compressed(const FileBytes& file, bool is_copc) {
    throw Error("is {} file, LAS in compressed form; it is not read", is_copc ? "a COPC" : "a LAZ")
        .hint(fmt::format("decompress it with a free program: pdal translate {0} out.las, or: laszip -i {0} -o out.las",
                          shell_word(file.path)));
}

void warn_left_out(const LasContent& content, bool unit_is_used, const ReadOptions& options) {
    const LasHeader& header = content.parts.header;
    std::vector<std::string> list;
    constexpr std::size_t most_listed = 6;
    for (const LasRecord& record : content.parts.records)
        if (!describes_extra_bytes(record) && !is_of_laszip(record) && !is_of_copc(record))
            list.push_back(fmt::format("{} {}{}", record.user.empty() ? "?" : record.user, record.id,
                                       unit_is_used && holds_geo_keys(record) ? " except its unit" : ""));
    if (const std::size_t count = list.size(); count > 0) {
        list.resize(std::min(count, most_listed));
        warn(options.on_warning, "{} left out ({}{})",
             count_text(count, "variable length record was", "variable length records were"), fmt::join(list, ", "),
             count > most_listed ? ", …" : "");
    }
    // A COPC file has one for its octree, which is not needed to read all points.
    const u32 extended = header.extended_records - std::min<u32>(header.extended_records, content.is_copc ? 1 : 0);
    if (extended > 0)
        warn(options.on_warning, "{} left out",
             count_text(extended, "record after the points was", "records after the points were"));
    if (header.is_compressed) return;
    const std::size_t rest = content.parts.bytes.size() - header.points_begin - header.points * header.point_size;
    if (rest > 0 && header.extended_records == 0)
        warn(options.on_warning, "{} after the last point ignored", count_text(rest, "byte", "bytes"));
}

}  // namespace

bool is_compressed(const LasParts& parts) {
    return parts.header.is_compressed || std::ranges::any_of(parts.records, is_of_laszip);
}

LasContent read_las_content(const FileBytes& file, const ReadOptions& options, bool reads_compressed) {
    if (!file.bytes.starts_with(las_magic))
        throw Error("is not a {} file: it begins with {}, not with {}", reads_compressed ? "LAZ" : "LAS",
                    quote(file.bytes.substr(0, las_magic.size())), las_magic);
    LasContent content;
    content.parts = {read_las_header(file.bytes), {}, file.bytes, {}};
    LasParts& parts = content.parts;
    parts.records = read_las_records(parts.header, file.bytes, options);
    content.is_copc = std::ranges::any_of(parts.records, is_of_copc);
    if (is_compressed(parts) && !reads_compressed) refuse_compressed(file, content.is_copc);
    if (!is_compressed(parts) && reads_compressed) throw Error("is not a LAZ file: its points are not compressed");
    require_las_points(parts.header, file.bytes);
    content.unit = las_unit(parts.records, options);
    const bool unit_is_used = content.unit != LengthUnit::unknown && options.unit == LengthUnit::unknown;
    warn_left_out(content, unit_is_used, options);
    content.extras = read_las_extra(parts.header, parts.records, options);
    for (const std::string& comment : {parts.header.system, parts.header.software})
        if (!comment.empty()) content.comments.push_back(comment);
    return content;
}

}  // namespace scanmill
