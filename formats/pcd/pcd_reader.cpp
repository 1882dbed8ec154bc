// SPDX-License-Identifier: GPL-3.0-or-later
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <cstring>
#include <set>
#include <sstream>

#include "pcd/pcd.hpp"
#include "pcd/pcd_header.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill::pcd {

namespace {

using Encoding = PcdHeader::Encoding;
using pcl::PCLPointCloud2;
using pcl::PCLPointField;

// Columns from the bytes of PCL's rows.

std::size_t rows_of(const PCLPointCloud2& cloud) { return std::size_t(cloud.width) * cloud.height; }

ScalarType require_type(const PCLPointField& field) {
    const std::optional<ScalarType> type = scalar_type(field.datatype);
    if (!type) throw Error("the field '{}' has the unknown type {}", field.name, field.datatype);
    return *type;
}

/// The numbers of these fields, row by row.
template <class T>
Buffer<T> gathered(const PCLPointCloud2& cloud, std::span<const PCLPointField* const> fields, std::size_t count) {
    Array<T> values(rows_of(cloud) * fields.size() * count);
    T* to = values.data();
    for (std::size_t row = 0; row < rows_of(cloud); ++row)
        for (const PCLPointField* field : fields) {
            std::memcpy(to, cloud.data.data() + row * cloud.point_step + field->offset, count * sizeof(T));
            to += count;
        }
    return Buffer(std::move(values));
}

Column column_of(const PCLPointCloud2& cloud, std::span<const PCLPointField* const> fields, std::string name,
                 std::size_t count) {
    return visit_scalar(require_type(*fields.front()), [&]<class T>(T) {
        return Column(std::move(name), static_cast<u32>(fields.size() * count), gathered<T>(cloud, fields, count));
    });
}

/// The column `colour` from a field of four bytes per point; blue is the lowest byte.
Column colours_of(const PCLPointCloud2& cloud, const PCLPointField& field) {
    const std::size_t channels = field.name == "rgba" ? 4 : 3;
    Array<u8> colours(rows_of(cloud) * channels);
    for (std::size_t row = 0; row < rows_of(cloud); ++row) {
        std::uint32_t packed = 0;
        std::memcpy(&packed, cloud.data.data() + row * cloud.point_step + field.offset, sizeof packed);
        const std::array<u8, 4> rgba{static_cast<u8>(packed >> 16), static_cast<u8>(packed >> 8),
                                     static_cast<u8>(packed), static_cast<u8>(packed >> 24)};
        std::copy_n(rgba.begin(), channels, colours.begin() + static_cast<std::ptrdiff_t>(row * channels));
    }
    return Column("colour", static_cast<u32>(channels), Buffer(std::move(colours)));
}

bool is_packed_colour(const PCLPointField& field) {
    const std::optional<ScalarType> type = scalar_type(field.datatype);
    return (field.name == "rgb" || field.name == "rgba") && field.count == 1 && type && size_of(*type) == 4;
}

/// The field of that name, or nullptr.
const PCLPointField* field_named(const PCLPointCloud2& cloud, std::string_view name) {
    const auto found = std::ranges::find(cloud.fields, name, &PCLPointField::name);
    return found == cloud.fields.end() ? nullptr : &*found;
}

std::string field_names(const PCLPointCloud2& cloud) {
    std::vector<std::string> names;
    for (const PCLPointField& field : cloud.fields) names.push_back(quote(field.name));
    return enumerated(names);
}

/// The three fields with these names. Empty unless all exist and each has one number of the same type.
std::vector<const PCLPointField*> triple(const PCLPointCloud2& cloud, std::array<std::string_view, 3> names) {
    std::vector<const PCLPointField*> fields;
    for (std::string_view name : names) {
        const PCLPointField* field = field_named(cloud, name);
        if (!field || field->count != 1 || (!fields.empty() && field->datatype != fields.front()->datatype)) return {};
        fields.push_back(field);
    }
    return fields;
}

std::string free_name(const ColumnTable& table, const std::string& wanted, const ReadOptions& options) {
    std::string name = wanted;
    for (std::size_t number = 2; table.find(name); ++number) name = wanted + "_" + std::to_string(number);
    if (name != wanted)
        warn(options.on_warning, "the field {} became the column '{}', because another column has its name",
             quote(wanted), name);
    return name;
}

/// The names of the position fields: x, y and z, or X, Y and Z, which some programs write.
std::array<std::string_view, 3> axes_of(const PCLPointCloud2& cloud) {
    if (!field_named(cloud, "x") && field_named(cloud, "X")) return {"X", "Y", "Z"};
    return {"x", "y", "z"};
}

/// The positions of all rows. Throws Error if one of the fields is missing or has several numbers.
Array<Vec3> positions_of(const PCLPointCloud2& cloud) {
    Array<Vec3> positions(rows_of(cloud));
    const std::array<std::string_view, 3> axes = axes_of(cloud);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const PCLPointField* field = field_named(cloud, axes[axis]);
        if (!field || field->count != 1)
            throw Error("it has no field '{}'; points need x, y and z; its fields are {}", axes[axis],
                        field_names(cloud))
                .hint("rename the coordinate fields in the FIELDS line of the header");
        visit_scalar(require_type(*field), [&]<class T>(T) {
            for (std::size_t row = 0; row < positions.size(); ++row) {
                T value;
                std::memcpy(&value, cloud.data.data() + row * cloud.point_step + field->offset, sizeof value);
                positions[row][static_cast<Eigen::Index>(axis)] = static_cast<double>(value);
            }
        });
    }
    return positions;
}

/// The columns of all other fields, with the names that pcd.hpp states. If a column (packed colours or normals) already
/// has a field's name, the field gets another name, with a warning.
ColumnTable columns_of(const PCLPointCloud2& cloud, const ReadOptions& options) {
    ColumnTable table;
    const std::array<std::string_view, 3> axes = axes_of(cloud);
    std::set<std::string_view> taken{axes[0], axes[1], axes[2], "_"};
    using Names = std::array<std::string_view, 3>;
    for (const Names& names : {Names{"normal_x", "normal_y", "normal_z"}, Names{"nx", "ny", "nz"}})
        if (const auto normal = triple(cloud, names); !normal.empty() && !table.find("normal")) {
            table.add(column_of(cloud, normal, "normal", 1));
            taken.insert(names.begin(), names.end());
        }
    for (const PCLPointField& field : cloud.fields) {
        if (taken.contains(field.name)) continue;
        if (is_packed_colour(field) && !table.find("colour"))
            table.add(colours_of(cloud, field));
        else
            table.add(column_of(cloud, std::array{&field}, free_name(table, field.name, options), field.count));
    }
    return table;
}

/// The column `approach`: unit vectors from the points to the sensor, 0 for points that are NaN or at the sensor.
Column directions_to(const Vec3& sensor, std::span<const Vec3> positions) {
    Array<float> numbers;
    for (const Vec3& position : positions) {
        const Vec3 direction = (sensor - position).stableNormalized();
        for (const double number : direction)
            numbers.push_back(direction.allFinite() ? static_cast<float>(number) : 0.0f);
    }
    return {"approach", 3, Buffer<float>(std::move(numbers))};
}

// Bytes of the rows from the file.

/// Reads one number of the field's type to `to`.
void read_number(TextCursor& text, const PCLPointField& field, std::uint8_t* to) {
    const std::optional<ScalarType> type = scalar_type(field.datatype);
    if (!type) throw Error("the field '{}' has the unknown type {}", field.name, field.datatype);
    visit_scalar(*type, [&]<class T>(T value) {
        if (!text.number(value))
            throw Error("line {}: {} is not a {} for the field '{}'", text.line(), quote(text.last_token()),
                        scanmill::name_of(*type), field.name);
        std::memcpy(to, &value, sizeof value);
    });
}

/// Reads the rows of an ascii file into `cloud.data`. PCL's own reader would read unreadable numbers as zeros. Throws
/// Error with the line if a row has too few or too many numbers, or a number that its field's type cannot hold. Throws
/// Error for fewer or more rows than the header declares. Pre: the cloud has the fields and the size of `header`.
void read_rows(std::string_view bytes, const PcdHeader& header, PCLPointCloud2& cloud) {
    TextCursor text(bytes.substr(header.body), {.line = header.lines + 1});
    for (u64 row = 0; row < header.points; ++row) {
        if (!text.next_row())
            throw Error("its header promises {}; {} {}", count_text(header.points, "point", "points"), row,
                        by_count(row, "follows", "follow"))
                .hint("the file is truncated: fetch or export it again");
        u64 numbers = 0;
        for (const PCLPointField& field : cloud.fields) {
            const std::size_t size = size_of(scalar_type(field.datatype).value_or(ScalarType::float64));
            for (std::size_t i = 0; i < field.count && text.more(); ++i, ++numbers)
                read_number(text, field, cloud.data.data() + row * cloud.point_step + field.offset + i * size);
        }
        numbers += text.count_tokens();
        if (numbers != header.row_numbers)
            throw Error("line {}: found {}; a point has {}", text.line(), count_text(numbers, "number", "numbers"),
                        header.row_numbers);
    }
    if (text.next_row())
        throw Error("line {}: more rows than the {} of the header", text.line(),
                    count_text(header.points, "point", "points"));
}

/// PCL splits the lines of a malformed header in another way, and its fields may then extend beyond the points.
void require_fields_inside(const PCLPointCloud2& cloud, const PcdHeader& header) {
    bool fits = cloud.point_step == header.row_bytes && cloud.data.size() == header.points * header.row_bytes;
    for (const PCLPointField& field : cloud.fields) {
        const std::optional<ScalarType> type = scalar_type(field.datatype);
        if (!type) throw Error("the field {} has the unknown type {}", quote(field.name), field.datatype);
        fits = fits && field.offset + u64(field.count) * size_of(*type) <= cloud.point_step;
    }
    if (!fits)
        throw Error("its header names fields that do not add up to {} per point",
                    count_text(header.row_bytes, "byte", "bytes"))
            .hint("SIZE, TYPE and COUNT must have an entry for every field");
}

PCLPointCloud2 read_cloud(std::string_view bytes, const PcdHeader& header) {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // our own message replaces those of PCL
    pcl::PCDReader reader;
    PCLPointCloud2 cloud;
    Eigen::Vector4f origin;
    Eigen::Quaternionf orientation;
    int version = 0, data_type = 0;
    unsigned int body = 0;
    std::istringstream text{std::string(bytes.substr(0, header.body))};
    int trouble = reader.readHeader(text, cloud, origin, orientation, version, data_type, body);
    if (trouble >= 0) require_fields_inside(cloud, header);
    if (trouble >= 0 && header.encoding == Encoding::ascii) {
        read_rows(bytes, header, cloud);
    } else if (trouble >= 0) {
        const auto* from = reinterpret_cast<const unsigned char*>(bytes.data());
        trouble = reader.readBodyBinary(from, cloud, version, header.encoding == Encoding::compressed,
                                        static_cast<unsigned int>(header.body));
    }
    if (trouble < 0)
        throw Error("PCL cannot decode {} from {} of {} data", count_text(header.points, "point", "points"),
                    count_text(bytes.size() - header.body, "byte", "bytes"), name_of(header.encoding))
            .hint("the file is damaged: fetch or export it again");
    return cloud;
}

}  // namespace

LoadedFile read_pcd(const FileBytes& file, const ReadOptions& options) {
    const PcdHeader header = checked_header(file.bytes);
    const PCLPointCloud2 cloud = read_cloud(file.bytes, header);
    const bool is_grid = header.height > 1 && header.width > 1;
    if (is_grid)
        warn(options.on_warning, "the grid of {} × {} points became a list in file order", header.width, header.height);
    if (header.bytes_behind > 0)
        warn(options.on_warning, "{} left out after the last point",
             count_text(header.bytes_behind, "byte was", "bytes were"));
    if (header.has_viewpoint)
        warn(options.on_warning,
             "the sensor's pose (VIEWPOINT {}) was left out; coordinates are as in the file, and the column 'approach' "
             "has the directions to the sensor",
             header.viewpoint);
    LoadedFile loaded;
    loaded.format = "PCD";
    loaded.encoding = name_of(header.encoding);
    loaded.comments = header.comments;
    loaded.nan_is_no_return = true;
    PointCloud points;
    points.frame = declared_frame(loaded.comments, options);
    Array<Vec3> positions = positions_of(cloud);
    ColumnTable columns = columns_of(cloud, options);
    // Programs write an identity VIEWPOINT even without a sensor, but only a sensor produces a grid.
    if ((header.has_viewpoint || is_grid) && !columns.find("approach"))
        columns.add(directions_to(header.sensor, positions));
    move_near_origin(positions, points.frame);
    points.positions = std::move(positions);
    points.columns = with_exponents(std::move(columns), loaded.comments);
    loaded.value = std::make_shared<const PointCloud>(std::move(points));
    return loaded;
}

}  // namespace scanmill::pcd
