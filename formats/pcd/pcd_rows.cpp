// SPDX-License-Identifier: GPL-3.0-or-later
#include "pcd/pcd_rows.hpp"

#include <cstring>

#include "pcd/pcd_fields.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill::pcd {

namespace {

/// One number of the field's type, to `to`.
void read_number(TextCursor& text, const pcl::PCLPointField& field, std::uint8_t* to) {
    const std::optional<ScalarType> type = scalar_type(field.datatype);
    if (!type) throw Error("the field '{}' has the unknown type {}", field.name, field.datatype);
    visit_scalar(*type, [&]<class T>(T value) {
        if (!text.number(value))
            throw Error("line {}: {} is no {} for the field '{}'", text.line(), quote(text.last_token()),
                        scanmill::name_of(*type), field.name);
        std::memcpy(to, &value, sizeof value);
    });
}

}  // namespace

void read_rows(std::string_view bytes, const PcdHeader& header, pcl::PCLPointCloud2& cloud) {
    TextCursor text(bytes.substr(header.body), {.line = header.lines + 1});
    for (u64 row = 0; row < header.points; ++row) {
        if (!text.next_row())
            throw Error("its header promises {}; {} {}", counted(header.points, "point", "points"), row,
                        by_count(row, "follows", "follow"))
                .hint("the file is truncated: fetch or export it again");
        u64 numbers = 0;
        for (const pcl::PCLPointField& field : cloud.fields) {
            const std::size_t size = size_of(scalar_type(field.datatype).value_or(ScalarType::float64));
            for (std::size_t i = 0; i < field.count && text.more(); ++i, ++numbers)
                read_number(text, field, cloud.data.data() + row * cloud.point_step + field.offset + i * size);
        }
        numbers += text.count_tokens();
        if (numbers != header.row_numbers)
            throw Error("line {}: found {}; a point has {}", text.line(), counted(numbers, "number", "numbers"),
                        header.row_numbers);
    }
    if (text.next_row())
        throw Error("line {}: more rows than the {} of the header", text.line(),
                    counted(header.points, "point", "points"));
}

}  // namespace scanmill::pcd
