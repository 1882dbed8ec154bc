// SPDX-License-Identifier: GPL-3.0-or-later
#include "threemf/threemf.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/common/rounding.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "threemf/zip.hpp"

namespace scanmill::threemf {

namespace {

/// Throws Error unless the mesh is a closed, oriented manifold with finite coordinates whose triangles face outwards.
/// The message counts the defects.
void require_solid(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) throw Error("nothing to write: the mesh has no triangles, and 3MF holds solids only");
    require_finite(mesh.positions.span(), "vertices");
    const MeshTopology found = topology(mesh);
    if (!found.closed)
        throw Error("3MF holds closed, oriented manifolds only; the mesh has {}", defects_text(found))
            .hint("STL, GLB and VTP hold open meshes; alpha-solid makes closed ones from points");
    const double volume = signed_volume(mesh.positions.span(), mesh.triangles.span());
    if (volume == 0)
        throw Error("3MF holds solids only; the volume of the mesh is 0, so it has no inside")
            .hint("STL, GLB and VTP hold meshes of any shape");
    if (!(volume > 0))
        throw Error("3MF holds solids only; the mesh encloses the volume {:.6g}: its triangles do not face outwards",
                    volume)
            .hint("reverse the triangles, or write STL, GLB or VTP");
}

/// The offset of the object, exact in single precision.
Vec3 offset_of(const TriangleMesh& mesh) {
    BoundingBox box = bounding_box(mesh.positions.span());
    box.low += mesh.frame.origin;
    box.high += mesh.frame.origin;
    return rounded_to_float(distant_origin(box));
}

std::string_view name_of(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::micrometre: return "micron";
        case LengthUnit::centimetre: return "centimeter";
        case LengthUnit::metre: return "meter";
        case LengthUnit::inch: return "inch";
        case LengthUnit::foot: return "foot";
        case LengthUnit::millimetre:
        case LengthUnit::unknown: break;
    }
    return "millimeter";
}

/// Writes 'x="1" y="2" z="3', with the shortest decimals that read back equal; the caller closes the last quote.
template <class Numbers>
void put_attributes(const std::array<std::string_view, 3>& names, const Numbers& numbers, OutputBuffer& xml) {
    for (int i = 0; i < 3; ++i) {
        xml.text(names[static_cast<std::size_t>(i)]);
        xml.number(numbers[i]);
    }
}

/// Writes the colours of the vertices as resource 2; the index of a colour is that of its vertex.
void put_colours(const Column& colour, OutputBuffer& xml) {
    xml.text("<m:colorgroup id=\"2\">\n");
    const u8* channels = colour.values<u8>().data();
    for (std::size_t row = 0; row < colour.rows(); ++row, channels += colour.components()) {
        xml.text(fmt::format("<m:color color=\"#{:02X}{:02X}{:02X}", channels[0], channels[1], channels[2]));
        if (colour.components() == 4) xml.text(fmt::format("{:02X}", channels[3]));
        xml.text("\"/>\n");
    }
    xml.text("</m:colorgroup>\n");
}

void put_model(const TriangleMesh& mesh, const Vec3& offset, OutputBuffer& xml) {
    const std::string name = valid_text(mesh.frame.name);
    const Column* const colour = TextColumns(mesh.vertex_columns).colour;
    xml.text(fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="{}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"{}>
<resources>)",
                         name_of(mesh.frame.unit),
                         colour ? R"( xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02")" : ""));
    if (colour) put_colours(*colour, xml);
    xml.text(fmt::format(R"(<object id="1"{}{}><mesh>
<vertices>
)",
                         name.empty() ? "" : fmt::format(R"( name="{}")", xml_escaped(name)),
                         colour ? R"( pid="2" pindex="0")" : ""));
    const Vec3 shift = mesh.frame.origin - offset;
    for (const Vec3& position : mesh.positions) {
        put_attributes({R"(<vertex x=")", R"(" y=")", R"(" z=")"}, (shift + position).cast<float>().eval(), xml);
        xml.text("\"/>\n");
    }
    xml.text("</vertices>\n<triangles>\n");
    for (const Triangle& triangle : mesh.triangles) {
        put_attributes({R"(<triangle v1=")", R"(" v2=")", R"(" v3=")"}, triangle, xml);
        if (colour) put_attributes({R"(" pid="2" p1=")", R"(" p2=")", R"(" p3=")"}, triangle, xml);
        xml.text("\"/>\n");
    }
    xml.text("</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"");
    if (offset != Vec3::Zero()) {
        put_attributes({R"( transform="1 0 0 0 1 0 0 0 1 )", " ", " "}, offset, xml);
        xml.text("\"");
    }
    xml.text("/></build>\n</model>\n");
}

constexpr std::string_view content_types = R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";
constexpr std::string_view relationships = R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="model" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

}  // namespace

void write_threemf(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh mesh = with_used_vertices(*value.get<TriangleMesh>(), "3MF", options);
    require_solid(mesh);
    const Column* const colour = TextColumns(mesh.vertex_columns).colour;
    const std::string_view kept[] = {colour ? std::string_view(colour->name()) : ""};
    warn_bare_triangles(mesh, "3MF", options, kept);
    if (mesh.frame.unit == LengthUnit::unknown)
        warn(options.on_warning,
             "3MF needs a unit, but the scan has none: 1 was written as 1 mm; declare the scan's unit to avoid this");
    const Vec3 offset = offset_of(mesh);
    const Frame local{mesh.frame.unit, mesh.frame.origin - offset, ""};
    warn_lost_precision(local, mesh.positions.span(), true, "3MF", options);
    const auto vertex_in_file = [&](std::size_t vertex) {
        return rounded_to_float(world(local, mesh.positions[vertex]));
    };
    warn_collapsed(mesh, joined_vertices(mesh, vertex_in_file), "3MF", options);
    ZipWriter zip(out);
    zip.add("[Content_Types].xml", [](OutputBuffer& part) { part.text(content_types); });
    zip.add("_rels/.rels", [](OutputBuffer& part) { part.text(relationships); });
    zip.add("3D/3dmodel.model", [&](OutputBuffer& part) { put_model(mesh, offset, part); });
    zip.finish();
}

}  // namespace scanmill::threemf
