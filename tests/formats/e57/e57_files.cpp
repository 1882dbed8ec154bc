// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/e57/e57_files.hpp"

#include <E57Format.h>

#include <cstdint>
#include <stdexcept>

#include "support/e57_pages.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

namespace {

e57::Node node_of(const e57::ImageFile& file, const E57Field& field) {
    const auto low = static_cast<std::int64_t>(field.low), high = static_cast<std::int64_t>(field.high);
    switch (field.type) {
        case E57Field::Type::real64: return e57::FloatNode(file);
        case E57Field::Type::real32: return e57::FloatNode(file, 0, e57::PrecisionSingle);
        case E57Field::Type::integer: return e57::IntegerNode(file, low, low, high);
        case E57Field::Type::scaled: return e57::ScaledIntegerNode(file, low, low, high, field.scale, field.offset);
        case E57Field::Type::text: break;
    }
    return e57::StringNode(file);
}

e57::StructureNode pose_node(const e57::ImageFile& file, const E57Pose& pose) {
    e57::StructureNode node(file), rotation(file), translation(file);
    for (std::size_t i = 0; i < 4; ++i) rotation.set(std::string(1, "wxyz"[i]), e57::FloatNode(file, pose.rotation[i]));
    for (std::size_t i = 0; i < 3; ++i)
        translation.set(std::string(1, "xyz"[i]), e57::FloatNode(file, pose.translation[i]));
    node.set("rotation", rotation);
    node.set("translation", translation);
    return node;
}

void add_scan(e57::ImageFile& file, e57::VectorNode& scans, const E57Scan& scan) {
    e57::StructureNode node(file);
    node.set("guid", e57::StringNode(file, "{scan}"));
    if (!scan.name.empty()) node.set("name", e57::StringNode(file, scan.name));
    if (scan.pose) node.set("pose", pose_node(file, *scan.pose));
    for (const auto& [structure, name, number] : scan.limits) {
        if (!node.isDefined(structure)) node.set(structure, e57::StructureNode(file));
        e57::StructureNode(node.get(structure)).set(name, e57::FloatNode(file, number));
    }
    e57::StructureNode prototype(file);
    for (const E57Field& field : scan.fields) prototype.set(field.name, node_of(file, field));
    e57::CompressedVectorNode points(file, prototype, e57::VectorNode(file, true));
    node.set("points", points);
    scans.append(node);

    const std::size_t count = scan.fields.empty() ? 0 : scan.fields.front().values.size();
    std::vector<std::vector<double>> values;
    std::vector<std::vector<std::string>> texts(scan.fields.size(), std::vector<std::string>(count, "word"));
    std::vector<e57::SourceDestBuffer> buffers;
    for (const E57Field& field : scan.fields) {
        values.push_back(field.values);
        if (values.back().empty()) values.back().push_back(0);
        if (count == 0) texts[values.size() - 1].push_back("");
    }
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
        if (scan.fields[i].type == E57Field::Type::text)
            buffers.emplace_back(file, scan.fields[i].name, &texts[i]);
        else
            buffers.emplace_back(file, scan.fields[i].name, values[i].data(), values[i].size(), true);
    }
    e57::CompressedVectorWriter writer = points.writer(buffers);
    if (count > 0) writer.write(count);
    writer.close();
}

}  // namespace

std::vector<E57Field> cartesian(const std::vector<std::array<double, 3>>& points) {
    std::vector<E57Field> fields{reals("cartesianX", {}), reals("cartesianY", {}), reals("cartesianZ", {})};
    for (const auto& point : points)
        for (std::size_t axis = 0; axis < 3; ++axis) fields[axis].values.push_back(point[axis]);
    return fields;
}

std::string e57_file(const std::vector<E57Scan>& scans, int images) {
    const TemporaryFolder folder;
    const std::string path = (folder / "made.e57").string();
    e57::ImageFile file(path, "w");
    file.extensionsAdd("nor", "http://www.libe57.org/E57_NOR_surface_normals.txt");
    e57::StructureNode root = file.root();
    root.set("formatName", e57::StringNode(file, "ASTM E57 3D Imaging Data File"));
    root.set("guid", e57::StringNode(file, "{file}"));
    root.set("versionMajor", e57::IntegerNode(file, 1));
    root.set("versionMinor", e57::IntegerNode(file, 0));
    e57::VectorNode all(file, true), pictures(file, true);
    root.set("data3D", all);
    root.set("images2D", pictures);
    for (const E57Scan& scan : scans) add_scan(file, all, scan);
    for (int i = 0; i < images; ++i) pictures.append(e57::StructureNode(file));
    file.close();
    return content_of(path);
}

std::string e57_changed(const std::string& file, const std::function<void(std::string& content)>& change) {
    std::string content = e57_content(file);
    const std::size_t size = content.size();
    change(content);
    if (content.size() != size) throw std::logic_error("the change does not keep the size");
    return e57_sealed(content);
}

std::string e57_replaced(const std::string& file, std::string_view from, std::string_view to) {
    return e57_changed(file, [&](std::string& content) {
        const std::size_t at = content.find(from);  // behind the XML section, the writer leaves a part of it
        if (at == std::string::npos || from.size() != to.size()) throw std::logic_error("no such text");
        content.replace(at, to.size(), to);
    });
}

}  // namespace scanmill::test
