// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/las/detail/las_points.hpp"
#include "scanmill/formats/las/las.hpp"

namespace scanmill {

namespace {

constexpr std::string_view magic = "LASF";

bool is_compressed(const LasHeader& header, const std::vector<LasRecord>& records) {
    return header.is_compressed ||
           std::ranges::any_of(records, [](const LasRecord& record) { return record.user == "laszip encoded"; });
}

[[noreturn]] void refuse_compressed(const FileBytes& file, const std::vector<LasRecord>& records) {
    const bool is_copc = std::ranges::any_of(records, [](const LasRecord& record) { return record.user == "copc"; });
    throw Error("is {} file, LAS in compressed form; it is not read", is_copc ? "a COPC" : "a LAZ")
        .hint(fmt::format("decompress it with a free program: pdal translate {0} out.las, or: laszip -i {0} -o out.las",
                          shell_word(file.path)));
}

void warn_left_out(const LasHeader& header, const std::vector<LasRecord>& records, std::string_view bytes,
                   bool unit_is_used, const ReadOptions& options) {
    std::string list;
    constexpr std::size_t most_listed = 6;
    std::size_t count = 0;
    for (const LasRecord& record : records) {
        if (describes_extra_bytes(record)) continue;
        if (++count <= most_listed)
            list += fmt::format("{}{} {}{}", list.empty() ? "" : ", ", record.user.empty() ? "?" : record.user,
                                record.id, unit_is_used && holds_geo_keys(record) ? " but for its unit" : "");
    }
    if (count > most_listed) list += ", …";
    if (count > 0)
        warn(options.on_warning, "{} left out ({})",
             count_text(count, "variable length record was", "variable length records were"), list);
    if (header.extended_records > 0)
        warn(options.on_warning, "{} left out",
             count_text(header.extended_records, "record behind the points was", "records behind the points were"));
    const std::size_t rest = bytes.size() - header.points_begin - header.points * header.point_size;
    if (rest > 0 && header.extended_records == 0)
        warn(options.on_warning, "{} behind the last point and left out", count_text(rest, "byte was", "bytes were"));
}

}  // namespace

Recognition recognise_las(std::string_view head, u64) {
    return head.starts_with(magic) ? Recognition::certain : Recognition::no;
}

LoadedFile read_las(const FileBytes& file, const ReadOptions& options) {
    if (!file.bytes.starts_with(magic))
        throw Error("is no LAS file: it begins with {}, not with {}", quote(file.bytes.substr(0, magic.size())), magic);
    const LasHeader header = read_las_header(file.bytes);
    const std::vector<LasRecord> records = read_las_records(header, file.bytes, options);
    if (is_compressed(header, records)) refuse_compressed(file, records);
    require_las_points(header, file.bytes);
    const LengthUnit unit = las_unit(records, options);
    const bool unit_is_used = unit != LengthUnit::unknown && options.unit == LengthUnit::unknown;
    warn_left_out(header, records, file.bytes, unit_is_used, options);
    const std::vector<LasExtra> extras = read_las_extra(header, records, options);

    LoadedFile loaded;
    loaded.format = "LAS";
    loaded.encoding =
        fmt::format("binary little-endian, 1.{}, point format {}", header.minor_version, header.point_format);
    for (const std::string& remark : {header.system, header.software})
        if (!remark.empty()) loaded.comments.push_back(remark);
    PointCloud cloud = read_las_points(header, extras, file.bytes, options);
    cloud.frame.unit = unit;
    loaded.value = std::make_shared<const PointCloud>(std::move(cloud));
    return loaded;
}

}  // namespace scanmill
