// SPDX-License-Identifier: GPL-3.0-or-later
// Everything in a LAS file except its points: wrong sizes, records, extra bytes, units, compression; E57.
#include "las_support.hpp"
#include "scanmill/formats/common/built_in.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

LasBytes plain(std::size_t extra = 0) {
    LasBytes las;
    las.points = {las_point(20 + extra, 1, 2, 3)};
    return las;
}

/// The refusal of a plain file with one number of its header replaced.
template <class T>
std::string refused_with(std::size_t at, T number) {
    std::string bytes = plain().file();
    put_at(bytes, at, number);
    return refusal_of(bytes, "a.las");
}

TEST(LasHeader_Refusals, SayWhatIsWrong) {
    EXPECT_THAT(refusal_of("LASF", "a.las"), HasSubstr("is 4 bytes long"));
    EXPECT_THAT(refusal_of("LASER", "a.las"), ContainsRegex("not a LAS .*'LASE'"));
    EXPECT_THAT(refused_with(24, u8(2)), HasSubstr("is of LAS version 2.2"));
    EXPECT_THAT(refused_with(25, u8(5)), HasSubstr("is of LAS version 1.5"));
    EXPECT_THAT(refused_with(94, std::uint16_t(226)), HasSubstr("takes 227 bytes or more; it declares 226"));
    EXPECT_THAT(refused_with(94, std::uint16_t(999)), HasSubstr("it declares 999, and the file has 247"));
    EXPECT_THAT(refused_with(96, u32(226)), ContainsRegex("points .* byte 226.* 227 bytes"));
    EXPECT_THAT(refused_with(96, u32(248)), HasSubstr("the points begin at byte 248"));
    EXPECT_THAT(refused_with(104, u8(11)), ContainsRegex("format 11.* 0 to 10"));
    EXPECT_THAT(refused_with(105, std::uint16_t(19)), ContainsRegex("20 bytes.* 19"));
    EXPECT_THAT(refused_with(131, 0.0), ContainsRegex("scale 0 .*offset 0 of x"));
    EXPECT_THAT(refused_with(171, std::numeric_limits<double>::infinity()), HasSubstr("the offset inf of z"));
    EXPECT_THAT(refused_with(107, u32(0)), ContainsRegex("no points.* 0, .*20 bytes"));
    EXPECT_THAT(refused_with(107, u32(2)), ContainsRegex("2 points of 20 bytes.* 20 bytes .*227"));
}

TEST(LasHeader_OfVersion14, IsLonger) {
    LasBytes las = plain();
    las.minor_version = 4;
    std::string bytes = las.file();
    put_at(bytes, 94, std::uint16_t(374));
    EXPECT_THAT(refusal_of(bytes, "a.las"), ContainsRegex("LAS 1.4 .*375 bytes .*374"));
}

TEST(LasHeader_ManyPoints, TakeNoMemory) {
    LasBytes las = plain();
    las.minor_version = 4;
    std::string bytes = las.file();
    put_at(bytes, 247, u64(1) << 40);
    EXPECT_THAT(refusal_of(bytes, "a.las"), ContainsRegex("1099511627776 points of 20 bytes.* 20 bytes"));
}

TEST(LasRecords, AreLeftOutAndReported_Once) {
    LasBytes las = plain();
    las.add_record("hobu", 1234, "abc");
    las.add_record("LASF_Projection", 2112, "wkt");
    Warnings warnings;
    points_in(las.file(), "a.las", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(ContainsRegex("2 .*records .*hobu 1234, LASF_Projection 2112")));
}

TEST(LasRecords, ThatRunIntoThePoints_AreReported) {
    LasBytes las = plain();
    las.add_record("a", 1, "abc");
    las.record_count = 4000000000u;
    Warnings warnings;
    EXPECT_EQ(points_in(las.file(), "a.las", &warnings)->size(), 1u);
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("record 2 of 4000000000 runs into the points"), HasSubstr("1 variable")));
    std::string bytes = las.file();
    put_at(bytes, 227 + 20, std::uint16_t(4));
    warnings.sentences.clear();
    points_in(bytes, "a.las", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("record 1 of 4000000000 runs into the points")));
}

TEST(LasRecords_BehindThePoints, AreReported) {
    LasBytes las = plain();
    las.trailing = "12345";
    Warnings warnings;
    points_in(las.file(), "a.las", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("5 bytes after the last point ignored")));
    las.minor_version = 4;
    std::string bytes = las.file();
    put_at(bytes, 243, u32(2));
    warnings.sentences.clear();
    points_in(bytes, "a.las", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 records after the points were left out")));
}

TEST(LasExtraBytes, OfEveryNumber_AreColumnsOfTheirTypes) {
    LasBytes las = plain(15);
    put_at(las.points[0], 20, std::int16_t(-300));
    put_at(las.points[0], 22, 2.5);
    put_at(las.points[0], 30, u8(1));
    put_at(las.points[0], 31, std::uint16_t(10));
    put_at(las.points[0], 33, std::uint16_t(20));
    // Type 13 is two of type 3.
    las.add_record("LASF_Spec", 4,
                   las_extra(4, "range") + las_extra(10, "width", 8 | 16, 2, 100) + las_extra(1, "intensity") +
                       las_extra(13, "pair"));
    Warnings warnings;
    const auto cloud = points_in(las.file(), "a.las", &warnings);
    EXPECT_THAT(numbers_of<std::int16_t>(cloud->columns.find("range")), ElementsAre(-300));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("width")), ElementsAre(105));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("intensity_extra_1")), ElementsAre(1));
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("pair")), ElementsAre(10, 20));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("'intensity' are called 'intensity_extra_1'")));
}

TEST(LasExtraBytes, ScaleWithoutItsFlag_IsNotApplied) {
    LasBytes las = plain(2);
    put_at(las.points[0], 20, std::uint16_t(7));
    las.add_record("LASF_Spec", 4, las_extra(3, "raw", 0, 1000, 1000));
    EXPECT_THAT(numbers_of<std::uint16_t>(points_in(las.file(), "a.las")->columns.find("raw")), ElementsAre(7));
}

TEST(LasExtraBytes, Undescribed_AreLeftOutAndReported) {
    LasBytes las = plain(6);
    put_at(las.points[0], 23, std::uint16_t(8));
    Warnings warnings;
    points_in(las.file(), "a.las", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("6 extra bytes")));
    // Three bytes of type 0 before the described one.
    las.add_record("LASF_Spec", 4, las_extra(0, "opaque", 3) + las_extra(3, "known"));
    warnings.sentences.clear();
    const auto cloud = points_in(las.file(), "a.las", &warnings);
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("known")), ElementsAre(8));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("4 extra bytes")));
}

TEST(LasExtraBytes, BeyondThePoint_AreLeftOutAndReported) {
    LasBytes las = plain(1);
    las.add_record("LASF_Spec", 4, las_extra(3, "wide"));
    Warnings warnings;
    EXPECT_EQ(points_in(las.file(), "a.las", &warnings)->columns.find("wide"), nullptr);
    EXPECT_THAT(warnings.sentences, testing::Contains(ContainsRegex("'wide' .*beyond .*21 bytes")));
}

struct UnitCase {
    std::vector<std::pair<int, int>> keys;
    LengthUnit unit;
    const char* warnings;  ///< nothing when null
};

TEST(LasUnit, IsThatOfTheGeoTiffKeys) {
    const std::vector<UnitCase> cases{{{{3076, 9001}}, LengthUnit::metre, nullptr},
                                      {{{1024, 1}, {3076, 9002}, {4099, 9002}}, LengthUnit::foot, nullptr},
                                      {{{3076, 9003}}, LengthUnit::unknown, "unit 9003"},
                                      {{{3076, 9001}, {4099, 9002}}, LengthUnit::unknown, "heights of unit 9002"},
                                      {{{1024, 2}, {3076, 9001}}, LengthUnit::unknown, "degrees"},
                                      {{{1024, 1}}, LengthUnit::unknown, nullptr}};
    for (const UnitCase& c : cases) {
        LasBytes las = plain();
        las.add_record("LASF_Projection", 34735, geo_keys(c.keys));
        Warnings warnings;
        EXPECT_EQ(points_in(las.file(), "a.las", &warnings)->frame.unit, c.unit);
        const std::string left_out =
            "(LASF_Projection 34735" + std::string(c.unit == LengthUnit::unknown ? ")" : " except its unit)");
        EXPECT_THAT(warnings.sentences, testing::Contains(HasSubstr(left_out)));
        ASSERT_EQ(warnings.sentences.size(), c.warnings ? 2u : 1u);
        if (c.warnings) {
            EXPECT_THAT(warnings.sentences, testing::Contains(HasSubstr(c.warnings)));
        }
    }
    LasBytes las = plain();
    las.add_record("LASF_Projection", 34735, geo_keys({{3076, 9001}}));
    const LoadedFile loaded = read_bytes(las.file(), "a.las", {{}, LengthUnit::millimetre});
    EXPECT_EQ(loaded.value.get<PointCloud>()->frame.unit, LengthUnit::millimetre);
}

std::string hint_for(std::string_view bytes, const char* name) {
    try {
        read_bytes(bytes, name);
    } catch (const Error& error) {
        return error.hint();
    }
    return "it was read";
}

/// The refusal where no module reads LAZ.
Error laz_error(const LasBytes& las, const char* name) {
    try {
        refused_laz_format().read({name, las.file()}, {});
    } catch (const Error& error) {
        return error;
    }
    return Error("it was read");
}

TEST(CompressedLas, WithoutAModule_IsRefusedWithACommand) {
    LasBytes las = plain();
    las.point_format = 0x80 | 0;
    EXPECT_THAT(laz_error(las, "a.laz").sentence(), HasSubstr("is a LAZ file, LAS in compressed form"));
    EXPECT_THAT(laz_error(las, "a.laz").hint(), HasSubstr(": laszip -i a.laz -o out.las"));
    EXPECT_THAT(laz_error(las, "my scan's.laz").hint(), HasSubstr(": pdal translate 'my scan'\\''s.laz' out.las,"));
    las.add_record("copc", 1, "");
    EXPECT_THAT(laz_error(las, "a.laz").sentence(), HasSubstr("is a COPC file"));
    LasBytes by_record = plain();
    by_record.add_record("laszip encoded", 22204, "");
    EXPECT_THAT(refusal_of(by_record.file(), "a.las"), HasSubstr("is a LAZ file"));
}

TEST(CompressedLas, IsRecognisedByItsHeader) {
    LasBytes las = plain();
    const std::string uncompressed = las.file();
    las.point_format = 0x80 | 0;
    const std::string compressed = las.file();
    EXPECT_EQ(las_format().recognises(uncompressed, uncompressed.size()), Recognition::certain);
    EXPECT_EQ(las_format().recognises(compressed, compressed.size()), Recognition::no);
    EXPECT_EQ(refused_laz_format().recognises(uncompressed, uncompressed.size()), Recognition::no);
    EXPECT_EQ(refused_laz_format().recognises(compressed, compressed.size()), Recognition::certain);
}

TEST(E57, WithoutItsModule_IsRefusedWithACommand) {
    const auto e57 = std::ranges::find(formats(), "E57", &Format::name);
    ASSERT_NE(e57, formats().end());
    if (!e57->is_refused) GTEST_SKIP() << "the module is built";
    const std::string bytes = "ASTM-E57" + std::string(40, '\0');
    EXPECT_THAT(refusal_of(bytes, "a.dat"), HasSubstr("is an E57 file; E57 is not read"));
    EXPECT_THAT(hint_for(bytes, "a.e57"), HasSubstr(": CloudCompare -SILENT -O a.e57 -C_EXPORT_FMT PLY -SAVE_CLOUDS,"));
    EXPECT_THAT(refusal_of("something", "a.e57"), HasSubstr("is not an E57 file"));
    EXPECT_THAT(hint_for("something else", "a.unknown"), testing::Not(HasSubstr("E57")));
}

}  // namespace
}  // namespace scanmill::test
