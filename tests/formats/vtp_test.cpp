// SPDX-License-Identifier: GPL-3.0-or-later
// VTP: VTK reads points and meshes exactly as written.

#include <limits>

#include "formats/vtk_support.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PointCloud two_points() {
    PointCloud cloud;
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
    return cloud;
}

template <class T>
void expect_type_kept(int vtk_type) {
    PointCloud cloud = two_points();
    const T highest = std::numeric_limits<T>::max();
    cloud.columns.add(Column("a", 1, Buffer<T>{T(7), highest}));
    const auto data = through_vtp(cloud);
    auto* const array = data->GetPointData()->GetArray("a");
    ASSERT_TRUE(array) << vtk_type;
    EXPECT_EQ(array->GetDataType(), vtk_type);
    EXPECT_EQ(static_cast<const T*>(array->GetVoidPointer(1))[0], highest);
}

TEST(VtpWriter, EveryType_IsKept) {
    expect_type_kept<std::int8_t>(VTK_TYPE_INT8);
    expect_type_kept<std::uint8_t>(VTK_TYPE_UINT8);
    expect_type_kept<std::int16_t>(VTK_TYPE_INT16);
    expect_type_kept<std::uint16_t>(VTK_TYPE_UINT16);
    expect_type_kept<std::int32_t>(VTK_TYPE_INT32);
    expect_type_kept<std::uint32_t>(VTK_TYPE_UINT32);
    expect_type_kept<std::int64_t>(VTK_TYPE_INT64);
    expect_type_kept<std::uint64_t>(VTK_TYPE_UINT64);
    expect_type_kept<float>(VTK_TYPE_FLOAT32);
    expect_type_kept<double>(VTK_TYPE_FLOAT64);
}

TEST(VtpWriter, Points_AreCells_AndWellKnownColumnsAreMarked) {
    PointCloud cloud = two_points();
    cloud.frame = {LengthUnit::millimetre, Vec3::Zero(), "bench \"A\" <1>"};
    cloud.columns.add(Column("normal", 3, Buffer<float>{0, 0, 1, 0, 1, 0}));
    cloud.columns.add(Column("colour", 4, Buffer<u8>{1, 2, 3, 4, 5, 6, 7, 8}));
    cloud.columns.add(Column("texture", 2, Buffer<double>{0.25, 0.5, 0.75, 1}));
    cloud.columns.add(Column("histogram", 5, Buffer<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}));
    Warnings warnings;
    const auto data = through_vtp(cloud, &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_THAT(cells_in(data->GetVerts()), ElementsAre(ElementsAre(0), ElementsAre(1)));
    EXPECT_EQ(point_in(data, 1), Vec3(4, 5, 6));
    EXPECT_EQ(data->GetPoints()->GetDataType(), VTK_DOUBLE);
    vtkPointData* columns = data->GetPointData();
    EXPECT_EQ(columns->GetNumberOfArrays(), 4);
    EXPECT_THAT(numbers_in(columns->GetNormals()), ElementsAre(0, 0, 1, 0, 1, 0));
    EXPECT_THAT(numbers_in(columns->GetScalars()), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_THAT(numbers_in(columns->GetTCoords()), ElementsAre(0.25, 0.5, 0.75, 1));
    EXPECT_EQ(columns->GetArray("histogram")->GetNumberOfComponents(), 5);
    EXPECT_EQ(columns->GetArray("histogram")->GetComponent(1, 4), 10);
    EXPECT_THAT(texts_in(data->GetFieldData(), "unit"), ElementsAre("mm"));
    EXPECT_THAT(texts_in(data->GetFieldData(), "frame"), ElementsAre("bench \"A\" <1>"));
    EXPECT_FALSE(data->GetFieldData()->GetArray("origin"));
}

TEST(VtpWriter, FarFromZero_MicrometresAreKept) {
    PointCloud cloud;
    cloud.frame = {LengthUnit::metre, Vec3(5e5, 5.5e6, -64), ""};
    cloud.positions = {Vec3(1e-6, 0.25, 0), Vec3(0, 0.125, 3e-6)};
    const auto data = through_vtp(cloud);
    for (vtkIdType row = 0; row < 2; ++row)
        EXPECT_EQ(point_in(data, row), Vec3(cloud.frame.origin + cloud.positions[static_cast<std::size_t>(row)]));
    EXPECT_NE(point_in(data, 0).x(), 5e5);
    EXPECT_THAT(numbers_in(data->GetFieldData()->GetArray("origin")), ElementsAre(5e5, 5.5e6, -64));
    EXPECT_THAT(texts_in(data->GetFieldData(), "frame"), IsEmpty());
}

TEST(VtpWriter, NaN_IsKept) {
    PointCloud cloud = two_points();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    cloud.positions = {Vec3(nan, 2, 3), Vec3(4, 5, 6)};
    cloud.columns.add(Column("quality", 1, Buffer<double>{nan, std::numeric_limits<double>::infinity()}));
    const auto data = through_vtp(cloud);
    EXPECT_TRUE(std::isnan(point_in(data, 0).x()));
    EXPECT_EQ(point_in(data, 1), Vec3(4, 5, 6));
    EXPECT_TRUE(std::isnan(data->GetPointData()->GetArray("quality")->GetComponent(0, 0)));
}

TEST(VtpWriter, Mesh_KeepsColumnsOfFacesAndEdges_AndSharpEdges) {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    mesh.triangles = {{0, 2, 1}, {3, 0, 1}};
    mesh.vertex_columns.add(Column("id", 1, Buffer<std::int64_t>{1, 2, 3, 9007199254740993}));
    mesh.face_columns.add(Column("group", 1, Buffer<std::uint16_t>{7, 9}));
    mesh.edges = {{0, 1}, {1, 3}};
    mesh.edge_columns.add(Column("angle", 1, Buffer<float>{0.5f, 0.25f}));
    mesh.sharp_edges = {{1, 3}};
    Warnings warnings;
    const auto data = through_vtp(mesh, &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    EXPECT_THAT(cells_in(data->GetPolys()), ElementsAre(ElementsAre(0, 2, 1), ElementsAre(3, 0, 1)));
    EXPECT_EQ(data->GetNumberOfVerts(), 0);
    EXPECT_EQ(data->GetNumberOfPoints(), 4);
    const auto* ids = static_cast<const std::int64_t*>(data->GetPointData()->GetArray("id")->GetVoidPointer(0));
    EXPECT_EQ(ids[3], 9007199254740993);
    EXPECT_THAT(numbers_in(data->GetCellData()->GetArray("group")), ElementsAre(7, 9));
    EXPECT_THAT(numbers_in(data->GetFieldData()->GetArray("edges")), ElementsAre(0, 1, 1, 3));
    EXPECT_THAT(numbers_in(data->GetFieldData()->GetArray("edge:angle")), ElementsAre(0.5, 0.25));
    EXPECT_THAT(numbers_in(data->GetFieldData()->GetArray("sharp_edges")), ElementsAre(1, 3));
}

TEST(VtpWriter_Names, WithReservedCharacters_AreKept_AndInvalidTextIsReported) {
    PointCloud cloud = two_points();
    for (const char* name : {"a<b>\"&'", "Größe", "line\nend", "bad\xff", "bad_"})
        cloud.columns.add(Column(name, 1, Buffer<float>{7, 8}));
    Warnings warnings;
    const auto data = through_vtp(cloud, &warnings);
    vtkPointData* columns = data->GetPointData();
    EXPECT_EQ(columns->GetNumberOfArrays(), 5);
    for (const char* name : {"a<b>\"&'", "Größe", "line_end", "bad_", "bad__2"})
        EXPECT_TRUE(columns->GetArray(name)) << name;
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("under the name 'line_end'"), HasSubstr("under the name 'bad_'"),
                            HasSubstr("the column 'bad_' under the name 'bad__2'")));
}

TEST(VtpWriter_Losses, ListsAreReported) {
    PointCloud cloud = two_points();
    cloud.columns.add(Column("seen_by", Buffer<u64>{0, 2, 3}, Buffer<u32>{4, 5, 6}));
    Warnings warnings;
    EXPECT_EQ(through_vtp(cloud, &warnings)->GetPointData()->GetNumberOfArrays(), 0);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("VTP left out the lists of the column 'seen_by'")));
}

TEST(VtpWriter, EqualValues_GiveEqualBytes) {
    const Value mesh = std::make_shared<const TriangleMesh>(geodesic_sphere(2, 8));
    const std::string bytes = write_bytes("a.vtp", mesh);
    EXPECT_EQ(bytes, write_bytes("a.vtp", mesh));
    EXPECT_TRUE(bytes.starts_with("<?xml"));
}

TEST(VtpWriter_Refuses, KindsThatItCannotHold_WithTheFormatsThatCan) {
    TetMesh tets;
    tets.positions = {Vec3(0, 0, 0)};
    const Error error = error_of([&] { write_bytes("a.vtp", std::make_shared<const TetMesh>(tets)); });
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("tets cannot be written with the extension '.vtp'"),
                                             HasSubstr("extensions for it: vtu")));
    EXPECT_THAT(sentence_of([] { write_bytes("a.vtp", std::make_shared<const TriangleMesh>()); }),
                HasSubstr("has no points"));
    PointCloud huge = two_points();
    huge.frame.origin = Vec3::Constant(1e308);
    huge.positions = {Vec3::Constant(1e308)};
    EXPECT_THAT(sentence_of([&] { write_bytes("a.vtp", std::make_shared<const PointCloud>(huge)); }),
                HasSubstr("beyond what VTP can write"));
}

TEST(VtpReader_Refuses, ToRead_WithAMessage) {
    const std::string bytes = write_bytes("a.vtp", std::make_shared<const PointCloud>(two_points()));
    for (const char* name : {"a.vtp", "misnamed.ply"})
        EXPECT_THAT(error_of([&] { read_bytes(bytes, name); }).what(),
                    testing::AllOf(HasSubstr("VTP is written for other programs, and not read"), HasSubstr("PLY")));
}

TEST(VtpWriter, RealMesh_HasItsCountsAndBox) {
    SCANMILL_REAL_SCAN(file, fetched_data, "meshes/fandisk_large.off");
    const auto mesh = read_mesh(file);
    const auto data = through_vtp(*mesh);
    EXPECT_EQ(data->GetNumberOfPoints(), static_cast<vtkIdType>(mesh->positions.size()));
    EXPECT_EQ(data->GetNumberOfPolys(), static_cast<vtkIdType>(mesh->triangles.size()));
    double bounds[6];
    data->GetBounds(bounds);
    const BoundingBox box = bounding_box(mesh->positions.span());
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(bounds[2 * axis], box.low[axis] + mesh->frame.origin[axis]);
        EXPECT_EQ(bounds[2 * axis + 1], box.high[axis] + mesh->frame.origin[axis]);
    }
}

}  // namespace
}  // namespace scanmill::test
