// SPDX-License-Identifier: GPL-3.0-or-later
// Folders of modules: which filter is used, and the effect of a broken one on the others.

#include "scanmill/plugin/library.hpp"

#include "scanmill/base/hash.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include "scanmill/plugin/module.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::filesystem::path plugin_folder = test::test_plugin_folder();

/// A declaration that is sound and, by its summary, recognisable.
Manifest manifest_of(const std::string& name, const std::string& summary = "Is there to be found.") {
    Manifest manifest;
    manifest.abi = abi_text();
    manifest.spec.name = name;
    manifest.spec.summary = summary;
    manifest.spec.source = "Hand-made";
    manifest.spec.outputs = {{"mesh", kind_of<TriangleMesh>(), "Gives a mesh.", false, false}};
    return manifest;
}

/// A manifest, and beside it a file that is never loaded.
void add(const TemporaryFolder& folder, const std::string& name, const Manifest& manifest) {
    folder.write("scanmill-" + name + ".json", to_json_text(manifest));
    folder.write("scanmill-" + name + ".so", "never loaded");
}

/// test-step's own module under a manifest that `change` was let at.
template <class Change>
void add_test_step(const TemporaryFolder& folder, Change&& change) {
    Manifest manifest = parse_manifest(content_of(plugin_folder / "scanmill-test-step.json"));
    change(manifest.spec);
    folder.write("scanmill-test-step.json", to_json_text(manifest));
    folder.write("scanmill-test-step.so", content_of(plugin_folder / "scanmill-test-step.so"));
}

const UnusableModule* unusable(const FilterLibrary& library, std::string_view name) {
    for (const UnusableModule& module : library.unusable())
        if (module.name == name) return &module;
    return nullptr;
}

TEST(FilterLibrary, FoldersThatAreEmptyOrMissing_HoldNothing) {
    const TemporaryFolder folder;
    const FilterLibrary library({folder.path(), folder / "missing"});
    EXPECT_THAT(library.names(), IsEmpty());
    EXPECT_THAT(library.unusable(), IsEmpty());
    EXPECT_EQ(library.find("decimate"), nullptr);
    EXPECT_THAT(FilterLibrary({}).names(), IsEmpty());
}

TEST(FilterLibrary, Filters_AreSortedAndFoundWithoutLoadingCode) {
    const TemporaryFolder folder;
    for (const char* name : {"sculpt", "delaunay", "edge-flip"}) add(folder, name, manifest_of(name));
    FilterLibrary library({folder.path()});
    EXPECT_THAT(library.names(), ElementsAre("delaunay", "edge-flip", "sculpt"));
    ASSERT_TRUE(library.find("sculpt"));
    EXPECT_EQ(*library.find("sculpt"), manifest_of("sculpt").spec);
    EXPECT_EQ(library.module_file("sculpt"), folder / "scanmill-sculpt.so");
    EXPECT_EQ(library.find("sculp"), nullptr);
}

TEST(FilterLibrary, OtherFiles_AreNobodysBusiness) {
    const TemporaryFolder folder;
    folder.write("scanmill-lonely.so", "no manifest");
    folder.write("notes.json", "{}");
    folder.write("scanmill-notes.txt", "x");
    folder.write("below/scanmill-deep.json", "x");
    const FilterLibrary library({folder.path()});
    EXPECT_THAT(library.names(), IsEmpty());
    EXPECT_THAT(library.unusable(), IsEmpty());
}

TEST(FilterLibrary, FirstFolderWithAName_Counts) {
    const TemporaryFolder first, second;
    add(first, "sculpt", manifest_of("sculpt", "Comes from the first folder."));
    add(second, "sculpt", manifest_of("sculpt", "Comes from the second folder."));
    add(second, "delaunay", manifest_of("delaunay"));
    FilterLibrary library({first.path(), second.path()});
    EXPECT_THAT(library.names(), ElementsAre("delaunay", "sculpt"));
    EXPECT_EQ(library.find("sculpt")->summary, "Comes from the first folder.");
    EXPECT_EQ(library.module_file("sculpt"), first / "scanmill-sculpt.so");
    EXPECT_EQ(FilterLibrary({second.path(), first.path()}).find("sculpt")->summary, "Comes from the second folder.");
    EXPECT_THAT(library.unusable(), IsEmpty()) << "the second module of a name is ignored, not unusable";
}

TEST(FilterLibrary, UnusableManifests_AreRememberedWithTheirReasonAndHarmlessToOthers) {
    const TemporaryFolder folder;
    add(folder, "good", manifest_of("good"));
    folder.write("scanmill-garbage.json", "garbage");
    add(folder, "renamed", manifest_of("original"));
    Manifest stale = manifest_of("stale");
    stale.abi = "scanmill 0.0.1";
    add(folder, "stale", stale);
    add(folder, "unsound", manifest_of("unsound", "Mute"));
    folder.write("scanmill-alone.json", to_json_text(manifest_of("alone")));
    std::filesystem::create_symlink(folder / "nowhere", folder / "scanmill-dangling.json");

    const FilterLibrary library({folder.path()});
    EXPECT_THAT(library.names(), ElementsAre("good"));
    EXPECT_EQ(library.unusable().size(), 6u);
    const auto reason = [&](const char* name) {
        const UnusableModule* module = unusable(library, name);
        if (!module) return std::string("not remembered");
        EXPECT_EQ(module->manifest, folder / ("scanmill-" + std::string(name) + ".json"));
        EXPECT_EQ(library.find(name), nullptr);
        return module->reason;
    };
    EXPECT_THAT(reason("garbage"), testing::StartsWith("is not a manifest: "));
    EXPECT_EQ(reason("renamed"), "describes the filter 'original'");
    EXPECT_EQ(reason("stale"),
              "was built for another program: it needs 'scanmill 0.0.1', this is '" + abi_text() + "'");
    EXPECT_THAT(reason("unsound"), HasSubstr("is not a sentence"));
    EXPECT_EQ(reason("alone"), "has no module beside it");
    EXPECT_EQ(reason("dangling"), "cannot be read");
}

TEST(FilterLibrary, Load_GivesTheModulesDeclarationOnce) {
    FilterLibrary library({plugin_folder});
    EXPECT_THAT(library.names(), ElementsAre("test-draw", "test-step", "test-stream"));
    const FilterDeclaration& declaration = library.load("test-step");
    EXPECT_TRUE(declaration.run);
    EXPECT_EQ(declaration.spec, *library.find("test-step"));
    EXPECT_EQ(&library.load("test-step"), &declaration);
}

TEST(FilterLibrary, ManifestThatDiffersFromItsModule_IsRefusedWhenLoadedAndNotBefore) {
    const TemporaryFolder folder;
    add_test_step(folder, [](FilterSpec& spec) { spec.version = 2; });
    FilterLibrary library({folder.path()});
    EXPECT_THAT(library.names(), ElementsAre("test-step"));
    EXPECT_THAT(library.unusable(), IsEmpty());
    const Error error = error_of([&] { library.load("test-step"); });
    EXPECT_EQ(error.sentence(),
              "module '" + (folder / "scanmill-test-step.so").string() + "' differs from the manifest beside it");
    EXPECT_NE(error.hint(), "");
}

TEST(FilterLibrary, ManifestThatDiffersInAnyPart_IsRefused) {
    const auto is_refused = [](auto&& change) {
        const TemporaryFolder folder;
        add_test_step(folder, change);
        FilterLibrary library({folder.path()});
        try {
            library.load("test-step");
        } catch (const Error&) {
            return true;
        }
        return false;
    };
    EXPECT_FALSE(is_refused([](FilterSpec&) {}));
    EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.parameters[2].default_value = ParameterScalar(Length(1)); }));
    EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.parameters.pop_back(); }));
    EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.inputs[1].list = false; }));
    EXPECT_TRUE(is_refused([](FilterSpec& spec) { std::swap(spec.outputs[0], spec.outputs[1]); }));
    EXPECT_TRUE(is_refused([](FilterSpec& spec) { spec.metrics[0].unit = Unit::number; }));
}

TEST(FilterLibrary, BrokenModule_IsAnErrorOnlyForWhoLoadsIt) {
    const TemporaryFolder folder;
    add(folder, "broken", manifest_of("broken"));
    FilterLibrary library({folder.path(), plugin_folder});
    EXPECT_NO_THROW(library.load("test-step"));
    EXPECT_THAT(sentence_of([&] { library.load("broken"); }), HasSubstr("scanmill-broken.so' cannot be loaded"));
    EXPECT_THAT(sentence_of([&] { library.load("broken"); }), HasSubstr("cannot be loaded")) << "and again";
}

TEST(FilterLibrary, BuildId_IsTheModulesContent) {
    const TemporaryFolder folder, copy;
    add(folder, "sculpt", manifest_of("sculpt"));
    add(copy, "sculpt", manifest_of("sculpt", "Has another manifest beside it."));
    const auto build_id = [](const TemporaryFolder& where) { return FilterLibrary({where.path()}).build_id("sculpt"); };
    const std::string before = build_id(folder);
    EXPECT_EQ(before, content_hash(folder / "scanmill-sculpt.so"));
    EXPECT_EQ(build_id(copy), before) << "neither the folder nor the manifest matters";
    folder.write("scanmill-sculpt.so", "never loadeD");
    EXPECT_NE(build_id(folder), before);
}

TEST(FilterLibrary, BuildId_IsComputedOnce) {
    const TemporaryFolder folder;
    add(folder, "sculpt", manifest_of("sculpt"));
    FilterLibrary library({folder.path()});
    const std::string first = library.build_id("sculpt");
    folder.write("scanmill-sculpt.so", "changed under the running program");
    EXPECT_EQ(library.build_id("sculpt"), first);
}

/// Sets SCANMILL_PLUGIN_PATH for one test.
class PluginPath : public testing::Test {
protected:
    PluginPath() {
        if (const char* value = ::getenv(variable)) before_ = value;
    }
    ~PluginPath() override {
        if (before_)
            ::setenv(variable, before_->c_str(), 1);
        else
            ::unsetenv(variable);
    }
    static void set(const std::string& value) { ::setenv(variable, value.c_str(), 1); }

    static constexpr const char* variable = "SCANMILL_PLUGIN_PATH";
    std::optional<std::string> before_;
};

TEST_F(PluginPath, Unset_LeavesTheInstalledFolder) {
    ::unsetenv(variable);
    EXPECT_THAT(plugin_folders(), ElementsAre(installed_plugin_folder()));
    set("");
    EXPECT_THAT(plugin_folders(), ElementsAre(installed_plugin_folder()));
}

TEST_F(PluginPath, AbsoluteEntries_FollowTheInstalledFolderInOrder) {
    set("/b/plugins:/a");
    std::vector<std::string> ignored;
    EXPECT_THAT(plugin_folders(&ignored), ElementsAre(installed_plugin_folder(), "/b/plugins", "/a"));
    EXPECT_THAT(ignored, IsEmpty());
}

TEST_F(PluginPath, RelativeEntries_ArePassedOverAndReported) {
    set("plugins:/a:./here:..:~/mine");
    std::vector<std::string> ignored;
    EXPECT_THAT(plugin_folders(&ignored), ElementsAre(installed_plugin_folder(), "/a"));
    EXPECT_THAT(ignored, ElementsAre("plugins", "./here", "..", "~/mine"));
    EXPECT_EQ(plugin_folders().size(), 2u) << "the argument is optional";
}

TEST_F(PluginPath, EmptyEntries_AreNotTheWorkingFolder) {
    set("::/a:");
    std::vector<std::string> ignored;
    EXPECT_THAT(plugin_folders(&ignored), ElementsAre(installed_plugin_folder(), "/a"));
    EXPECT_THAT(ignored, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
