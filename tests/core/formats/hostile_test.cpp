// SPDX-License-Identifier: GPL-3.0-or-later
// Files that are broken or lie. Those in tests/data are named by their defect.
#include <sys/resource.h>

#include <random>

#include "core/formats/support.hpp"
#include "support/folders.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

const fs::path data_folder = fs::path(test::source_folder()) / "tests/data";

struct Defect {
    const char* file;
    const char* warnings;
};

const std::vector<Defect> defects{
    {"empty.ply", "is empty"},
    {"header_only.ply", "promises 3 rows of element 'vertex'"},
    {"header_without_end.ply", "'end_header' is missing"},
    {"truncated_ascii.ply", "line 10: the text ends after 2 of 3 rows"},
    {"truncated_in_a_row_ascii.ply", "line 9: the row ends before the property 'z' in row 1 of element 'vertex'"},
    {"truncated_binary.ply", "the 32 bytes that follow hold at most 2"},
    {"truncated_in_a_list_binary.ply", "ends at byte 214 inside row 0 of 1 of element 'face'"},
    {"face_index_too_large.ply", "face 0 names vertex 3; there are 3"},
    {"face_index_negative.ply", "face 0 names vertex -1"},
    {"list_length_negative.ply", "negative length -3"},
    {"list_length_2_to_31.ply", "inside row 0 of 1 of element 'face'"},
    {"vertices_2_to_40_ascii.ply", "1099511627776 vertices"},
    {"vertices_2_to_40_binary.ply", "1099511627776 vertices"},
    {"vertices_2_to_31_binary.ply", "2147483648 rows of element 'vertex', each at least 12 bytes long; the 12 bytes"},
    {"faces_2_to_40_binary.ply", "1099511627776 rows of element 'face'"},
    {"count_beyond_64_bits.ply", "line 3: expected 'element NAME COUNT'"},
    {"count_negative.ply", "line 3: expected 'element NAME COUNT'"},
    {"property_before_element.ply", "line 3: a property before the first element"},
    {"property_type_unknown.ply", "line 4: the property type 'half' is unknown"},
    {"property_twice.ply", "line 7: the element 'vertex' has two properties called 'x'"},
    {"list_length_of_type_float.ply", "line 8: the length of a list must be"},
    {"element_twice.ply", "line 7: the element 'vertex' is declared twice"},
    {"format_missing.ply", "without a format line"},
    {"format_unknown.ply", "line 2: the format 'binary_middle_endian'"},
    {"keyword_unknown.ply", "line 3: the PLY header has 'elemnt'"},
    {"no_vertices.ply", "holds no points"},
    {"no_vertex_element.ply", "holds no points"},
    {"no_z.ply", "no property 'z'"},
    {"x_is_a_list.ply", "the property 'x' of the element 'vertex' is a list"},
    {"word_for_a_number.ply", "line 9: 'zero'"},
    {"colour_beyond_a_byte.ply", "line 9: '256'"},
    {"edge_index_too_large.ply", "edge 0 names vertex 7"},
    {"garbage.ply", "line 1: a PLY file begins with 'ply'"},
    {"garbage.bin", "is in an unknown format"},
    {"truncated_binary.stl", "promises 2 facets of 50 bytes; the 80 bytes that follow hold 1"},
    {"facets_2_to_32.stl", "promises 4294967295 facets"},
    {"no_facets_binary.stl", "holds no points"},
    {"shorter_than_a_header.stl", "is 33 bytes long"},
    {"no_facets_ascii.stl", "holds no points"},
    {"truncated_ascii.stl", "line 6: the text ends inside facet 0"},
    {"truncated_after_a_facet_ascii.stl", "'endsolid' is missing"},
    {"facet_of_four_corners.stl", "line 7: found 'vertex' inside facet 0; expected 'endloop'"},
    {"corner_of_two_numbers.stl", "line 4: the row ends before a coordinate of a vertex"},
    {"word_for_a_number.stl", "line 4: 'O' is not a number"},
    {"keyword_unknown.stl", "line 3: found 'ring'"},
    {"keyword_only.off", "ends before the numbers"},
    {"blank.off", "holds no points"},
    {"counts_missing.off", "line 2: expected the numbers"},
    {"counts_are_words.off",
     "line 2: expected the keyword OFF or the numbers of vertices, faces and edges, found 'three'"},
    {"no_vertices.off", "holds no points"},
    {"vertices_2_to_40.off", "1099511627776 vertices"},
    {"faces_2_to_40.off", "line 2 promises 1 vertex and 1099511627776 faces"},
    {"truncated_vertices.off", "ends after 3 of 4 vertices"},
    {"truncated_faces.off", "ends after 1 of 2 faces"},
    {"vertex_of_two_numbers.off", "line 4: the row ends before the coordinates of vertex 1"},
    {"word_for_a_number.off", "line 4: 'nil'"},
    {"face_index_too_large.off", "line 6: face 0 names vertex 3; there are 3"},
    {"face_index_negative.off", "line 6: face 0 names vertex '-1'"},
    {"face_too_short.off", "line 6: face 0 has 3 of its 4 corners"},
    {"face_length_2_to_40.off", "line 6: face 0 has 3 of its 1099511627776 corners"},
    {"four_dimensions.off", "'4OFF'"},
    {"binary.off", "binary OFF is not read"},
    {"comments_only.obj", "holds no points: no row is a vertex (v)"},
    {"object_file_of_a_compiler.obj", "which is not an OBJ keyword"},
    {"vertex_of_two_numbers.obj", "line 2: the row ends before a coordinate of a vertex (v)"},
    {"word_for_a_number.obj", "line 2: 'nil' is not a number"},
    {"face_index_too_large.obj", "line 4: a face names vertex 4; there are 3"},
    {"face_index_zero.obj", "line 4: a face names vertex 0"},
    {"face_index_before_the_first.obj", "line 4: a face names vertex -4"},
    {"face_index_2_to_40.obj", "line 4: a face names vertex 1099511627776; there are 3"},
    {"truncated_vertices.obj", "line 2: a face names vertex 4; there are 3"},
    {"blank.xyz", "holds no points"},
    {"two_columns.xyz", "line 1: found 2 columns"},
    {"row_too_short.xyz", "line 5: found 2 columns; the rows before have 3"},
    {"row_too_long.xyz", "line 2: found 4 columns; the rows before have 3"},
    {"word_for_a_number.xyz", "line 2: 'one'"},
    {"no_table.txt", "line 1: 'Dear'"},
    {"names_only.csv", "holds no points"},
    {"count_only.pts", "holds no points"},
    {"more_names_than_columns.csv", "line 2: 3 columns for 4 names"},
};

std::string sentence_for(const fs::path& path) {
    try {
        read_file(path);
    } catch (const Error& error) {
        return error.sentence();
    }
    return "it was read";
}

TEST(Readers_BrokenFile, IsRefusedWithWhatAndWhere) {
    for (const Defect& defect : defects) {
        const fs::path path = data_folder / defect.file;
        EXPECT_THAT(sentence_for(path),
                    testing::AllOf(testing::StartsWith("'" + path.string() + "': "), HasSubstr(defect.warnings)))
            << defect.file;
    }
}

/// The number of broken files that are not refused with an Error when little address space is left. Spoils the process.
int accepted_under_a_tight_limit() {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t limit = pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + (rlim_t(32) << 20);
    const rlimit tight{limit, limit};
    ::setrlimit(RLIMIT_AS, &tight);
    int accepted = 0;
    for (const Defect& defect : defects) {
        try {
            if (sentence_for(data_folder / defect.file) == "it was read") ++accepted;
        } catch (const std::bad_alloc&) {
            ++accepted;
        }
    }
    try {
        // The limit works: twice the remaining memory cannot be allocated.
        const Array<std::byte> large(std::size_t(64) << 20);
        accepted += 100;
    } catch (const std::bad_alloc&) {
    }
    return accepted;
}

TEST(Readers_BrokenFile, TakesNoMemoryForWhatItPromises) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "a sanitizer's shadow needs more address space than the limit leaves";
#endif
    EXPECT_EXIT(::_exit(accepted_under_a_tight_limit()), testing::ExitedWithCode(0), "");
}

/// A valid file of every reader, small enough that damage hits something.
std::vector<std::pair<std::string, std::string>> seeds() {
    std::vector<std::pair<std::string, std::string>> files;
    const TemporaryFolder folder;
    TriangleMesh mesh;
    mesh.frame = {LengthUnit::millimetre, Vec3(1000, 0, 0), "part"};
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    mesh.triangles = {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}};
    mesh.vertex_columns.add(Column("normal", 3, Buffer<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0}));
    mesh.vertex_columns.add(Column("pair", 2, Buffer<u8>{1, 0, 0, 0, 1, 0, 0, 0}));
    mesh.face_columns.add(Column("list", Buffer<u64>{0, 2, 2, 3}, Buffer<double>{1, 2, 3}));
    mesh.edges = {Edge{0, 1}};
    mesh.edge_columns.add(Column("bend", 1, Buffer<u8>{1}));
    mesh.sharp_edges = {Edge{0, 1}};
    const Value value = std::make_shared<const TriangleMesh>(mesh);
    for (const char* name : {"a.ply", "a.stl", "a.off", "a.obj"}) {
        write_file(folder / name, value);
        files.emplace_back(name, content_of(folder / name));
    }
    files.emplace_back(
        "b.ply",
        "ply\nformat ascii 1.0\ncomment unit mm\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty list uchar int near\nelement face 2\nproperty list uchar int vertex_indices\n"
        "property uchar red\nelement tristrips 1\nproperty list int int vertex_index\nend_header\n"
        "0 0 0 1 2\n1 0 0 0\n0 1 0 2 0 1\n3 0 1 2 255\n4 0 1 2 0 7\n5 0 1 2 -1 0\n");
    files.emplace_back(
        "c.ply",
        "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty double x\nproperty short y\nproperty int z\n"
        "element face 1\nproperty list ushort uint vertex_indices\nend_header\n" +
            bytes_of(1.0, true) + bytes_of(std::int16_t(2), true) + bytes_of(3, true) +
            bytes_of(std::uint16_t(3), true) + std::string(12, '\0'));
    files.emplace_back("b.stl",
                       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                       "0\nendloop\nendfacet\nendsolid a\n");
    files.emplace_back("b.off",
                       "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 2 3 0.5 0.5\n1 0 0 0 0 1 1 2 3 0.5 0.5\n0 1 0 0 0 1 1 2 3 1 1 # "
                       "c\n3 0 1 2 9 9 9\n");
    files.emplace_back("b.obj",
                       "# unit mm\nmtllib a.mtl\ng a\nv 0 0 0 1 0.502 0\nv 1 0 0 \\\n 1 1 1\nv 0 1 0 0 0 0\nvt 0 0\n"
                       "vt 1\nvt 0 1\nvn 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1/1/1 2/2/2 3/3/-1\nf 3//3 2//1 1\nl 1 2\n");
    files.emplace_back("a.xyz", "# unit mm\nx,y,z,Intensity\n1,2,3,4\n5,6,7,8\n");
    files.emplace_back("a.pts", "2\n1 2 3 0 0 1\n4 5 6 0 1 0\n");
    return files;
}

/// Reads; whatever comes out must be whole.
bool is_read(const std::string& bytes, const std::string& name) {
    try {
        const LoadedFile loaded = read_bytes(bytes, name);
        if (const auto* mesh = loaded.value.find<TriangleMesh>()) {
            require_consistent(*mesh);
            EXPECT_FALSE(mesh->positions.empty());
        } else {
            const auto& cloud = loaded.value.get<PointCloud>();
            EXPECT_GT(cloud->size(), 0u);
            for (const Column& column : cloud->columns) EXPECT_EQ(column.rows(), cloud->size());
        }
        return true;
    } catch (const Error&) {
        return false;
    }
}

TEST(Readers_DamagedBytes, AreReadOrRefused_NeverMore) {
    std::mt19937 random(11);
    for (const auto& [name, bytes] : seeds()) {
        ASSERT_TRUE(is_read(bytes, name)) << name;
        // Cut anywhere. Whatever is read of a cut text is a shorter number or a missing comment.
        for (std::size_t size = 1; size < bytes.size(); ++size) is_read(bytes.substr(0, size), name);
        for (int round = 0; round < 3000; ++round) {
            std::string damaged = bytes;
            for (u32 hits = 1 + random() % 4; hits > 0; --hits) {
                const std::size_t at = random() % damaged.size();
                switch (random() % 4) {
                    case 0: damaged[at] = static_cast<char>(random()); break;
                    case 1: damaged[at] = "0123456789-\n .#"[random() % 15]; break;
                    case 2: damaged.erase(at, 1 + random() % 8); break;
                    default: damaged.insert(at, damaged, random() % damaged.size(), random() % 20); break;
                }
                if (damaged.empty()) damaged = "x";
            }
            is_read(damaged, name);
        }
    }
}

TEST(Readers_CutBinary, IsAlwaysRefused) {
    for (const auto& [name, bytes] : seeds()) {
        if (name != "a.ply" && name != "c.ply" && name != "a.stl") continue;
        for (std::size_t size = 1; size < bytes.size(); ++size)
            EXPECT_FALSE(is_read(bytes.substr(0, size), name)) << name << " " << size;
    }
}

}  // namespace
}  // namespace scanmill::test
