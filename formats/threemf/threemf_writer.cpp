// SPDX-License-Identifier: GPL-3.0-or-later
#include <Model/COM/NMR_DLLInterfaces.h>
#include <Model/Classes/NMR_ModelTypes.h>
#include <xxhash.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/rounding.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"
#include "threemf/plain_zip.hpp"
#include "threemf/threemf.hpp"

namespace scanmill::threemf {

namespace {

/// A mesh as 3MF writes it: with coordinates of six decimals.
struct WrittenMesh {
    /// The translation of the object, whose numbers are exact in six digits. A vertex plus this is the world position.
    Eigen::Vector3f offset = Eigen::Vector3f::Zero();
    std::vector<NMR::MODELMESHVERTEX> vertices;
    std::vector<NMR::MODELMESHTRIANGLE> triangles;
};

/// Six times the volume, relative to the first vertex.
double six_volumes(const TriangleMesh& mesh) {
    const Vec3 base = mesh.positions[mesh.triangles[0][0]];
    double sum = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 a = mesh.positions[triangle[0]] - base, b = mesh.positions[triangle[1]] - base,
                   c = mesh.positions[triangle[2]] - base;
        sum += a.dot(b.cross(c));
    }
    return sum;
}

constexpr double decimals = 1e6;  // lib3mf writes six of them

/// The number that lib3mf writes for a float: it truncates after the sixth decimal, in single precision.
double as_written(float number) {
    return std::trunc(static_cast<double>(number * static_cast<float>(decimals))) / decimals;
}

/// The float for which lib3mf writes the text nearest to the number.
float for_writing(double number) {
    const float nearest = static_cast<float>(number);
    float best = nearest;
    for (const double above : {0.5 / decimals, 1 / decimals}) {
        const float candidate = static_cast<float>(number + std::copysign(above, number));
        if (std::abs(as_written(candidate) - number) < std::abs(as_written(best) - number)) best = candidate;
    }
    return best;
}

/// A number near this one that is exact in the six digits that lib3mf writes for a transform, for readers in single and
/// in double precision.
float short_number(double number) {
    constexpr double six_digits = 999999.5, whole_floats = 1 << 24;
    double step = 1, digits = std::abs(number), odd = digits;
    for (; digits >= six_digits; digits /= 10) step *= 10;
    // The step is 2^k 5^k; its powers of 2 are no digits of a float.
    for (double ten = 1; ten < step; ten *= 10) odd /= 2;
    for (; odd >= whole_floats; odd /= 2) step *= 2;
    return static_cast<float>(std::round(number / step) * step);
}

Eigen::Vector3f offset_of(const TriangleMesh& mesh) {
    BoundingBox box = bounding_box(mesh.positions.span());
    box.low += mesh.frame.origin;
    box.high += mesh.frame.origin;
    return distant_origin(box).unaryExpr(&short_number);
}

/// Warns about triangles whose different corners are written with equal coordinates. Throws Error when all are.
void warn_of_collapsed(const TriangleMesh& mesh, const std::vector<NMR::MODELMESHVERTEX>& vertices,
                       const WriteOptions& options) {
    const auto vertex_in_file = [&](std::size_t vertex) {
        const auto& at = vertices[vertex].m_fPosition;
        return Vec3(as_written(at[0]), as_written(at[1]), as_written(at[2]));
    };
    const u64 collapsed = collapsed_triangles(mesh, joined_vertices(mesh, vertex_in_file));
    if (collapsed == 0) return;
    if (collapsed == mesh.triangles.size())
        throw Error("nothing is left of the object: its diagonal is {:.3g} {}, and 3MF is written with six decimals",
                    surface_box(mesh).diagonal(), symbol(mesh.frame.unit))
            .hint("convert it to a smaller unit first, such as um")
            .remedy(Remedy::convert_unit);
    warn(options.on_warning,
         "{} of {} collapsed: corners that differ are equal in 3MF's six decimals; a smaller unit "
         "keeps them apart",
         count_text(collapsed, "triangle", "triangles"), mesh.triangles.size());
}

/// Throws Error, with numbers, unless the mesh is a closed, oriented manifold whose triangles face outwards, with
/// finite coordinates.
void require_solid(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) throw Error("nothing to write: the mesh has no triangles, and 3MF holds solids only");
    require_finite(mesh.positions.span(), "vertices");
    const MeshTopology found = topology(mesh);
    if (!found.closed)
        throw Error(
            "3MF holds closed, oriented manifolds only; the mesh has {} in {}, {} in three or more triangles, {} "
            "disagree, {} of several fans and {} a vertex twice",
            count_text(found.boundary_edges, "boundary edge", "boundary edges"),
            count_text(found.boundary_loops, "loop", "loops"), count_text(found.nonmanifold_edges, "edge", "edges"),
            count_text(found.misoriented_edges, "edge whose two triangles", "edges whose two triangles"),
            count_text(found.nonmanifold_vertices, "vertex", "vertices"),
            count_text(found.degenerate_triangles, "triangle that names", "triangles that name"))
            .hint("STL, GLB and VTP hold open meshes; alpha-solid makes closed ones from points");
    const double volume = six_volumes(mesh) / 6;
    if (volume == 0)
        throw Error("3MF holds solids only; the volume of the mesh is 0, so it has no inside")
            .hint("STL, GLB and VTP hold meshes of any shape");
    if (!(volume > 0))
        throw Error("3MF holds solids only; the mesh encloses the volume {:.6g}: its triangles do not face outwards",
                    volume)
            .hint("reverse the triangles, or write STL, GLB or VTP");
}

/// Warns when coordinates move by more than a millionth of the diagonal.
WrittenMesh written(const TriangleMesh& mesh, const WriteOptions& options) {
    constexpr double most = 1e9, bearable = 1e-6;
    WrittenMesh result;
    result.offset = offset_of(mesh);
    const Vec3 shift = mesh.frame.origin - result.offset.cast<double>();
    result.vertices.reserve(mesh.positions.size());
    double moved = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 local = shift + mesh.positions[i];
        NMR::MODELMESHVERTEX& vertex = result.vertices.emplace_back();
        for (int axis = 0; axis < 3; ++axis) {
            if (!(std::abs(local[axis]) < most))
                throw Error("vertex {} has the coordinate {}, and 3MF's library supports none beyond {}", i,
                            number_text(world(mesh.frame, mesh.positions[i])[axis]), number_text(most))
                    .hint("write STL, GLB or VTP, or change the unit");
            const float number = for_writing(local[axis]);
            vertex.m_fPosition[axis] = number;
            moved = std::max(moved, std::abs(as_written(number) - local[axis]));
        }
    }
    const double diagonal = bounding_box(mesh.positions.span()).diagonal();
    if (moved > bearable * diagonal)
        warn(options.on_warning,
             "coordinates moved by up to {:.2g}, {:.2g} of the diagonal: 3MF is written in single precision with six "
             "decimals; a smaller unit keeps more of them",
             moved, moved / diagonal);
    warn_of_collapsed(mesh, result.vertices, options);
    result.triangles.reserve(mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
        result.triangles.push_back({{triangle[0], triangle[1], triangle[2]}});
    return result;
}

// Through lib3mf.

/// An object of lib3mf, released by the destructor.
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

/// The output of lib3mf, which seeks back to write sizes.
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
std::string uuid_of(const WrittenMesh& mesh, u64 number) {
    const XXH128_hash_t vertices = hash_of(mesh.vertices, number);
    const XXH128_hash_t hash = hash_of(mesh.triangles, vertices.low64 ^ vertices.high64);
    const u64 high = hash.high64, low = hash.low64;
    return fmt::format("{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}", high >> 32, high >> 16 & 0xffff, high & 0xfff,
                       0x8000 | (low >> 48 & 0x3fff), low & 0xffffffffffff);
}

/// The number of the unit in 3MF.
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

void add_object(const Handle& model, WrittenMesh& mesh, const std::string& name) {
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
        transform.m_fFields[axis][3] = mesh.offset[axis];
    }
    const bool is_moved = mesh.offset != Eigen::Vector3f::Zero();
    require(NMR::lib3mf_model_addbuilditem(model.get(), object.get(), is_moved ? &transform : nullptr, item.receive()),
            model, "add the object");
    require(NMR::lib3mf_builditem_setuuidutf8(item.get(), uuid_of(mesh, 2).c_str()), item, "take a UUID");
    require(NMR::lib3mf_model_setbuilduuidutf8(model.get(), uuid_of(mesh, 3).c_str()), model, "take a UUID");
}

}  // namespace

void write_threemf(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh mesh = with_used_vertices(*value.get<TriangleMesh>(), "3MF", options);
    require_solid(mesh);
    warn_bare_triangles(mesh, "3MF", options);
    if (mesh.frame.unit == LengthUnit::unknown)
        warn(options.on_warning,
             "3MF needs a unit and none is known: 1 was written as 1 mm; declare the scan's unit to avoid this");
    WrittenMesh shape = written(mesh, options);
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
