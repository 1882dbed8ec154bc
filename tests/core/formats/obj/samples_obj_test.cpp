// SPDX-License-Identifier: GPL-3.0-or-later
// OBJ and OFF files from other programs' collections, ordinary and odd. Their counts and areas were found with another
// program: polygons cut into fans, the triangles' areas summed.
#include "core/formats/mesh_samples_support.hpp"
#include "support/numbers.hpp"

namespace scanmill::test {
namespace {

const char* const no_points = "holds no points: no row is a vertex (v)";
const char* const normals_differ = "the normals (vn) were left out: at 8 of 8 vertices they differ";

const std::vector<MeshSample> obj_samples{
    {"odd/draco_degenerate_mesh.obj", "three corners at one place", 3, 1, 0},
    {"odd/draco_eof_test.obj", "the last line has no end", 3, 1, 0.095},
    {"odd/draco_extra_vertex.obj", "a vertex that no face names; all normals are zero", 10, 3, 0.012797993365},
    {"odd/draco_inf_nan.obj", "coordinates +inf, -Inf, nan, -nan, -NaN", 3, 1, nan},
    {"odd/draco_multiple_isolated_triangles.obj", "triangles without a common vertex", 15, 5, 0.025},
    {"odd/draco_multiple_tetrahedrons.obj", "five separate tetrahedra", 20, 20, 0.11123724356957963},
    {"odd/draco_non_manifold_wrap.obj", "four faces at one edge", 10, 12, 4.295445115010333},
    {"odd/pdal_no_vertex.obj", "a comment, nothing else", 0, 0, 0, no_points},
    {"odd/pdal_simple_binary.obj", "text all the same; points with zero normals", 3, 0, 0},
    {"odd/trimesh_cube_compressed.obj", "six normals for eight vertices", 8, 12, 23.999998000002, normals_differ},
    {"odd/trimesh_empty.obj", "a comment, nothing else", 0, 0, 0, no_points},
    {"odd/trimesh_face_in_group_name.obj", "the group is called 'An f Three Other Things'", 1, 0, 0},
    {"odd/trimesh_jacked.obj", "corners like 2/2/ and a material library that does not exist", 8, 12, 6,
     "1 material library (mtllib) was not read: materials and their images were left out, the first of "
     "'nonexistent.mtl'"},
    {"odd/trimesh_joined_tetrahedra.obj", "every vertex with every normal; tetrahedra that share a face", 5, 8,
     8.407551204079054, "at 5 of 5 vertices they differ"},
    {"odd/trimesh_nancolor.obj", "one vertex' colour is nan nan nan; lines end with CR LF", 8, 12, 6,
     "the colours of the vertices are not bytes; they are kept as columns of numbers: red, green, blue"},
    {"odd/trimesh_negative_indices.obj", "all faces are numbered backwards", 8, 12, 24, normals_differ},
    {"odd/trimesh_not_convex.obj", "every triangle has vertices of its own", 288, 96, 3.51509076},
    {"odd/trimesh_notenoughindices.obj", "a face of two corners like 1//", 3, 1, 250000,
     "1 face of fewer than three corners was left out"},
    {"odd/trimesh_obj_empty.obj", "comments, nothing else", 0, 0, 0, no_points},
    {"odd/trimesh_obj_points.obj", "vertices only", 8, 0, 0},
    {"odd/trimesh_obj_wireframe.obj", "vertices and lines", 8, 0, 0, "12 lines (l) were left out, first in line 12"},
    {"odd/trimesh_polygonfaces.obj", "a pentagon that is not flat", 5, 3, 1353553.3905932738,
     "1 face of more than three corners was cut into fans; the mesh has 3 triangles"},
    {"odd/trimesh_singlevn.obj", "one normal for all corners", 4, 2, 1e6, "1 material library (mtllib)"},
    {"odd/trimesh_two_objects.obj", "vertices of the second object follow the faces of the first", 12, 16,
     8.36602540378444, "2 objects (o) were merged"},
    {"odd/trimesh_wallhole.obj", "a material without a name; vertices repeated at seams", 92, 66, 761.4213562373095,
     "13 faces of more than three corners were cut"},
    {"ok/assimp_box.obj", "a cube of quads", 8, 12, 6, "6 faces of more than three corners"},
    {"ok/assimp_cube_with_vertexcolors.obj", "colours as fractions of five digits", 8, 12, 6, normals_differ},
    {"ok/assimp_spider.obj", "groups and materials", 762, 1368, 33275.8521177415,
     "19 groups (g), 4 materials (usemtl), 2 smoothing groups (s) were merged"},
    {"ok/draco_cube_quads.obj", "a cube of quads, normals and texture of the sides", 8, 12, 6, normals_differ},
    {"ok/loadersgl_cube.obj", "every side its smoothing group", 8, 12, 6, "6 smoothing groups (s) were merged"},
    {"ok/pdal_box.obj", "a cube of quads", 8, 12, 6, "6 faces of more than three corners"},
    {"ok/pdal_box_texture.obj", "a cube of quads, normals and texture of the corners", 8, 12, 6, "6 faces of more"},
    {"ok/trimesh_cube.OBJ", "the extension in capitals", 8, 12, 6},
    {"ok/trimesh_ico4.obj", "a sphere, normals of its faces", 642, 1280, 12.50617583124878,
     "the normals (vn) were left out: at 642 of 642 vertices they differ"},
    {"ok/trimesh_rabbit.obj", "objects and groups of equal names, polygons", 644, 1252, 32.96545745222053,
     "9 objects (o), 9 groups (g) were merged"},
};

const std::vector<MeshSample> off_samples{
    {"odd/cgal_P.off", "the letter P as a ring of triangles to hexagons", 26, 52, 36.742640687119284,
     "23 faces of more"},
    {"odd/cgal_blobby-shuffled.off", "comments before the keyword; the triangles are turned at random", 2027, 4050,
     0.7766036968948719},
    {"odd/cgal_corner_with_hole.off", "thirteen squares with a boundary of four edges", 16, 26, 13, "13 faces of more"},
    {"odd/cgal_cubes.off", "two cubes that share an edge", 14, 24, 12},
    {"odd/cgal_degenerated-sd.off", "eight open pieces, four triangles without area; lines end with blanks", 7068,
     13477, 482.91199761956653},
    {"odd/cgal_degtri_sliding.off", "four of the triangles have no area", 8, 8, 8},
    {"odd/cgal_hole.off", "closed, of genus one, triangles and quads", 20, 40, 3012.5952139957644, "12 faces of more"},
    {"odd/cgal_kitten.off", "points without a face", 5210, 0, 0},
    {"odd/cgal_mesh_with_colors.off", "colours of vertices and faces, each followed by a comment", 8, 6, 4,
     "1 face of more"},
    {"odd/cgal_negative.off", "six triangles with a boundary", 7, 6, 2851.3248496943493},
    {"odd/cgal_non_manifold_face_graph.off", "three pieces with repeated points, triangles and quads", 24, 21, 7.5,
     "10 faces of more"},
    {"odd/cgal_open_cube.off", "a cube without its lid", 8, 10, 50000},
    {"odd/cgal_quads_to_stitch.off", "quads along a seam of repeated points", 20, 16, 2, "8 faces of more"},
    {"odd/cgal_tetra_intersected_by_triangle.off", "a triangle that cuts a tetrahedron", 7, 5, 2.8637829014324563},
    {"odd/trimesh_comments.off", "comments between keyword and counts; face colours", 8, 12, 32.00000429959734,
     "6 faces of more"},
    {"odd/trimesh_whitespace.off", "blanks before OFF8 6 12", 8, 12, 32.00000429959734, "6 faces of more"},
    {"ok/assimp_Cube.off", "a cube of quads", 8, 12, 6, "6 faces of more"},
    {"ok/assimp_Wuson.off", "179 pieces along seams of repeated points", 3205, 3732, 9.025803910139024},
    {"ok/cgal_3torus.off", "of genus three, quads", 19, 46, 19.690221567981347, "23 faces of more"},
    {"ok/cgal_cube.off", "a cube", 8, 12, 24},
    {"ok/cgal_cube_quad.off", "a cube of quads", 8, 12, 24, "6 faces of more"},
    {"ok/cgal_eight.off", "of genus two", 315, 634, 1.018274738242973},
    {"ok/cgal_sphere.off", "a sphere", 162, 320, 3.0826796622807935},
    {"ok/cgal_tetrahedron.off", "a tetrahedron", 4, 4, 2.3660254037844384},
    {"ok/cgal_torus_quad.off", "a torus of quads", 25, 50, 7.605695223781142, "25 faces of more"},
};

TEST(ObjReader_Samples, AreReadOrRefused_AsAnotherProgramFoundThem) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/obj");
    expect_as_stated(obj_samples, folder);
}

TEST(OffReader_Samples, AreReadOrRefused_AsAnotherProgramFoundThem) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/off");
    expect_as_stated(off_samples, folder);
}

TEST(ObjReader_Samples, ColumnsOfSome_AreThese) {
    SCANMILL_REAL_SCAN(folder, shared_data, "6-formats/obj");
    // 0.48627 0.43137 0.47059 of the first vertex, times 255.
    const auto coloured = read_mesh(folder / "ok/assimp_cube_with_vertexcolors.obj");
    const std::vector<u8> colours = numbers_of<u8>(coloured->vertex_columns.find("colour"));
    ASSERT_EQ(colours.size(), 24u);
    EXPECT_THAT(std::span(colours).first(6), testing::ElementsAre(124, 110, 120, 24, 0, 121));
    const auto odd = read_mesh(folder / "odd/trimesh_nancolor.obj");
    EXPECT_EQ(odd->vertex_columns.find("red")->number(0), 0.5365);
    EXPECT_TRUE(std::isnan(odd->vertex_columns.find("blue")->number(6)));
    const auto flat = read_mesh(folder / "odd/trimesh_singlevn.obj");
    EXPECT_THAT(numbers_of<double>(flat->vertex_columns.find("normal")),
                testing::ElementsAre(0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0));
    EXPECT_THAT(numbers_of<double>(flat->vertex_columns.find("texture")), testing::ElementsAre(0, 0, 1, 0, 1, 1, 0, 1));
}

}  // namespace
}  // namespace scanmill::test
