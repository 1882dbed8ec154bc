// SPDX-License-Identifier: GPL-3.0-or-later
#include "pcd/pcd_fields.hpp"

#include <cstring>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill::pcd {

namespace {

using pcl::PCLPointCloud2;
using pcl::PCLPointField;

constexpr std::array<std::pair<ScalarType, PCLPointField::PointFieldTypes>, 10> types{{
    {ScalarType::int8, PCLPointField::INT8},
    {ScalarType::uint8, PCLPointField::UINT8},
    {ScalarType::int16, PCLPointField::INT16},
    {ScalarType::uint16, PCLPointField::UINT16},
    {ScalarType::int32, PCLPointField::INT32},
    {ScalarType::uint32, PCLPointField::UINT32},
    {ScalarType::int64, PCLPointField::INT64},
    {ScalarType::uint64, PCLPointField::UINT64},
    {ScalarType::float32, PCLPointField::FLOAT32},
    {ScalarType::float64, PCLPointField::FLOAT64},
}};

std::size_t rows_of(const PCLPointCloud2& cloud) { return std::size_t(cloud.width) * cloud.height; }

ScalarType require_type(const PCLPointField& field) {
    const std::optional<ScalarType> type = scalar_type(field.datatype);
    if (!type) throw Error("the field '{}' has the unknown type {}", field.name, field.datatype);
    return *type;
}

/// Row by row the bytes of these fields, side by side.
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

/// Four bytes per point, packed as a number: blue is the lowest.
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

/// The three fields of these names, when all are there with one number each of the same type.
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
        warn(options.on_warning, "the field {} became the column '{}': its own name is taken", quote(wanted), name);
    return name;
}

}  // namespace

std::optional<ScalarType> scalar_type(std::uint8_t datatype) {
    for (const auto& [ours, theirs] : types)
        if (theirs == datatype) return ours;
    return std::nullopt;
}

std::uint8_t datatype(ScalarType type) {
    return std::ranges::find(types, type, &std::pair<ScalarType, PCLPointField::PointFieldTypes>::first)->second;
}

const PCLPointField* field_named(const PCLPointCloud2& cloud, std::string_view name) {
    const auto found = std::ranges::find(cloud.fields, name, &PCLPointField::name);
    return found == cloud.fields.end() ? nullptr : &*found;
}

Array<Vec3> positions_of(const PCLPointCloud2& cloud) {
    Array<Vec3> positions(rows_of(cloud));
    constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const PCLPointField* field = field_named(cloud, axes[axis]);
        if (!field || field->count != 1) throw Error("has no field '{}'; points need x, y and z", axes[axis]);
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

ColumnTable columns_of(const PCLPointCloud2& cloud, const ReadOptions& options) {
    ColumnTable table;
    std::set<std::string_view> taken{"x", "y", "z", "_"};
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

}  // namespace scanmill::pcd
