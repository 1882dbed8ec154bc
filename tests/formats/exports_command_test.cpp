// SPDX-License-Identifier: GPL-3.0-or-later
// Exports by the program: as outputs of a workflow and by `convert`; messages of `info`, and those about a wrong kind
// and a full disk.

#include "formats/assimp_support.hpp"
#include "formats/vtk_support.hpp"
#include "support/program.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string sphere = R"(scanmill: 1
name: ball
steps:
  - virtual-scan: {shape: sphere, views: [8], resolution: 5 %diag}
  - delaunay:
  - alpha-solid:
)";

TEST(ExportsCommand, Outputs_OfEveryKind_AreEqualForAnyThreads) {
    const TemporaryFolder folder;
    folder.write("w.yaml", sphere + R"(outputs:
  "{scan}.points.vtp": virtual-scan
  "{scan}.vtu": delaunay
  "{scan}.vtp": alpha-solid
  "{scan}.glb": alpha-solid
  "{scan}.3mf": alpha-solid
)");
    for (const char* threads : {"1", "4"}) {
        const ProgramResult ran = scanmill_program({"run", "w.yaml", "--no-cache", "--threads", threads, "-o", threads},
                                                   {.folder = folder.path()});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
    }
    for (const char* name : {"ball.points.vtp", "ball.vtu", "ball.vtp", "ball.glb", "ball.3mf"}) {
        EXPECT_FALSE(content_of(folder.path() / "1" / name).empty()) << name;
        EXPECT_EQ(content_of(folder.path() / "1" / name), content_of(folder.path() / "4" / name)) << name;
    }
    const auto mesh = read_by_vtk<vtkXMLPolyDataReader, vtkPolyData>(folder.path() / "1/ball.vtp");
    const auto tets = read_by_vtk<vtkXMLUnstructuredGridReader, vtkUnstructuredGrid>(folder.path() / "1/ball.vtu");
    EXPECT_EQ(mesh->GetNumberOfPolys(), 2 * mesh->GetNumberOfPoints() - 4) << "a closed surface of genus 0";
    EXPECT_GT(tets->GetNumberOfCells(), tets->GetNumberOfPoints());
}

TEST(ExportsCommand, Output_OfAKindThatTheFormatCannotHold_IsReportedBeforeTheRun) {
    const TemporaryFolder folder;
    folder.write("w.yaml", sphere + "outputs: {\"{scan}.3mf\": virtual-scan, \"{scan}.vtp\": delaunay}\n");
    const ProgramResult checked = scanmill_program({"check", "w.yaml"}, {.folder = folder.path()});
    EXPECT_EQ(checked.exit_code, 2);
    EXPECT_THAT(checked.out + checked.err,
                AllOf(HasSubstr("'virtual-scan' is points, which no '.3mf' file can hold; expected ply"),
                      HasSubstr("'delaunay' is tets, which no '.vtp' file can hold; expected vtu")));
}

TEST(ExportsCommand, Convert_Writes_AndInfoReportsThatTheFormatIsNotRead) {
    const TemporaryFolder folder;
    write_file(folder / "a.ply", std::make_shared<const TriangleMesh>(cube(2)));
    for (const auto& [file, name] : {std::pair("a.vtp", "VTP"), {"a.glb", "GLB"}, {"a.3mf", "3MF"}}) {
        const ProgramResult ran =
            scanmill_program({"convert", "a.ply", file, "--unit", "mm"}, {.folder = folder.path()});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.err, "");
        const ProgramResult info = scanmill_program({"info", file}, {.folder = folder.path()});
        EXPECT_EQ(info.exit_code, 1);
        EXPECT_THAT(info.err, HasSubstr(std::string(name) + " is written for other programs, and not read"));
    }
    Assimp::Importer importer;
    ASSERT_TRUE(importer.ReadFile((folder / "a.glb").string(), 0));
}

TEST(ExportsCommand, FullDisk_LeavesNothing) {
    const TemporaryFolder folder;
    write_file(folder / "a.ply", std::make_shared<const TriangleMesh>(geodesic_sphere(1, 30)));
    for (const char* file : {"a.vtp", "a.glb", "a.3mf"}) {
        const ProgramResult ran =
            scanmill_program({"convert", "a.ply", file, "--unit", "mm"}, {.folder = folder.path(), .file_limit = 8192});
        EXPECT_EQ(ran.exit_code, 1) << file;
        EXPECT_THAT(ran.err, AllOf(HasSubstr(file), HasSubstr("the file was not made"))) << file;
        EXPECT_EQ(folder.files(), 1u) << file;
    }
}

}  // namespace
}  // namespace scanmill::test
