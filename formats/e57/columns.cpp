// SPDX-License-Identifier: GPL-3.0-or-later
#include "e57/columns.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"

namespace scanmill::e57_format {

namespace {

constexpr std::array<std::string_view, 3> colours{"colorRed", "colorGreen", "colorBlue"};
constexpr std::array<std::string_view, 3> normals{"nor:normalX", "nor:normalY", "nor:normalZ"};
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> flags{
    {{"isIntensityInvalid", "intensity_invalid"},
     {"isColorInvalid", "colour_invalid"},
     {"isTimeStampInvalid", "time_stamp_invalid"}}};

/// "rowIndex" → "row_index", "ext:gainFactor" → "ext_gain_factor".
std::string lower_case(std::string_view name) {
    std::string text;
    for (const char c : name) {
        if (c >= 'A' && c <= 'Z') {
            if (!text.empty() && text.back() != '_') text += '_';
            text += static_cast<char>(c - 'A' + 'a');
        } else {
            text += c == ':' ? '_' : c;
        }
    }
    return text;
}

bool is_integer(ScalarType type) { return type != ScalarType::float32 && type != ScalarType::float64; }

/// A type that holds the numbers of both.
ScalarType common_type(ScalarType a, ScalarType b) {
    if (a == b) return a;
    if (!is_integer(a) || !is_integer(b)) return ScalarType::float64;
    const auto is_signed = [](ScalarType type) {
        return visit_scalar(type, []<class T>(T) { return std::is_signed_v<T>; });
    };
    const std::size_t size = std::max(size_of(a), size_of(b));
    if (is_signed(a) == is_signed(b)) return size_of(a) == size ? a : b;
    const ScalarType of_signed = is_signed(a) ? a : b, of_unsigned = is_signed(a) ? b : a;
    if (size_of(of_signed) > size_of(of_unsigned)) return of_signed;
    switch (size_of(of_unsigned)) {
        case 1: return ScalarType::int16;
        case 2: return ScalarType::int32;
        default: return ScalarType::int64;
    }
}

std::pair<double, double> limits_of_colour(const Scan& scan, std::string_view channel) {
    const Field& field = *scan.field(channel);
    double low = field.low, high = field.high;
    if (scan.colour_limits) {
        const std::string name(channel);
        if (scan.colour_limits->isDefined(name + "Minimum"))
            low = number_in(scan.colour_limits->get(name + "Minimum"), "its colour limit");
        if (scan.colour_limits->isDefined(name + "Maximum"))
            high = number_in(scan.colour_limits->get(name + "Maximum"), "its colour limit");
    }
    // A float without limits is a fraction.
    constexpr double unlimited = 1e30;
    if (!(high < unlimited) || !(low > -unlimited) || !(low < high)) return {0, field.is_integer ? 255 : 1};
    return {low, high};
}

/// The column of the colours of one scan.
ColumnPlan colour_column(const Scan& scan) {
    ColumnPlan plan;
    ColumnSource source;
    bool are_integers = true;
    double greatest = 0, least = 0;
    for (const std::string_view channel : colours) {
        const auto [low, high] = limits_of_colour(scan, channel);
        const Field& field = *scan.field(channel);
        source.fields.emplace_back(channel);
        source.low.push_back(low);
        source.high.push_back(high);
        are_integers &= field.is_integer;
        // A range of 0 to 65535 with limits of 0 to 255 holds bytes.
        greatest = std::max(greatest, scan.colour_limits ? high : field.high);
        least = std::min({least, low, field.low});
    }
    const bool are_bytes = are_integers && least >= 0 && greatest <= 255;
    const bool are_words = are_integers && least >= 0 && greatest <= 65535;
    plan.name = are_words && !are_bytes ? "colour16" : "colour";
    plan.type = are_words && !are_bytes ? ScalarType::uint16 : ScalarType::uint8;
    // Limits may be the least and the greatest value of the scan, and stretching these would change the colours.
    // Therefore integers are scaled by the number of bits that the limits need.
    const std::uint64_t full = are_words ? std::bit_ceil(static_cast<std::uint64_t>(greatest) + 1) - 1 : 0;
    if (are_bytes || full == 65535) {
        source.low.clear(), source.high.clear();
    } else if (are_words) {
        source.low.assign(colours.size(), 0);
        source.high.assign(colours.size(), static_cast<double>(full));
    }
    plan.sources.emplace(scan.number, std::move(source));
    return plan;
}

ColumnPlan normal_column(const Scan& scan) {
    ColumnPlan plan;
    plan.name = "normal";
    plan.is_direction = true;
    plan.type = ScalarType::float32;
    ColumnSource source;
    for (const std::string_view axis : normals) {
        source.fields.emplace_back(axis);
        if (scan.field(axis)->type != ScalarType::float32) plan.type = ScalarType::float64;
    }
    plan.sources.emplace(scan.number, std::move(source));
    return plan;
}

ColumnPlan plain_column(const Scan& scan, const Field& field) {
    ColumnPlan plan;
    plan.name = lower_case(field.name);
    plan.type = field.type;
    if (field.name == "sphericalRange") plan.length_exponent = 1;
    for (const auto& [flag, name] : flags)
        if (field.name == flag) {
            plan.name = name;
            plan.is_flag = true;
        }
    plan.sources.emplace(scan.number, ColumnSource{{field.name}, {}, {}});
    return plan;
}

std::vector<ColumnPlan> columns_of(const Scan& scan) {
    const bool has_colours = scan.has({colours[0], colours[1], colours[2]});
    const bool has_normals = scan.has({normals[0], normals[1], normals[2]});
    const bool is_cartesian = scan.has({"cartesianX", "cartesianY", "cartesianZ"});
    const std::string_view used = is_cartesian ? "cartesian" : "spherical";
    std::vector<ColumnPlan> columns;
    for (const Field& field : scan.fields) {
        if (field.name.starts_with(used)) continue;  // positions and their validity
        const auto is_in = [&](const auto& names) { return std::ranges::find(names, field.name) != names.end(); };
        if (has_colours && is_in(colours)) {
            if (field.name == colours[0]) columns.push_back(colour_column(scan));
        } else if (has_normals && is_in(normals)) {
            if (field.name == normals[0]) columns.push_back(normal_column(scan));
        } else {
            ColumnPlan column = plain_column(scan, field);
            // Names of two extensions may become equal.
            const bool is_taken = std::ranges::find(columns, column.name, &ColumnPlan::name) != columns.end();
            if (is_taken) column.name = field.name;
            columns.push_back(std::move(column));
        }
    }
    return columns;
}

}  // namespace

std::vector<ColumnPlan> planned_columns(std::span<const Scan> scans,
                                        const std::function<void(std::string)>& on_warning) {
    std::vector<ColumnPlan> all;
    std::size_t counted = 0;
    for (const Scan& scan : scans) {
        if (scan.records == 0) continue;
        ++counted;
        for (const std::string& text : scan.texts)
            warn(on_warning, "the texts of the field {} of scan {} were left out", quote(text), scan.number);
        for (ColumnPlan& column : columns_of(scan)) {
            const auto found = std::ranges::find(all, column.name, &ColumnPlan::name);
            if (found == all.end()) {
                all.push_back(std::move(column));
            } else {
                found->type = common_type(found->type, column.type);
                found->sources.merge(column.sources);
            }
        }
    }
    std::vector<ColumnPlan> kept;
    for (ColumnPlan& column : all) {
        const bool is_complete =
            column.sources.size() == counted && std::ranges::all_of(column.sources, [&](const auto& each) {
                return each.second.fields.size() == column.sources.begin()->second.fields.size();
            });
        if (is_complete)
            kept.push_back(std::move(column));
        else
            warn(on_warning, "the column '{}' was left out: {} of {} scans have it", column.name, column.sources.size(),
                 counted);
    }
    return kept;
}

template <class T>
void GrowingColumn::append_as(const Scan& scan, const Block& block, std::span<const u32> rows) {
    const ColumnSource& source = plan_.sources.at(scan.number);
    std::vector<const FieldBlock*> fields;
    for (const std::string& name : source.fields) fields.push_back(&block.find(name)->second);
    const std::size_t components = fields.size(), old = bytes_.size();
    bytes_.resize(old + rows.size() * row_size());
    T* to = reinterpret_cast<T*>(bytes_.data() + old);
    for (const u32 row : rows) {
        bool is_set = false;
        for (std::size_t i = 0; i < components; ++i) {
            const FieldBlock& field = *fields[i];
            if (!source.low.empty()) {
                const double share = (field.number(row) - source.low[i]) / (source.high[i] - source.low[i]);
                const double full = sizeof(T) == 1 ? 255 : 65535;
                to[i] = static_cast<T>(share > 0 ? std::floor(full * std::min(share, 1.0) + 0.5) : 0);  // NaN: 0
            } else if (field.integers.empty()) {
                to[i] = static_cast<T>(field.reals[row]);  // only floats are planned for reals
            } else {
                if constexpr (std::is_integral_v<T>)
                    if (!std::in_range<T>(field.integers[row]))
                        throw Error("the field {} has the value {}, which is outside of its declared range",
                                    quote(source.fields[i]), field.integers[row])
                            .hint("the file is damaged: fetch or export it again");
                to[i] = static_cast<T>(field.integers[row]);
            }
            is_set |= to[i] != T{};
        }
        set_rows_ += is_set;
        if (plan_.is_direction && scan.pose) {
            const Vec3 turned = scan.pose->rotation * Vec3(static_cast<double>(to[0]), static_cast<double>(to[1]),
                                                           static_cast<double>(to[2]));
            for (int axis = 0; axis < 3; ++axis) to[axis] = static_cast<T>(turned[axis]);
        }
        to += components;
    }
}

void GrowingColumn::append(const Scan& scan, const Block& block, std::span<const u32> rows) {
    visit_scalar(plan_.type, [&]<class T>(T) { append_as<T>(scan, block, rows); });
}

Column GrowingColumn::finished() && {
    return {plan_.name, plan_.type,           plan_.components(), Buffer<std::byte>(std::move(bytes_)),
            {},         plan_.length_exponent};
}

}  // namespace scanmill::e57_format
