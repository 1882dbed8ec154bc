// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures and light meshes for reports: made once per content by the installed filters, in worker processes.
#include "scanmill/session/previews.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>

#include "scanmill/data/picture.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/worker/file_description.hpp"
#include "support/folders.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::Ge;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Le;
using testing::SizeIs;

/// By name, the bytes of all files below the folder.
std::map<std::string, std::string> files_below(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = content_of(entry.path());
    return files;
}

std::string sha256_of_file(const fs::path& file) {
    Sha256 hash;
    hash.add(content_of(file));
    return hash.text();
}

class Previews : public testing::Test {
protected:
    fs::path write(const std::string& name, const TriangleMesh& mesh, LengthUnit unit = LengthUnit::unknown) {
        auto copy = std::make_shared<TriangleMesh>(mesh);
        copy->frame.unit = unit;
        fs::create_directories((folder_ / name).parent_path());
        write_file(folder_ / name, Value(std::shared_ptr<const TriangleMesh>(copy)));
        return folder_ / name;
    }
    /// A sphere of 8,000 triangles.
    fs::path write_ball(const std::string& name, double radius = 1, LengthUnit unit = LengthUnit::unknown) {
        return write(name, geodesic_sphere(radius, 20), unit);
    }
    static PreviewWish wish_of(const fs::path& file, const std::string& truth = "") {
        PreviewWish wish;
        wish.file = file;
        wish.truth_file = wish.camera_file = truth;
        return wish;
    }
    std::vector<Preview> make(const std::vector<PreviewWish>& wishes) {
        return make_previews(out_, wishes, library_, settings_,
                             [&](std::string text) { warnings_.push_back(std::move(text)); });
    }
    Preview make(const PreviewWish& wish) { return make(std::vector{wish}).front(); }
    /// From now on nothing can be made anew.
    void forbid_work() { settings_.worker_command = {"/no/such/program"}; }

    TemporaryFolder folder_;
    fs::path out_ = folder_ / "out";
    FilterLibrary library_{{plugin_folder()}};
    PreviewSettings settings_{
        .jobs = 2, .threads = 1, .worker_command = {program_file(), "worker"}, .is_cancelled = {}, .seconds = 60};
    std::vector<std::string> warnings_;
};

/// The box of the pixels that differ from the picture's corner: low column, low row, high column, high row.
std::array<u32, 4> drawn_box(const fs::path& file) {
    const auto picture = read_file(file).value.get<Picture>();
    std::array<u32, 4> box{picture->width, picture->height, 0, 0};
    for (u32 row = 0; row < picture->height; ++row)
        for (u32 column = 0; column < picture->width; ++column) {
            if (picture->pixels[std::size_t{row} * picture->width + column] == picture->pixels[0]) continue;
            box = {std::min(box[0], column), std::min(box[1], row), std::max(box[2], column), std::max(box[3], row)};
        }
    return box;
}

TEST_F(Previews, MeshWithATruth_GetsTwoPicturesAndALightMeshWithItsDeviation) {
    const std::string truth = write_ball("truth.ply").string();
    const Preview preview = make(wish_of(write_ball("ball.ply", 1.01), truth));
    EXPECT_EQ(preview.reason, "");
    EXPECT_EQ(preview.picture, previews_folder(out_) / (preview.key + ".png"));
    for (const fs::path& file : {preview.picture, preview.deviation}) {
        const auto picture = read_file(file).value.get<Picture>();
        EXPECT_EQ(picture->width, 320u);
        EXPECT_EQ(picture->height, 240u);
    }
    EXPECT_NE(content_of(preview.picture), content_of(preview.deviation));
    // Every vertex is 0.01 from the truth, but for the distance of a facet from its sphere: below 0.001.
    EXPECT_NEAR(preview.scale, 0.015, 0.0016);
    const QuantisedMesh mesh = quantised(preview.mesh);
    EXPECT_THAT(mesh.triangles.size(), AllOf(Ge(3u * 1000), Le(3u * 3000)));
    ASSERT_THAT(mesh.deviation, SizeIs(mesh.positions.size() / 3));
    EXPECT_NEAR(mesh.range, 0.01, 0.001);
    EXPECT_THAT(mesh.deviation, Each(Ge(60'000))) << "outside of the truth";
    EXPECT_NEAR(mesh.high[2], 1.01, 0.02);
    EXPECT_NEAR(mesh.low[2], -1.01, 0.02);
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Previews, EqualContent_IsMadeOnce) {
    const std::string truth = write_ball("truth.ply").string();
    const Preview first = make(wish_of(write_ball("ball.ply", 1.01), truth));
    const auto time = fs::last_write_time(first.picture);
    const auto files = files_below(out_);
    forbid_work();
    const fs::path copy = write_ball("tonight/copy.ply", 1.01);
    const std::vector<Preview> again = make({wish_of(folder_ / "ball.ply", truth), wish_of(copy, truth)});
    for (const Preview& each : again) {
        EXPECT_EQ(each.key, first.key);
        EXPECT_EQ(each.picture, first.picture);
        EXPECT_EQ(each.deviation, first.deviation);
        EXPECT_EQ(each.mesh, first.mesh);
        EXPECT_EQ(each.scale, first.scale);
        EXPECT_EQ(each.reason, "");
    }
    EXPECT_EQ(fs::last_write_time(first.picture), time);
    EXPECT_EQ(files_below(out_), files);
}

TEST_F(Previews, RecordedFileThatIsGone_StillHasItsPreview) {
    const PreviewWish wish = wish_of(write_ball("ball.ply"));
    const Preview first = make(wish);
    PreviewWish recorded = wish;
    recorded.sha256 = sha256_of_file(wish.file);
    forbid_work();
    EXPECT_EQ(make(recorded).key, first.key);
    fs::remove(wish.file);
    EXPECT_EQ(make(recorded).picture, first.picture);
    EXPECT_EQ(make(recorded).reason, "");
}

TEST_F(Previews, VariantsOfAScan_HaveOneCamera) {
    const std::string truth = write_ball("truth.ply").string();
    const TriangleMesh entire = geodesic_sphere(1, 20);
    TriangleMesh upper = entire;
    Array<Triangle> kept;
    for (const Triangle& triangle : entire.triangles)
        if (entire.positions[triangle[0]][2] > -0.3) kept.push_back(triangle);
    upper.triangles = Buffer<Triangle>(std::move(kept));
    const std::vector<Preview> previews =
        make({wish_of(write("entire.ply", entire), truth), wish_of(write("upper.ply", upper), truth)});
    const std::array<u32, 4> all = drawn_box(previews[0].picture), half = drawn_box(previews[1].picture);
    EXPECT_NE(content_of(previews[0].picture), content_of(previews[1].picture));
    EXPECT_EQ(half[0], all[0]);
    EXPECT_EQ(half[1], all[1]);
    EXPECT_EQ(half[2], all[2]);
    EXPECT_LT(half[3] + 20, all[3]) << "the lower part is missing";
}

TEST_F(Previews, VariantsOfAScan_HaveOneScale_AlsoAVariantThatIsAddedLater) {
    const std::string truth = write_ball("truth.ply").string();
    const PreviewWish a = wish_of(write_ball("a.ply", 1.01), truth), b = wish_of(write_ball("b.ply", 1.02), truth),
                      c = wish_of(write_ball("c.ply", 1.03), truth), d = wish_of(write_ball("d.ply", 1.2), truth);
    const std::vector<Preview> first = make({a, b, c});
    EXPECT_NEAR(first[0].scale, 0.03, 0.002) << "from the variant in the middle";
    EXPECT_EQ(first[1].scale, first[0].scale);
    EXPECT_EQ(first[2].scale, first[0].scale);
    const auto files = files_below(out_);
    const std::vector<Preview> later = make({d, a, b, c});
    EXPECT_EQ(later[0].scale, first[0].scale);
    EXPECT_FALSE(later[0].deviation.empty());
    for (const auto& [name, bytes] : files) EXPECT_EQ(content_of(out_ / name), bytes) << name;
}

TEST_F(Previews, PictureWithAnotherScale_IsDrawnAgain) {
    const std::string truth = write_ball("truth.ply").string();
    const PreviewWish a = wish_of(write_ball("a.ply", 1.01), truth), b = wish_of(write_ball("b.ply", 1.03), truth);
    const Preview alone_a = make(a), alone_b = make(b);
    ASSERT_NE(alone_a.scale, alone_b.scale);
    const std::string before = content_of(alone_b.deviation);
    const std::vector<Preview> both = make({a, b});
    EXPECT_EQ(both[0].scale, alone_a.scale);
    EXPECT_EQ(both[1].scale, alone_a.scale);
    EXPECT_NE(content_of(both[1].deviation), before);
    forbid_work();
    EXPECT_EQ(make({a, b})[1].scale, alone_a.scale);
}

TEST_F(Previews, MeshThatCannotBeSimplified_GetsAPictureAndAReason_Once) {
    TriangleMesh fins = cube();
    Array<Triangle> triangles(fins.triangles.begin(), fins.triangles.end());
    for (const u32 third : {5u, 6u, 7u}) triangles.push_back({0, 1, third});  // edges with many triangles
    fins.triangles = Buffer<Triangle>(std::move(triangles));
    const PreviewWish wish = wish_of(write("fins.ply", fins), write_ball("truth.ply").string());
    const Preview preview = make(wish);
    EXPECT_FALSE(preview.picture.empty());
    EXPECT_TRUE(preview.mesh.empty());
    EXPECT_TRUE(preview.deviation.empty());
    EXPECT_THAT(preview.reason, HasSubstr("simplified: "));
    forbid_work();
    EXPECT_EQ(make(wish).reason, preview.reason);
    EXPECT_EQ(make(wish).picture, preview.picture);
}

TEST_F(Previews, MissingAndChangedFiles_HaveAReason_AndAreTriedAgain) {
    PreviewWish wish = wish_of(folder_ / "ball.ply");
    EXPECT_THAT(make(wish).reason, HasSubstr("ball.ply"));
    EXPECT_THAT(files_below(out_), IsEmpty());
    write_ball("ball.ply");
    wish.sha256 = sha256_of_file(wish.file);
    write_ball("ball.ply", 2);
    EXPECT_THAT(make(wish).reason, HasSubstr("changed"));
    EXPECT_THAT(files_below(out_), IsEmpty());
    write_ball("ball.ply");
    EXPECT_EQ(make(wish).reason, "");
    EXPECT_THAT(files_below(out_), SizeIs(3)) << "picture, mesh and note";
}

TEST_F(Previews, MissingTruth_LeavesThePictureAndTheMesh) {
    const PreviewWish wish = wish_of(write_ball("ball.ply"), (folder_ / "truth.ply").string());
    const Preview preview = make(wish);
    EXPECT_FALSE(preview.picture.empty());
    EXPECT_FALSE(preview.mesh.empty());
    EXPECT_TRUE(preview.deviation.empty());
    EXPECT_THAT(preview.reason, HasSubstr("truth.ply"));
    write_ball("truth.ply");
    EXPECT_FALSE(make(wish).deviation.empty());
}

TEST_F(Previews, TruthInAnotherUnit_IsConverted) {
    const PreviewWish wish = wish_of(write_ball("ball.ply", 10.1, LengthUnit::millimetre),
                                     write_ball("truth.ply", 1, LengthUnit::centimetre).string());
    const Preview preview = make(wish);
    EXPECT_EQ(preview.reason, "");
    EXPECT_NEAR(preview.scale, 0.15, 0.016);
    EXPECT_EQ(quantised(preview.mesh).unit, LengthUnit::millimetre);
    const std::array<u32, 4> box = drawn_box(preview.picture);
    EXPECT_LT(box[3] - box[1], 240u);
    EXPECT_GT(box[3] - box[1], 150u) << "the camera is that of the truth";
}

TEST_F(Previews, DeclaredUnits_AreUsed) {
    PreviewWish wish = wish_of(write_ball("ball.ply", 10.1), write_ball("truth.ply", 1).string());
    wish.unit = LengthUnit::millimetre;
    wish.truth_unit = wish.camera_unit = LengthUnit::centimetre;
    EXPECT_NEAR(make(wish).scale, 0.15, 0.016);
}

TEST_F(Previews, PointsAndTruths_GetOnlyAPicture) {
    write_file(folder_ / "scan.ply", Value(std::make_shared<const PointCloud>(random_sphere(500, 1))));
    PreviewWish scan = wish_of(folder_ / "scan.ply"), truth = wish_of(write_ball("truth.ply"));
    scan.kind = truth.kind = std::nullopt;
    for (const Preview& preview : make({scan, truth})) {
        EXPECT_FALSE(preview.picture.empty());
        EXPECT_TRUE(preview.mesh.empty());
        EXPECT_EQ(preview.reason, "");
    }
}

TEST_F(Previews, AreWrittenOnlyIntoTheirFolder_WithTheSameBytesForAnyNumberOfJobs) {
    const std::string truth = write_ball("truth.ply").string();
    const std::vector<PreviewWish> wishes{wish_of(write_ball("a.ply", 1.01), truth),
                                          wish_of(write_ball("b.ply", 1.02), truth), wish_of(folder_ / "truth.ply")};
    const auto before = files_below(folder_.path());
    make(wishes);
    auto after = files_below(folder_.path());
    std::erase_if(after, [](const auto& file) { return file.first.starts_with("out/previews/"); });
    EXPECT_EQ(after, before);
    const auto made = files_below(out_);
    EXPECT_THAT(made, SizeIs(4 + 4 + 3));
    for (const unsigned jobs : {0u, 1u}) {
        settings_.jobs = jobs;
        settings_.threads = 2;
        out_ = folder_ / std::to_string(jobs);
        make(wishes);
        EXPECT_EQ(files_below(out_), made) << jobs;
    }
}

TEST_F(Previews, TimeLimit_EndsThem_AndTheyAreNotTriedAgain) {
    settings_.seconds = 1e-3;
    const PreviewWish wish = wish_of(write_ball("ball.ply"));
    const Preview preview = make(wish);
    EXPECT_TRUE(preview.picture.empty());
    EXPECT_THAT(preview.reason, HasSubstr("time limit"));
    forbid_work();
    EXPECT_EQ(make(wish).reason, preview.reason);
}

TEST_F(Previews, CancelledCall_KeepsNoReason) {
    settings_.is_cancelled = [] { return true; };
    const PreviewWish wish = wish_of(write_ball("ball.ply"));
    EXPECT_THAT(make(wish).reason, HasSubstr("cancelled"));
    settings_.is_cancelled = {};
    EXPECT_EQ(make(wish).reason, "");
}

TEST_F(Previews, WorkersThatDoNotStart_AreTriedAgain) {
    const PreviewWish wish = wish_of(write_ball("ball.ply"));
    const std::vector<std::string> workers = settings_.worker_command;
    forbid_work();
    EXPECT_NE(make(wish).reason, "");
    settings_.worker_command = workers;
    EXPECT_EQ(make(wish).reason, "");
}

TEST_F(Previews, WithoutFiltersForThem_HaveAReason) {
    library_ = FilterLibrary({folder_.path()});
    EXPECT_THAT(make(wish_of(write_ball("ball.ply"))).reason,
                AllOf(HasSubstr("no installed filter draws"), HasSubstr("simplifies")));
}

TEST_F(Previews, FolderThatCannotBeMade_IsAWarning) {
    folder_.write("out", "a file");
    EXPECT_THAT(make(wish_of(write_ball("ball.ply"))).reason, HasSubstr("cannot be created"));
    EXPECT_THAT(warnings_, SizeIs(1));
}

TEST_F(Previews, UnusedPreviews_AreThoseOfOtherOutputsAndOtherReadFiles) {
    PreviewWish scan = wish_of(write_ball("scan.ply", 3)), output = wish_of(write_ball("a.ply", 1)),
                other = wish_of(write_ball("b.ply", 2));
    output.sha256 = sha256_of_file(output.file);
    other.sha256 = sha256_of_file(other.file);
    const std::vector<Preview> previews = make({output, other, scan});
    folder_.write("out/previews/notes.txt", "mine");
    folder_.write("out/previews/" + std::string(32, 'f') + ".png", "the rest of an interrupted call");
    const auto keys_of = [](const std::vector<fs::path>& files) {
        std::map<std::string, int> count;
        for (const fs::path& file : files) ++count[file.filename().string().substr(0, 32)];
        return count;
    };
    const std::string rest(32, 'f');
    EXPECT_EQ(keys_of(unused_previews(out_, {output.sha256, other.sha256}, {"scan.ply"})),
              (std::map<std::string, int>{{rest, 1}}));
    EXPECT_EQ(keys_of(unused_previews(out_, {output.sha256}, {"scan.ply", "b.ply"})),
              (std::map<std::string, int>{{rest, 1}, {previews[1].key, 3}}));
    EXPECT_EQ(unused_previews(out_, {output.sha256}, {}).front().extension(), ".json") << "notes go first";
    EXPECT_THAT(unused_previews(folder_ / "none", {}, {}), IsEmpty());
}

/// A cube of which one half is 0.2 too low and the other 0.3 too high, by its own column.
fs::path write_inspected_cube(const fs::path& file) {
    TriangleMesh mesh = cube_of_squares(20);
    const BoundingBox box = surface_box(mesh);
    const double middle = (box.low.x() + box.high.x()) / 2;
    Array<double> deviations;
    for (const Vec3& position : mesh.positions) deviations.push_back(position.x() < middle ? -0.2 : 0.3);
    mesh.vertex_columns.add(Column("deviation", 1, Buffer<double>(std::move(deviations))).with_length_exponent(1));
    write_file(file, Value(std::make_shared<const TriangleMesh>(mesh)));
    return file;
}

TEST_F(Previews, OwnDeviation_ColoursThePictureAndTheLightMesh) {
    PreviewWish wish = wish_of(write_inspected_cube(folder_ / "cube.ply"), write_ball("nominal.ply").string());
    wish.deviation = FileDeviation{"deviation", {-0.4, 0.4}, {-0.25, 0.25}};
    const Preview preview = make(wish);
    EXPECT_EQ(preview.reason, "");
    EXPECT_FALSE(preview.picture.empty());
    ASSERT_FALSE(preview.deviation.empty());
    const QuantisedMesh mesh = quantised(preview.mesh);
    EXPECT_NEAR(mesh.range, 0.3, 1e-6) << "not the distance from the nominal";
    wish.is_for_paper = true;
    const Preview large = make(wish);
    EXPECT_TRUE(large.picture.empty());
    EXPECT_TRUE(large.mesh.empty());
    EXPECT_EQ(read_file(large.deviation).value.get<Picture>()->width, 1200u);
    wish.deviation->tolerance = {-0.35, 0.35};
    EXPECT_NE(content_of(make(wish).deviation), content_of(large.deviation)) << "0.3 is in tolerance now";
    forbid_work();
    EXPECT_EQ(make(wish).reason, "");
}

TEST_F(Previews, QuantisedMesh_HasTheBoxAndTheDeviations) {
    TriangleMesh mesh = regular_tetrahedron();
    mesh.positions = Buffer<Vec3>(Array<Vec3>{{1, 2, 3}, {5, 2, 3}, {1, 3, 3}, {2, 2, 4}});
    const Array<double> distances{-0.5, 0, 0.25, 0.5};
    mesh.vertex_columns.add(Column("distance", 1, Buffer<double>(Array<double>(distances))).with_length_exponent(1));
    const QuantisedMesh found = quantised(write("mesh.ply", mesh));
    EXPECT_EQ(found.low, Vec3(1, 2, 3));
    EXPECT_EQ(found.high, Vec3(5, 3, 4));
    EXPECT_EQ(found.positions, (std::vector<std::uint16_t>{0, 0, 0, 65535, 0, 0, 0, 65535, 0, 16384, 0, 65535}));
    EXPECT_EQ(found.deviation, (std::vector<std::uint16_t>{0, 32767, 49151, 65534}));
    EXPECT_EQ(found.range, 0.5);
    EXPECT_THAT(found.triangles, SizeIs(12));
    EXPECT_THAT(quantised(write("plain.ply", regular_tetrahedron())).deviation, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
