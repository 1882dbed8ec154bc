// SPDX-License-Identifier: GPL-3.0-or-later
// Modules of file formats: recognition without code, and unusable modules, which do not affect others.

#include "scanmill/plugin/format_modules.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "scanmill/plugin/module.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const FormatManifest abc_manifest{abi_text(), {"ABC", {"abc", "abcd"}, {"#ABC", "abc "}, {kind_of<PointCloud>()}}};

std::string refusal(const Format& row) {
    return sentence_of([&] { row.read({"a.abc", "#ABC"}, {}); });
}

TEST(FormatManifest, ComesBackTheSame) {
    const FormatManifest back = parse_format_manifest(to_json_text(abc_manifest));
    EXPECT_EQ(back.spec, abc_manifest.spec);
    EXPECT_EQ(back.abi, abc_manifest.abi);
}

TEST(FormatManifest, FormatsThatAreOnlyWritten_ComeBackTheSame) {
    FormatManifest written = abc_manifest;
    written.spec.reads = false;
    EXPECT_EQ(parse_format_manifest(to_json_text(written)).spec, written.spec);
    EXPECT_NE(written.spec, abc_manifest.spec);
}

TEST(FormatManifest, BeginningsOfAnyBytes_ComeBackTheSame) {
    FormatManifest binary = abc_manifest;
    std::string every_byte;
    for (int byte = 0; byte < 256; ++byte) every_byte += static_cast<char>(byte);
    binary.spec.begins = {"\x89PNG\r\n", every_byte};
    EXPECT_EQ(parse_format_manifest(to_json_text(binary)).spec, binary.spec);
}

TEST(FormatManifest, BeginningWithACharacterThatIsNotAByte_IsRefused) {
    std::string text = to_json_text(abc_manifest);
    text.replace(text.find("#ABC"), 4, "\u0100");
    EXPECT_THAT(sentence_of([&] { parse_format_manifest(text); }), HasSubstr("beyond U+00FF"));
}

TEST(FormatManifest, AnythingElse_IsRefused) {
    EXPECT_THAT(sentence_of([] { parse_format_manifest("{"); }), HasSubstr("is not a manifest"));
    EXPECT_THAT(sentence_of([] { parse_format_manifest("{\"scanmill-format\": 2}"); }), HasSubstr("of version 2"));
    FormatManifest nameless = abc_manifest;
    nameless.spec.extensions.clear();
    EXPECT_THROW(parse_format_manifest(to_json_text(nameless)), Error);
}

TEST(FormatModules, Recognition_NeedsNoCode) {
    const TemporaryFolder folder;
    folder.write("scanmill-abc.json", to_json_text(abc_manifest));
    folder.write("scanmill-abc.so", "no code at all");
    const std::vector<Format> rows = format_modules(folder.path());
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].recognises("#ABC 1\n", 7), Recognition::certain);
    EXPECT_EQ(rows[0].recognises("# ABC\n", 6), Recognition::no);
    EXPECT_TRUE(rows[0].has_extension(".ABCD"));
    EXPECT_TRUE(rows[0].writer(kind_of<PointCloud>()));
    EXPECT_FALSE(rows[0].writer(kind_of<TriangleMesh>()));
    EXPECT_THAT(refusal(rows[0]), HasSubstr("cannot be loaded")) << "the module is opened only now";
}

TEST(FormatModules, OnlyWritten_RefusesToReadWithoutItsCode) {
    const TemporaryFolder folder;
    FormatManifest written = abc_manifest;
    written.spec.reads = false;
    folder.write("scanmill-abc.json", to_json_text(written));
    folder.write("scanmill-abc.so", "no code at all");
    const std::vector<Format> rows = format_modules(folder.path());
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[0].recognises("#ABC 1\n", 7), Recognition::certain);
    EXPECT_TRUE(rows[0].is_refused);
    EXPECT_THAT(refusal(rows[0]), HasSubstr("ABC is written for other programs, and not read"));
}

TEST(FormatModules, UnusableOnes_HaveARowWithTheReason) {
    const TemporaryFolder folder;
    folder.write("scanmill-alone.json", to_json_text(abc_manifest));
    FormatManifest foreign = abc_manifest;
    foreign.abi = "another compiler";
    folder.write("scanmill-foreign.json", to_json_text(foreign));
    folder.write("scanmill-torn.json", "{\"scanmill-format\": 1,");
    folder.write("unrelated.json", "{}");
    const std::vector<Format> rows = format_modules(folder.path());
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_THAT(refusal(rows[0]), AllOf(HasSubstr("ALONE cannot be read"), HasSubstr("no module beside it")));
    EXPECT_THAT(rows[0].unusable, AllOf(HasSubstr("scanmill-alone.json"), HasSubstr("no module beside it")));
    EXPECT_THAT(refusal(rows[1]), AllOf(HasSubstr("'another compiler'"), HasSubstr(abi_text())));
    EXPECT_THAT(refusal(rows[2]), HasSubstr("is not a manifest"));
    EXPECT_TRUE(rows[2].has_extension("torn"));
}

TEST(FormatModules, ModuleOfAFilter_IsNotAFormat) {
    const std::filesystem::path filter = std::filesystem::path(test::test_plugin_folder()) / "scanmill-test-step.so";
    EXPECT_THAT(
        sentence_of([&] { load_format_module(filter, "test-step"); }),
        AllOf(HasSubstr("is not a file format"), HasSubstr("'scanmill-filter'"), HasSubstr("'scanmill-format'")));
}

TEST(FormatModules, MissingFolder_IsNone) { EXPECT_TRUE(format_modules("/no/such/folder").empty()); }

}  // namespace
}  // namespace scanmill::test
