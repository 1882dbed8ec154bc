// SPDX-License-Identifier: GPL-3.0-or-later
// E57 files that are refused: each with the numbers that were found, and without a crash.
#include <fmt/format.h>

#include <cstring>

#include "core/formats/support.hpp"
#include "formats/e57/e57_files.hpp"
#include "support/e57_pages.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const E57Scan one_point{cartesian({{1, 2, 3}})};

std::string refusal(const std::string& bytes) { return refusal_of(bytes, "a.e57"); }

/// The file with a number of its header changed.
template <class T>
std::string with_header(const std::string& file, std::size_t at, T number) {
    return e57_changed(file, [&](std::string& content) { std::memcpy(content.data() + at, &number, sizeof number); });
}

TEST(E57Refusals, ChecksumsOfTheTests_AreThoseOfTheFormat) {
    const std::string file = e57_file({one_point});
    EXPECT_EQ(e57_changed(file, [](std::string&) {}), file);
}

TEST(E57Refusals, WrongChecksum_NamesThePage) {
    E57Scan scan{cartesian({})};
    for (int i = 0; i < 2000; ++i)
        for (E57Field& field : scan.fields) field.values.push_back(i);
    std::string file = e57_file({scan});
    file[20 * 1024 + 7] ^= 1;
    EXPECT_THAT(refusal(file), HasSubstr("a checksum is wrong in page 20"));
    file = e57_file({one_point});
    file[file.size() - 500] ^= 1;
    EXPECT_THAT(refusal(file), HasSubstr("a checksum is wrong in page"));
}

TEST(E57Refusals, Signature_Version_PagesAndSize_AreCheckedFirst) {
    const std::string file = e57_file({one_point});
    EXPECT_THAT(refusal("something"), HasSubstr("only 9 bytes"));
    EXPECT_THAT(refusal(std::string(2048, 'x')), HasSubstr("does not begin with ASTM-E57"));
    EXPECT_THAT(refusal(with_header(file, 8, u32(2))), HasSubstr("is E57 of version 2.0; version 1.0 is read"));
    EXPECT_THAT(refusal(with_header(file, 12, u32(7))), HasSubstr("version 1.7"));
    EXPECT_THAT(refusal(with_header(file, 40, u64(512))), HasSubstr("pages of 512 bytes"));
    EXPECT_THAT(refusal(file.substr(0, file.size() - 1024)),
                AllOf(HasSubstr("its header promises " + std::to_string(file.size())), HasSubstr("the file has")));
    EXPECT_THAT(refusal(file.substr(0, 300)), HasSubstr("the file has 300"));
    EXPECT_THAT(refusal(with_header(file.substr(0, file.size()), 24, u64(1) << 60)), HasSubstr("not inside the file"));
    EXPECT_THAT(refusal(with_header(file, 24, u64(1022))), HasSubstr("not inside the file")) << "in a checksum";
    EXPECT_THAT(refusal(with_header(file, 32, u64(1) << 62)), HasSubstr("not inside the file"));
    EXPECT_THAT(refusal(with_header(file, 32, u64(0))), HasSubstr("not inside the file"));
}

TEST(E57Refusals, FilesWithoutScansOrPoints) {
    EXPECT_THAT(refusal(e57_file({})), HasSubstr("has no scans"));
    EXPECT_THAT(refusal(e57_file({}, 2)), HasSubstr("has no scans, only 2 images; images are not read"));
    EXPECT_THAT(refusal(e57_file({{cartesian({})}})), HasSubstr("its scan has no points"));
    EXPECT_THAT(refusal(e57_file({{cartesian({})}, {cartesian({})}})), HasSubstr("its scans have no points"));
}

TEST(E57Refusals, PromisedPoints_MustBeThere) {
    const std::string file = e57_file({{cartesian({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1, 1, 1}})}});
    EXPECT_THAT(refusal(e57_replaced(file, "recordCount=\"4\"", "recordCount=\"9\"")),
                HasSubstr("scan 1: it promises 9 points; its data hold 4"));
    // Fewer bits in the file than a billion points need.
    const std::string many = e57_changed(file, [](std::string& content) {
        const std::string from = "type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"4\"";
        const std::string to = "type='CompressedVector' fileOffset='48' recordCount='999999999999'";
        const std::size_t at = content.find(from), space = content.find("  ", content.find("prototype", at));
        ASSERT_NE(at, std::string::npos);
        ASSERT_NE(space, std::string::npos);
        std::string text = content;
        text.replace(at, from.size(), to);
        // The indentation of later lines makes up for the longer number.
        for (std::size_t gap; text.size() > content.size() && (gap = text.find("  ", at + to.size())) != text.npos;)
            text.erase(gap, 1);
        content = text;
    });
    EXPECT_THAT(refusal(many), HasSubstr("promises 999999999999 points of 192 bits"));
}

TEST(E57Refusals, ConstantFields_CannotPromiseMoreThanTheFilesBits) {
    E57Scan scan;
    for (const char* axis : {"cartesianX", "cartesianY", "cartesianZ"})
        scan.fields.push_back(integers(axis, 5, 5, {5, 5, 5}));
    const std::string file = e57_file({scan});
    const std::string many = e57_changed(file, [](std::string& content) {
        const std::string from = "recordCount=\"3\"", to = "recordCount=\"99999999\"";
        std::string text = content;
        const std::size_t at = text.find(from);
        text.replace(at, from.size(), to);
        for (std::size_t gap; text.size() > content.size() && (gap = text.find("  ", at)) != text.npos;)
            text.erase(gap, 1);
        content = text;
    });
    EXPECT_THAT(refusal(many), HasSubstr("promises 99999999 points of 1 bit"));
}

TEST(E57Refusals, Poses_MustBeRigidMotions) {
    E57Scan scan = one_point;
    scan.pose = E57Pose{{1.1, 0, 0, 0}, {0, 0, 0}};
    EXPECT_THAT(refusal(e57_file({one_point, scan})), AllOf(HasSubstr("scan 2"), HasSubstr("length")));
    scan.pose = E57Pose{{0, 0, 0, 0}, {0, 0, 0}};
    EXPECT_THAT(refusal(e57_file({scan})), HasSubstr("length"));
    Warnings warnings;
    scan.pose = E57Pose{{1.0005, 0, 0, 0}, {0, 0, 0}};
    points_in(e57_file({scan}), "a.e57", &warnings);
    EXPECT_EQ(warnings.sentences.size(), 1u) << "a length that rounding does not explain";
}

TEST(E57Refusals, BrokenScan_DoesNotAffectTheViewsBesideIt) {
    E57Scan scan = one_point;
    scan.pose = E57Pose{{2, 0, 0, 0}, {0, 0, 0}};
    ReadOptions options;
    options.view = 1;
    EXPECT_EQ(read_bytes(e57_file({one_point, scan}), "a.e57", options).value.get<PointCloud>()->size(), 1u);
}

TEST(E57Refusals, Coordinates_MustBeNumbersAndComplete) {
    E57Scan scan{{reals("cartesianX", {1}), reals("cartesianY", {1})}};
    EXPECT_THAT(refusal(e57_file({scan})), HasSubstr("scan 1: its points have neither cartesian nor spherical"));
}

std::string with_xml(const std::string& from, const std::string& to) {
    return refusal(e57_replaced(e57_file({one_point}), from, to));
}

TEST(E57Refusals, Xml_ThatWouldReadOtherFiles_IsRefused) {
    EXPECT_THAT(with_xml("<data3D type=\"Vector\"", "<!DOCTYPE e SYSTEM '>"), HasSubstr("document type"));
    EXPECT_THAT(with_xml("type=\"Vector\"", "chemaLocation"), HasSubstr("location of a schema"));
    EXPECT_THAT(with_xml("encoding=\"UTF-8\"", "encoding='UTF16'"), HasSubstr("not declared as UTF-8"));
}

/// A file with this XML section, and nothing else.
std::string with_section(std::string_view xml) {
    std::string content = e57_content(e57_file({one_point})).substr(0, 48) + std::string(xml);
    const u64 size = (content.size() + 1019) / 1020 * 1024, begin = 48, length = xml.size();
    std::memcpy(content.data() + 16, &size, sizeof size);
    std::memcpy(content.data() + 24, &begin, sizeof begin);
    std::memcpy(content.data() + 32, &length, sizeof length);
    return e57_sealed(content);
}

std::string utf16(std::string_view text) {
    std::string bytes;
    for (const char c : text) bytes += {c, '\0'};
    return bytes;
}

/// The parser would follow the document type: an entity may be another file, or expand to gigabytes.
TEST(E57Refusals, Xml_InUtf16_CannotHideADocumentType) {
    const std::string hidden = utf16("<!DOCTYPE e57Root [<!ENTITY a SYSTEM 'file:///etc/hostname'>]><e57Root>&a;");
    for (const std::string& xml : {utf16("<?xml version='1.0' encoding='UTF-16'?>") + hidden, hidden + "</>",
                                   "<e57Root>" + std::string(1, '\0') + "</e57Root>"})
        EXPECT_THAT(refusal(with_section(xml)), HasSubstr("has a zero byte, as UTF-16 has"));
}

/// Structures in e57Root, each with this number of children.
std::string wide_xml(int groups, int children) {
    std::string xml = "<e57Root type='Structure' xmlns='http://www.astm.org/COMMIT/E57/2010-e57-v1.0'>";
    for (int group = 0; group < groups; ++group) {
        xml += fmt::format("<g{} type='Structure'>", group);
        for (int child = 0; child < children; ++child) xml += fmt::format("<a{}/>", child);
        xml += fmt::format("</g{}>", group);
    }
    return xml + "</e57Root>";
}

TEST(E57Refusals, Xml_WithTooManyChildren_IsRefusedBeforeItIsParsed) {
    EXPECT_THAT(refusal(with_section(wide_xml(1, 14'000))), HasSubstr("has no scans"));
    EXPECT_THAT(refusal(with_section(wide_xml(1, 15'000))), HasSubstr("too many children: 'g0' has 14143 or more"));
    EXPECT_THAT(refusal(with_section(wide_xml(3, 10'000))), HasSubstr("too many children: 'g2'"));
}

TEST(E57Refusals, Xml_ThatIsNotWellFormed_IsRefused) {
    EXPECT_THAT(with_xml("</e57Root>", "          "), HasSubstr("ends inside of an element"));
    EXPECT_THAT(with_xml("</e57Root>", "</e58Root>"), HasSubstr("libE57Format refuses it"));
    EXPECT_THAT(with_xml("type=\"Float\"", "type=\"Flout\""), HasSubstr("libE57Format refuses it"));
    EXPECT_THAT(with_xml("CompressedVector\" ", "CompressedVector\"<"), HasSubstr("a.e57"));
}

TEST(E57Refusals, PacketsThatLie_AreRefused) {
    const std::string file = e57_file({{cartesian({{1, 2, 3}, {4, 5, 6}})}});
    // The header of the section begins at byte 48, that of its first packet 32 bytes later.
    for (const std::size_t at : {48u, 56u, 64u, 80u, 82u, 84u, 86u, 88u})
        for (const unsigned char value : {0x00, 0x7f, 0xff}) {
            const std::string changed =
                e57_changed(file, [&](std::string& content) { content[at] = static_cast<char>(value); });
            if (changed != file) refusal(changed);  // an Error or the points, but no crash
        }
    EXPECT_THAT(refusal(with_header(file, 80, std::uint8_t(9))), HasSubstr("libE57Format refuses it"));
}

}  // namespace
}  // namespace scanmill::test
