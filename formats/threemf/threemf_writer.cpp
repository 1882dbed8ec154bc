// SPDX-License-Identifier: GPL-3.0-or-later
#include <Model/COM/NMR_DLLInterfaces.h>
#include <xxhash.h>

#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/column_names.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"
#include "threemf/plain_zip.hpp"
#include "threemf/printed_mesh.hpp"
#include "threemf/threemf.hpp"

namespace scanmill::threemf {

namespace {

/// An object of lib3mf, given back at the end.
class Handle {
public:
    Handle() = default;
    ~Handle() {
        if (object_) NMR::lib3mf_release(object_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    NMR::PLib3MFBase** receive() { return &object_; }
    NMR::PLib3MFBase* get() const { return object_; }

private:
    NMR::PLib3MFBase* object_ = nullptr;
};

void require(LIB3MFRESULT result, const Handle& of, std::string_view step) {
    if (result == LIB3MF_OK) return;
    DWORD code = 0;
    LPCSTR reason = nullptr;
    NMR::lib3mf_getlasterror(of.get(), &code, &reason);
    throw Error("lib3mf could not {}: {}", step, reason && *reason ? reason : fmt::format("error {}", code))
        .hint("write STL, GLB or VTP");
}

/// Where lib3mf puts the archive: it goes back to fill in sizes.
struct Archive {
    std::string bytes;
    std::size_t at = 0;

    static unsigned write(BYTE* data, unsigned size, void* archive) try {
        auto& [bytes, at] = *static_cast<Archive*>(archive);
        if (bytes.size() < at + size) bytes.resize(at + size);
        std::memcpy(bytes.data() + at, data, size);
        at += size;
        return 0;
    } catch (const std::bad_alloc&) {
        return 1;
    }
    static unsigned seek(ULONG64 position, void* archive) {
        static_cast<Archive*>(archive)->at = position;
        return 0;
    }
};

template <class T>
XXH128_hash_t hash_of(const std::vector<T>& rows, u64 seed) {
    return XXH3_128bits_withSeed(rows.data(), rows.size() * sizeof(T), seed);
}

/// A UUID of version 8 (RFC 9562), the same for the same geometry.
std::string uuid_of(const PrintedMesh& mesh, u64 number) {
    const XXH128_hash_t vertices = hash_of(mesh.vertices, number);
    const XXH128_hash_t hash = hash_of(mesh.triangles, vertices.low64 ^ vertices.high64);
    const u64 high = hash.high64, low = hash.low64;
    return fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", high >> 32, high >> 16 & 0xffff, high & 0xfff,
                       0x8000 | (low >> 48 & 0x3fff), low & 0xffffffffffff);
}

/// As 3MF numbers them.
DWORD unit_of(LengthUnit unit) {
    switch (unit) {
        case LengthUnit::micrometre: return NMR::MODELUNIT_MICROMETER;
        case LengthUnit::centimetre: return NMR::MODELUNIT_CENTIMETER;
        case LengthUnit::metre: return NMR::MODELUNIT_METER;
        case LengthUnit::inch: return NMR::MODELUNIT_INCH;
        case LengthUnit::foot: return NMR::MODELUNIT_FOOT;
        case LengthUnit::millimetre:
        case LengthUnit::unknown: break;
    }
    return NMR::MODELUNIT_MILLIMETER;
}

void add_object(const Handle& model, PrintedMesh& mesh, const std::string& name) {
    Handle object, item;
    require(NMR::lib3mf_model_addmeshobject(model.get(), object.receive()), model, "make an object");
    require(NMR::lib3mf_meshobject_setgeometry(object.get(), mesh.vertices.data(), DWORD(mesh.vertices.size()),
                                               mesh.triangles.data(), DWORD(mesh.triangles.size())),
            object, "take the mesh");
    if (!name.empty())
        require(NMR::lib3mf_object_setnameutf8(object.get(), name.c_str()), object, "take the frame's name");
    require(NMR::lib3mf_object_setuuidutf8(object.get(), uuid_of(mesh, 1).c_str()), object, "take a UUID");
    NMR::MODELTRANSFORM transform{};
    for (int axis = 0; axis < 3; ++axis) {
        transform.m_fFields[axis][axis] = 1;
        transform.m_fFields[axis][3] = mesh.place[axis];
    }
    const bool is_moved = mesh.place != Eigen::Vector3f::Zero();
    require(NMR::lib3mf_model_addbuilditem(model.get(), object.get(), is_moved ? &transform : nullptr, item.receive()),
            model, "add the object");
    require(NMR::lib3mf_builditem_setuuidutf8(item.get(), uuid_of(mesh, 2).c_str()), item, "take a UUID");
    require(NMR::lib3mf_model_setbuilduuidutf8(model.get(), uuid_of(mesh, 3).c_str()), model, "take a UUID");
}

}  // namespace

void write_threemf(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh mesh = with_used_vertices(*value.get<TriangleMesh>(), "3MF", options);
    require_solid(mesh);
    tell_bare_triangles(mesh, "3MF", options);
    if (mesh.frame.unit == LengthUnit::unknown)
        warn(options.on_warning,
             "3MF needs a unit and none is known: 1 was written as 1 mm; say the unit, as with --unit mm");
    PrintedMesh shape = printed(mesh, options);
    Handle model, writer;
    require(NMR::lib3mf_createmodel(model.receive()), model, "begin");
    require(NMR::lib3mf_model_setunit(model.get(), unit_of(mesh.frame.unit)), model, "take the unit");
    add_object(model, shape, valid_text(mesh.frame.name));
    require(NMR::lib3mf_model_querywriter(model.get(), "3mf", writer.receive()), model, "make a writer");
    Archive archive;
    require(NMR::lib3mf_writer_writetocallback(writer.get(), reinterpret_cast<void*>(&Archive::write),
                                               reinterpret_cast<void*>(&Archive::seek), &archive),
            writer, "write it");
    write_plain_zip(archive.bytes, out);
}

}  // namespace scanmill::threemf
