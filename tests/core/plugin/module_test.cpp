// SPDX-License-Identifier: GPL-3.0-or-later
// Loading one module: refusals and their reasons. The modules in unusable/ come from tests/modules.

#include "scanmill/plugin/module.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "scanmill/plugin/manifest.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;

const std::filesystem::path test_modules = test::test_plugin_folder();

std::filesystem::path good_module() { return test_modules / "scanmill-test-step.so"; }

/// The sentence of the refusal to load unusable/scanmill-<name>.so as the filter <name>; it always names the file.
std::string refusal(const std::string& name) {
    const std::filesystem::path module = test_modules / "unusable" / ("scanmill-" + name + ".so");
    EXPECT_TRUE(std::filesystem::exists(module)) << "tests/modules makes it";
    const std::string sentence = sentence_of([&] { load_module(module, name); });
    EXPECT_THAT(sentence, HasSubstr("'" + module.string() + "'"));
    return sentence;
}

TEST(LoadModule, GoodModule_GivesWhatItsManifestSays) {
    const FilterDeclaration declaration = load_module(good_module(), "test-step");
    const Manifest manifest = parse_manifest(content_of(test_modules / "scanmill-test-step.json"));
    EXPECT_EQ(declaration.spec, manifest.spec);
    EXPECT_EQ(manifest.abi, abi_text());
    EXPECT_TRUE(declaration.run);
}

TEST(LoadModule, AnotherAbi_IsRefusedWithBothTextsAndWithoutACall) {
    // The module's declaration would abort this program.
    EXPECT_THAT(refusal("foreign"),
                AllOf(HasSubstr("was built for another program"), HasSubstr("'scanmill 0.0.1, another compiler'"),
                      HasSubstr("'" + abi_text() + "'")));
    const Error error = error_of([] { load_module(test_modules / "unusable" / "scanmill-foreign.so", "foreign"); });
    EXPECT_THAT(error.hint(), HasSubstr("build the module again"));
}

TEST(LoadModule, OtherHeaders_AreAnotherAbi) {
    // Version and compiler are ours; the declaration's layout may not be, and calling it would abort this program.
    EXPECT_THAT(refusal("other-headers"),
                AllOf(HasSubstr("was built for another program"), HasSubstr("headers 0123456789abcdef"),
                      HasSubstr("'" + abi_text() + "'")));
}

TEST(LoadModule, AbiTextOfBeforeItNamedTheHeaders_IsAnotherAbi) {
    // It is ours in everything that it names.
    std::string older = abi_text();
    const std::size_t begin = older.find(", headers ");
    ASSERT_NE(begin, std::string::npos);
    older.erase(begin, older.find(',', begin + 1) - begin);
    EXPECT_THAT(refusal("headers-not-named"),
                AllOf(HasSubstr("was built for another program"),
                      HasSubstr("it needs '" + older + "', this is '" + abi_text() + "'")));
}

TEST(LoadModule, AnotherMagic_IsNoFilter) {
    EXPECT_THAT(refusal("other-magic"), AllOf(HasSubstr("is not a filter"), HasSubstr("begins with")));
}

TEST(LoadModule, OrdinaryLibrary_IsNoFilter) {
    EXPECT_THAT(refusal("exports-nothing"), EndsWith("is not a filter: it exports no scanmill_plugin"));
}

TEST(LoadModule, DeclarationThatThrows_IsRefusedWithItsReason) {
    EXPECT_THAT(refusal("throwing"),
                EndsWith("fails while it declares itself: the table of 7 magic numbers is missing"));
}

TEST(LoadModule, DeclarationThatThrowsANumber_IsRefused) {
    EXPECT_THAT(refusal("throwing-a-number"), EndsWith("with an exception of a foreign type"));
}

TEST(LoadModuleDeathTest, StaticObjectThatThrows_EndsTheProcessWithTheModulesName) {
    const auto module = test_modules / "unusable" / "scanmill-throwing-at-load.so";
    EXPECT_DEATH(load_module(module, "throwing-at-load"),
                 "the licence has run out.*this process ended while it loaded the module '" + module.string() + "'");
}

TEST(LoadModuleDeathTest, StaticObjectThatExits_EndsTheProcessWithTheModulesName) {
    const auto module = test_modules / "unusable" / "scanmill-exiting-at-load.so";
    EXPECT_EXIT(load_module(module, "exiting-at-load"), testing::ExitedWithCode(3),
                "this process ended while it loaded the module '" + module.string() + "'");
}

TEST(LoadModule, DeclarationOfAnotherName_IsRefused) {
    EXPECT_THAT(refusal("two-names"), EndsWith("declares the filter 'another-name', not 'two-names'"));
}

TEST(LoadModule, NothingToRun_IsRefused) {
    EXPECT_THAT(refusal("nothing-to-run"), EndsWith("declares nothing to run"));
}

TEST(LoadModule, FileOfAnotherName_IsRefused) {
    EXPECT_THAT(sentence_of([] { load_module(good_module(), "decimate"); }),
                EndsWith("contains the filter 'test-step', not 'decimate'"));
}

TEST(LoadModule, MissingFile_CannotBeLoaded) {
    const std::filesystem::path missing = test_modules / "scanmill-nowhere.so";
    EXPECT_THAT(sentence_of([&] { load_module(missing, "nowhere"); }),
                AllOf(HasSubstr("'" + missing.string() + "' cannot be loaded"), HasSubstr("No such file")));
}

TEST(LoadModule, Garbage_CannotBeLoaded) {
    const TemporaryFolder folder;
    for (const std::string& content : {std::string(),
                                       std::string("\x7f"
                                                   "ELF"),
                                       std::string("never a library"), std::string(5000, 'x'),
                                       "\x7f"
                                       "ELF" +
                                           std::string(5000, '\xff'),
                                       "\x7f"
                                       "ELF\2\1\1" +
                                           std::string(5000, '\0')}) {
        const auto module = folder.write("scanmill-garbage.so", content);
        EXPECT_THAT(sentence_of([&] { load_module(module, "garbage"); }), HasSubstr("'" + module.string() + "'"));
    }
}

TEST(LoadModule, CopyElsewhere_IsAModuleToo) {
    const TemporaryFolder folder;
    const auto copy = folder.write("anything.so", content_of(good_module()));
    EXPECT_EQ(load_module(copy, "test-step").spec, load_module(good_module(), "test-step").spec);
}

TEST(AbiText, NamesWhatMustAgree) {
    EXPECT_THAT(abi_text(), AllOf(HasSubstr("scanmill " SCANMILL_VERSION), HasSubstr("libstdc++"), HasSubstr("eigen 3"),
                                  testing::ContainsRegex("headers [0-9a-f]{16},")));
}

TEST(InstalledPluginFolder, LiesBesideTheCoreLibrary) {
    EXPECT_TRUE(std::filesystem::exists(core_library_file()));
    EXPECT_THAT(core_library_file().filename().string(), testing::StartsWith("libscanmill-core.so"));
    EXPECT_EQ(installed_plugin_folder(), std::filesystem::path(test::plugin_folder()));
    EXPECT_NE(installed_plugin_folder(), test_modules) << "no product ever sees the tests' modules";
}

}  // namespace
}  // namespace scanmill::test
