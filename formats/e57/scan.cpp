// SPDX-License-Identifier: GPL-3.0-or-later
#include "e57/scan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/transform.hpp"

namespace scanmill::e57_format {

namespace {

using ::e57::Node;
using ::e57::StructureNode;

/// A block of points has a buffer for each field.
constexpr std::int64_t most_fields = 256;

std::optional<Node> child(const StructureNode& parent, const std::string& name) {
    if (!parent.isDefined(name)) return std::nullopt;
    return parent.get(name);
}

StructureNode structure(const Node& node, std::string_view what) {
    if (node.type() != ::e57::TypeStructure) throw Error("{} is not a structure", what);
    return StructureNode(node);
}

/// The smallest type that holds all integers of a range. The reader checks the values against the range.
ScalarType integer_type(std::int64_t low, std::int64_t high) {
    const auto fits = [&]<class T>(T) { return std::in_range<T>(low) && std::in_range<T>(high); };
    for (const ScalarType type : {ScalarType::uint8, ScalarType::int8, ScalarType::uint16, ScalarType::int16,
                                  ScalarType::uint32, ScalarType::int32})
        if (visit_scalar(type, [&]<class T>(T zero) {
                if constexpr (std::is_integral_v<T>) return fits(zero);
                return false;
            }))
            return type;
    return ScalarType::int64;
}

/// The bits of an integer in the binary section; 0 if it is constant.
u64 bits_of_range(std::int64_t low, std::int64_t high) {
    return static_cast<u64>(std::bit_width(static_cast<u64>(high) - static_cast<u64>(low)));
}

void add_field(Scan& scan, const Node& node) {
    Field field;
    field.name = node.elementName();
    switch (node.type()) {
        case ::e57::TypeInteger: {
            const ::e57::IntegerNode integer(node);
            field.is_integer = true;
            field.type = integer_type(integer.minimum(), integer.maximum());
            field.low = static_cast<double>(integer.minimum());
            field.high = static_cast<double>(integer.maximum());
            scan.bits += bits_of_range(integer.minimum(), integer.maximum());
            break;
        }
        case ::e57::TypeScaledInteger: {
            const ::e57::ScaledIntegerNode scaled(node);
            if (!std::isfinite(scaled.scale()) || scaled.scale() == 0 || !std::isfinite(scaled.offset()))
                throw Error("its field {} has the scale {} and the offset {}", quote(field.name), scaled.scale(),
                            scaled.offset());
            field.low = scaled.scaledMinimum();
            field.high = scaled.scaledMaximum();
            scan.bits += bits_of_range(scaled.minimum(), scaled.maximum());
            break;
        }
        case ::e57::TypeFloat: {
            const ::e57::FloatNode real(node);
            const bool is_single = real.precision() == ::e57::PrecisionSingle;
            field.type = is_single ? ScalarType::float32 : ScalarType::float64;
            field.low = real.minimum();
            field.high = real.maximum();
            scan.bits += 8 * size_of(field.type);
            break;
        }
        case ::e57::TypeString:
            scan.bits += 8;  // at least the length
            scan.texts.push_back(field.name);
            return;
        default: throw Error("its field {} is neither a number nor a text", quote(field.name));
    }
    scan.fields.push_back(std::move(field));
}

std::optional<RigidTransform> pose_in(const StructureNode& scan, u32 number,
                                      const std::function<void(std::string)>& on_warning) {
    const std::optional<Node> node = child(scan, "pose");
    if (!node) return std::nullopt;
    const StructureNode pose = structure(*node, "its pose");
    RigidTransform motion;
    motion.unit = LengthUnit::metre;
    if (const auto rotation = child(pose, "rotation")) {
        const StructureNode parts = structure(*rotation, "the rotation of its pose");
        std::array<double, 4> quaternion{};
        for (std::size_t i = 0; i < 4; ++i)
            quaternion[i] = number_in(parts.get(std::string(1, "xyzw"[i])), "a number of its pose");
        for (const double part : quaternion)
            if (!std::isfinite(part)) throw Error("the rotation of its pose has a NaN or an infinity");
        motion.rotation = rotation_of(quaternion, fmt::format("the pose of scan {}", number), [&](std::string text) {
            if (on_warning) on_warning(std::move(text));
        });
    }
    if (const auto translation = child(pose, "translation")) {
        const StructureNode parts = structure(*translation, "the translation of its pose");
        for (int axis = 0; axis < 3; ++axis)
            motion.translation[axis] = number_in(parts.get(std::string(1, "xyz"[axis])), "a number of its pose");
        if (!motion.translation.allFinite()) throw Error("the translation of its pose has a NaN or an infinity");
    }
    const bool moves = motion.rotation != Eigen::Matrix3d::Identity() || motion.translation != Vec3::Zero();
    return moves ? std::optional(motion) : std::nullopt;
}

/// "intensity 0 to 255", from the structure intensityLimits.
void add_intensity_limits(const StructureNode& node, Scan& scan) {
    const auto limits = child(node, "intensityLimits");
    if (!limits || limits->type() != ::e57::TypeStructure) return;
    const auto low = child(StructureNode(*limits), "intensityMinimum");
    const auto high = child(StructureNode(*limits), "intensityMaximum");
    if (low && high)
        scan.comments.push_back(fmt::format("scan {} intensity limits {} {}", scan.number,
                                            number_in(*low, "its intensity limit"),
                                            number_in(*high, "its intensity limit")));
}

void add_name(const StructureNode& node, Scan& scan) {
    constexpr std::size_t longest = 200;
    const auto name = child(node, "name");
    if (!name || name->type() != ::e57::TypeString) return;
    std::string text = ::e57::StringNode(*name).value().substr(0, longest);
    for (char& c : text)
        if (static_cast<unsigned char>(c) < ' ') c = ' ';
    scan.comments.push_back(fmt::format("scan {} is {}", scan.number, text));
}

::e57::CompressedVectorNode points_of(const StructureNode& node) {
    const auto points = child(node, "points");
    if (!points || points->type() != ::e57::TypeCompressedVector) throw Error("it has no points");
    return ::e57::CompressedVectorNode(*points);
}

}  // namespace

const Field* Scan::field(std::string_view name) const {
    const auto found = std::ranges::find(fields, name, &Field::name);
    return found == fields.end() ? nullptr : &*found;
}

bool Scan::has(std::initializer_list<std::string_view> names) const {
    return std::ranges::all_of(names, [this](std::string_view name) { return field(name) != nullptr; });
}

double number_in(const Node& node, std::string_view what) {
    switch (node.type()) {
        case ::e57::TypeInteger: return static_cast<double>(::e57::IntegerNode(node).value());
        case ::e57::TypeScaledInteger: return ::e57::ScaledIntegerNode(node).scaledValue();
        case ::e57::TypeFloat: return ::e57::FloatNode(node).value();
        default: throw Error("{} is not a number", what);
    }
}

Scan described(const StructureNode& node, u32 number, const std::function<void(std::string)>& on_warning) {
    Scan scan(number, points_of(node));
    const std::int64_t records = scan.points.childCount();
    if (records < 0) throw Error("it promises {} points", records);
    scan.records = static_cast<u64>(records);
    const StructureNode prototype = structure(scan.points.prototype(), "the prototype of its points");
    if (prototype.childCount() > most_fields)
        throw Error("its points have {} fields; at most {} are read", prototype.childCount(), most_fields);
    scan.bits = 0;
    for (std::int64_t i = 0; i < prototype.childCount(); ++i) add_field(scan, prototype.get(i));
    scan.bits = std::max<u64>(scan.bits, 1);
    scan.pose = pose_in(node, number, on_warning);
    add_name(node, scan);
    add_intensity_limits(node, scan);
    if (const auto limits = child(node, "colorLimits"); limits && limits->type() == ::e57::TypeStructure)
        scan.colour_limits = StructureNode(*limits);
    return scan;
}

}  // namespace scanmill::e57_format
