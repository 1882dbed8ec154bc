// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The content of a 3MF package as read by lib3mf.

#include <Model/COM/NMR_DLLInterfaces.h>
#include <zlib.h>

#include "core/formats/support.hpp"

namespace scanmill::test {

/// The only object of a package, with the properties that assimp does not give.
struct SeenBy3mf {
    DWORD unit = 99;
    std::string name;
    Vec3 offset = Vec3::Zero();
    std::vector<Vec3> vertices;  ///< without the offset
};

inline std::string bytes_of_3mf(const TriangleMesh& mesh, Warnings* warnings = nullptr) {
    return write_bytes("a.3mf", std::make_shared<const TriangleMesh>(mesh),
                       warnings ? warnings->writing() : WriteOptions{});
}

/// The XML of the model, found by the local header of its part and decompressed by zlib.
inline std::string model_in_3mf(const std::string& bytes) {
    const std::string_view name = "3D/3dmodel.model";
    const std::size_t begin = bytes.find(name) + name.size();
    std::string xml(1 << 20, '\0');
    z_stream stream{};
    EXPECT_EQ(::inflateInit2(&stream, -15), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + begin));
    stream.avail_in = static_cast<uInt>(bytes.size() - begin);
    stream.next_out = reinterpret_cast<Bytef*>(xml.data());
    stream.avail_out = static_cast<uInt>(xml.size());
    EXPECT_EQ(::inflate(&stream, Z_FINISH), Z_STREAM_END);
    xml.resize(stream.total_out);
    ::inflateEnd(&stream);
    return xml;
}

/// lib3mf's objects are left to the end of the program.
inline SeenBy3mf read_by_3mf(std::string bytes) {
    using namespace NMR;
    SeenBy3mf seen;
    PLib3MFModel* model = nullptr;
    PLib3MFModelReader* reader = nullptr;
    PLib3MFModelBuildItemIterator* items = nullptr;
    PLib3MFModelBuildItem* item = nullptr;
    PLib3MFModelObjectResource* object = nullptr;
    BOOL found = 0;
    MODELTRANSFORM offset;
    DWORD count = 0;
    char text[200] = "";
    ULONG length = 0;
    EXPECT_EQ(lib3mf_createmodel(&model), 0);
    EXPECT_EQ(lib3mf_model_queryreader(model, "3mf", &reader), 0);
    EXPECT_EQ(lib3mf_reader_setstrictmodeactive(reader, 1), 0);
    EXPECT_EQ(lib3mf_reader_readfrombuffer(reader, reinterpret_cast<BYTE*>(bytes.data()), bytes.size()), 0);
    EXPECT_EQ(lib3mf_model_getunit(model, &seen.unit), 0);
    EXPECT_EQ(lib3mf_model_getbuilditems(model, &items), 0);
    EXPECT_EQ(lib3mf_builditemiterator_movenext(items, &found), 0);
    EXPECT_TRUE(found);
    EXPECT_EQ(lib3mf_builditemiterator_getcurrent(items, &item), 0);
    EXPECT_EQ(lib3mf_builditem_getobjecttransform(item, &offset), 0);
    EXPECT_EQ(lib3mf_builditem_getobjectresource(item, &object), 0);
    EXPECT_EQ(lib3mf_object_getnameutf8(object, text, sizeof text, &length), 0);
    seen.name = text;
    EXPECT_EQ(lib3mf_meshobject_getvertexcount(object, &count), 0);
    for (DWORD i = 0; i < count; ++i) {
        MODELMESHVERTEX v;
        EXPECT_EQ(lib3mf_meshobject_getvertex(object, i, &v), 0);
        seen.vertices.emplace_back(v.m_fPosition[0], v.m_fPosition[1], v.m_fPosition[2]);
    }
    for (int axis = 0; axis < 3; ++axis) seen.offset[axis] = offset.m_fFields[axis][3];
    return seen;
}

}  // namespace scanmill::test
