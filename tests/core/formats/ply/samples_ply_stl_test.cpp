// SPDX-License-Identifier: GPL-3.0-or-later
// PLY and STL files from other programs' collections, ordinary and odd. Their counts and areas were found with another
// program: polygons cut into fans, the triangles' areas summed, an STL file's equal corners made one.
#include "core/formats/mesh_samples_support.hpp"

namespace scanmill::test {
namespace {

const char* const six_quads = "6 faces of more than three corners were cut into fans; the mesh has 12 triangles";
const char* const solids = "18 faces of more than three corners were cut into fans; the mesh has 80 triangles";
const char* const no_facets = "holds no points: the STL file has no facets";

const std::vector<MeshSample> ply_samples{
    {"odd/assimp_cube_binary_header_with_RN_newline.ply", "the header's lines end with CR LF, the bytes are binary", 8,
     12, 6},
    {"odd/assimp_cube_binary_starts_with_nl.ply", "the first binary byte is that of a line feed", 8, 12, 6, six_quads},
    {"odd/assimp_cube_uv.ply", "a cube of quads with texture coordinates", 24, 12, 23.999998000001998, six_quads},
    {"odd/assimp_float-color.ply", "colours as fractions of type float", 3, 1, 10000},
    {"odd/assimp_issue623.ply", "the header lists the vertices' faces, the rows do not", 0, 0, 0,
     "line 14: the row ends before the property 'vertex_indices' in row 0 of element 'vertex'"},
    {"odd/loadersgl_bunny_tristrips.ply", "one strip of triangles, cut by -1", 34834, 69451, 0.057128783419099737},
    {"odd/pcu_bunny_duplicates.ply", "vertices at one place", 2895, 5766, 2.302284004242078},
    {"odd/pcu_duplicated_pcloud.ply", "points at one place, with normals", 5395, 0, 0},
    {"odd/pdal_issue_2421.ply", "one point far from the origin", 1, 0, 0},
    {"odd/pdal_no_vertex.ply", "a header without an element", 0, 0, 0, "the PLY header has no element 'vertex'"},
    {"odd/pdal_sized_dims.ply", "x and y only", 0, 0, 0, "has no property 'z'; positions need x, y and z"},
    {"odd/pdal_text_extradim.ply", "one point; its blue is signed, and it has a column of its own", 1, 0, 0},
    {"odd/pdal_unsized_dims.ply", "x and y only", 0, 0, 0, "has no property 'z'; positions need x, y and z"},
    {"odd/trimesh_cube_blender_uv.ply", "a cube of quads with texture coordinates", 24, 12, 6, six_quads},
    {"odd/trimesh_empty.ply", "no vertex, no face", 0, 0, 0,
     "holds no points: the PLY header declares 'element vertex 0'"},
    {"odd/trimesh_metadata.ply", "faces with a number after their list", 4, 2, 64},
    {"odd/trimesh_mirror.ply", "a mesh that was mirrored", 143, 286, 1.6270228678953544},
    {"odd/trimesh_multi.ply", "texture and colours by vertex", 4, 2, 4,
     "1 face of more than three corners was cut into fans; the mesh has 2 triangles"},
    {"odd/trimesh_ply_empty_ascii.ply", "no vertex, no face", 0, 0, 0, "the PLY header declares 'element vertex 0'"},
    {"odd/trimesh_ply_empty_bin.ply", "no vertex, no face", 0, 0, 0, "the PLY header declares 'element vertex 0'"},
    {"odd/trimesh_ply_empty_header.ply", "a header without an element", 0, 0, 0, "has no element 'vertex'"},
    {"odd/trimesh_ply_points_ascii.ply", "points, no element of faces", 8, 0, 0},
    {"odd/trimesh_ply_points_bin.ply", "points with normals; an element of no faces", 8, 0, 0},
    {"odd/trimesh_points_ascii_with_lists.ply", "an element of another program's", 5, 0, 0,
     "the element 'point_list' with its 2 rows was left out"},
    {"odd/trimesh_points_emptyascii.ply", "empty lines at the end and text after them", 12, 0, 0,
     "the text from line 23 on belongs to no element and was ignored"},
    {"odd/trimesh_points_emptyface.ply", "an element of no faces", 1024, 0, 0},
    {"ok/assimp_cube.ply", "a cube of quads", 8, 12, 6, six_quads},
    {"ok/assimp_cube_binary.ply", "a cube", 8, 12, 6},
    {"ok/assimp_points.ply", "points with colours and normals", 4, 0, 0},
    {"ok/cgal_colored_tetra.ply", "columns of vertices, faces and edges", 4, 4, 2.3660254037844384},
    {"ok/cgal_colors.ply", "points with colours and an intensity", 3, 0, 0},
    {"ok/cgal_example.ply", "points with an intensity and a label", 3, 0, 0},
    {"ok/draco_cube_att.ply", "texture coordinates as a list of each face", 24, 12, 6},
    {"ok/draco_int_point_cloud.ply", "coordinates of type int", 16, 0, 0},
    {"ok/draco_point_cloud_test_pos.ply", "points", 4, 0, 0},
    {"ok/draco_point_cloud_test_pos_norm.ply", "points with normals", 4, 0, 0},
    {"ok/draco_test_pos_color.ply", "colours with opacity", 114, 224, 12.166689023487784},
    {"ok/draco_test_pos_color_ascii.ply", "colours with opacity", 114, 224, 12.166687882039541},
    {"ok/happly_platonic_shelf.ply", "the five solids: triangles, quads and pentagons", 50, 80, 43.06020815038672,
     solids},
    {"ok/happly_platonic_shelf_ascii.ply", "the same as text", 50, 80, 43.06020815038672, solids},
    {"ok/happly_platonic_shelf_big_endian.ply", "the same, high bytes first", 50, 80, 43.06020815038672, solids},
    {"ok/pcu_truck.ply", "colours of faces", 5240, 9868, 0.6660340518274457},
    {"ok/pdal_mesh.ply", "two triangles", 4, 2, 2},
    {"ok/pdal_mesh_fixed.ply", "two triangles", 4, 2, 2},
    {"ok/pdal_simple_binary.ply", "points", 3, 0, 0},
    {"ok/pdal_simple_text.ply", "points", 3, 0, 0},
    {"ok/trimesh_BoxTextured.ply", "normals and texture coordinates", 24, 12, 6},
    {"ok/trimesh_fuze_ascii.ply", "every row of a face has a number too many", 502, 1000, 0.04472226039802642,
     "1000 rows of element 'face' hold more values than the header has properties, first in line 523"},
    {"ok/trimesh_plane.ply", "a quad", 4, 2, 4, "1 face of more than three corners was cut"},
    {"ok/trimesh_plane_tri.ply", "two triangles", 4, 2, 4},
    {"ok/trimesh_points_ascii.ply", "points", 5, 0, 0},
    {"ok/trimesh_points_bin.ply", "points", 5, 0, 0},
    {"ok/trimesh_reference.ply", "colours with opacity", 845, 1610, 39159.76697193823},
    {"ok/trimesh_sphere.ply", "a sphere", 642, 1280, 12.506491361696755},
    {"ok/trimesh_suzanne.ply", "triangles and quads", 1966, 968, 12.461907656603382,
     "468 faces of more than three corners were cut into fans; the mesh has 968 triangles"},
    {"ok/trimesh_tet.ply", "a tetrahedron", 4, 4, 8.94427190999916},
};

const std::vector<MeshSample> stl_samples{
    {"odd/trimesh_busted.STL", "a mesh that is not closed", 1941, 3878, 349.2797873660165},
    {"odd/trimesh_empty.stl", "text without a facet", 0, 0, 0, no_facets},
    {"odd/trimesh_origin_inside.STL", "binary, and its header begins with 'solid'", 16, 28, 6.5},
    {"odd/trimesh_shared.STL", "two boxes that share an edge", 14, 24, 12},
    {"odd/trimesh_soup.stl", "a hundred triangles without a common corner", 300, 100, 14.578912785299483},
    {"odd/trimesh_stl_empty_ascii.stl", "text without a facet", 0, 0, 0, no_facets},
    {"odd/trimesh_stl_empty_bin.stl", "a header and a count of none", 0, 0, 0, no_facets},
    {"odd/trimesh_two_objects_mixed_case_names.stl", "two solids, names with capitals", 16, 24, 12},
    {"ok/assimp_3DSMaxExport.STL", "binary", 1042, 2000, 1734.415734059613},
    {"ok/assimp_Spider_ascii.stl", "text; 56 triangles have two corners at one place", 722, 1368, 56.947580588890844,
     "56 of 1368 facets are degenerate"},
    {"ok/assimp_Spider_binary.stl", "the same, binary", 722, 1368, 56.947582703753575,
     "56 of 1368 facets are degenerate"},
    {"ok/assimp_triangle.stl", "a triangle", 3, 1, 2},
    {"ok/cgal_sphere.stl", "binary, every facet with an attribute", 162, 320, 3.0826796616724255},
    {"ok/draco_test_sphere.stl", "binary", 114, 224, 12.166689023488033},
    {"ok/draco_test_sphere_ascii.stl", "text", 114, 224, 12.166688832023516},
    {"ok/gc_stl_box_ascii.stl", "its name is in quotes", 8, 12, 600},
    {"ok/gc_stl_box_binary.stl", "binary, and its header holds a name in quotes", 8, 12, 600},
    {"ok/trimesh_20mm-xyz-cube.stl", "a colour in the header, attributes of the facets", 132, 260, 2499.024876576884},
    {"ok/trimesh_multibody.stl", "two solids", 20, 32, 0.3672389511999289},
    {"ok/trimesh_torus.STL", "binary, and its header begins with 'solid'", 4350, 8700, 19.71550930916242},
    {"ok/trimesh_unit_cube.STL", "binary, and its header begins with 'solid'", 8, 12, 6},
};

/// "name:components" of each, in the order of the file.
std::string names_of(const ColumnTable& columns) {
    std::string names;
    for (const Column& column : columns)
        names += (names.empty() ? "" : " ") + column.name() + ":" + std::to_string(column.components());
    return names;
}

TEST(PlyReader_Samples, AreReadOrRefused_AsAnotherProgramFoundThem) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/ply");
    expect_as_stated(ply_samples, folder);
}

TEST(StlReader_Samples, AreReadOrRefused_AsAnotherProgramFoundThem) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/stl");
    expect_as_stated(stl_samples, folder);
}

TEST(PlyReader_Samples, ColumnsOfSome_AreThese) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/ply");
    const auto tetra = read_mesh(folder / "ok/cgal_colored_tetra.ply");
    EXPECT_EQ(names_of(tetra->vertex_columns), "normal:3 colour:3 id:1");
    EXPECT_EQ(names_of(tetra->face_columns), "colour:3 label:1");
    EXPECT_EQ(names_of(tetra->edge_columns), "confidence:1");
    EXPECT_EQ(names_of(read_mesh(folder / "odd/trimesh_multi.ply")->vertex_columns), "s:1 t:1 colour:3");
    EXPECT_EQ(names_of(read_mesh(folder / "ok/pcu_truck.ply")->face_columns), "colour:4");
    // Red is unsigned and blue signed: they are not one colour, and both columns are kept.
    EXPECT_EQ(names_of(read_points(folder / "odd/pdal_text_extradim.ply")->columns),
              "normal:3 red:1 green:1 blue:1 alpha:1 omg:1");
    EXPECT_EQ(world_of(*read_points(folder / "odd/pdal_issue_2421.ply"), 0),
              Vec3(1.23457, 12345.6789, 1234567890.12345));
}

TEST(StlReader_Samples, ColumnsOfSome_AreThese) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/stl");
    const auto two = read_mesh(folder / "ok/trimesh_multibody.stl");
    EXPECT_EQ(names_of(two->face_columns), "solid:1");
    EXPECT_EQ(two->face_columns.find("solid")->number(31), 1);
    EXPECT_EQ(names_of(read_mesh(folder / "ok/cgal_sphere.stl")->face_columns), "attribute:1");
}

}  // namespace
}  // namespace scanmill::test
