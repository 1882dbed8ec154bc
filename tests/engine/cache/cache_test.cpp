// SPDX-License-Identifier: GPL-3.0-or-later
// The store of results: stored values come back, damaged ones count as missing, with a warning. Values that do not fit
// are removed in the order of their last use, and a read-only folder does no harm.

#include "scanmill/cache/cache.hpp"

#include "scanmill/base/hash.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/module.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string key(32, 'a'), other_key(32, 'b');

Value line_of_points(std::size_t count) {
    Array<Vec3> positions(count);
    for (std::size_t i = 0; i < count; ++i) positions[i] = Vec3(static_cast<double>(i), 0, 0);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return std::make_shared<const PointCloud>(std::move(cloud));
}

std::size_t size_of(const std::optional<Value>& value) { return value ? value->get<PointCloud>()->size() : 0; }

StepResult some_result() {
    StepResult result;
    result.outputs = {{"points", kind_of<PointCloud>(), std::string(32, 'c'), 1234},
                      {"mesh", kind_of<TriangleMesh>(), "", 0}};
    result.resolved.values = {{"bin-size", Length(0.1)},
                              {"axis", std::vector<ParameterScalar>{0.1 + 0.2, Word{"auto"}}}};
    result.metrics = {{{"kept", 17, Unit::count}, {"rms", std::numeric_limits<double>::quiet_NaN(), Unit::length}}};
    result.properties = {{{"points", 17, Unit::count}}};
    result.warnings = {"one", "two\n\xff"};
    result.seconds = 0.1 + 0.2;
    result.filter = "thin";
    result.workflow = "thinning";
    return result;
}

class CacheTest : public testing::Test {
protected:
    Cache open(u64 limit = Cache::largest_default_limit) {
        return Cache(folder_ / "cache", limit, [this](std::string text) { told_.push_back(std::move(text)); });
    }
    /// The only file of its kind.
    fs::path only(std::string_view kind) {
        fs::path found;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache/v1" / kind))
            if (entry.is_regular_file()) {
                EXPECT_TRUE(found.empty()) << "one file of this kind was expected";
                found = entry.path();
            }
        return found;
    }
    static void age(const fs::path& file, int hours) {
        fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(hours));
    }

    TemporaryFolder folder_;
    std::vector<std::string> told_;
};

TEST_F(CacheTest, WhatWasNeverKept_IsMissing) {
    const Cache cache = open();
    EXPECT_FALSE(cache.run_key(key));
    EXPECT_FALSE(cache.step(key));
    EXPECT_FALSE(cache.has_value(key, 1));
    EXPECT_FALSE(cache.value(key));
    EXPECT_THAT(told_, IsEmpty());
    EXPECT_FALSE(fs::exists(folder_ / "cache")) << "asking makes nothing";
}

TEST_F(CacheTest, WhatWasKept_ComesBackToAnotherProcess) {
    const Value points = line_of_points(1000);
    const EncodedValue encoded(points);
    {
        Cache cache = open();
        EXPECT_TRUE(cache.keep_value(encoded));
        EXPECT_TRUE(cache.keep_step(key, some_result()));
        EXPECT_TRUE(cache.keep_run_key(other_key, key));
    }
    const Cache cache = open();
    EXPECT_EQ(cache.run_key(other_key), key);
    EXPECT_EQ(size_of(cache.value(encoded.content())), 1000u);
    const StepResult result = cache.step(key).value();
    EXPECT_EQ(result.outputs, some_result().outputs);
    EXPECT_EQ(result.output("points")->bytes, 1234u);
    EXPECT_EQ(result.output("nothing"), nullptr);
    EXPECT_EQ(result.resolved.values, some_result().resolved.values);
    EXPECT_EQ(result.metrics.find("kept")->value, 17);
    EXPECT_TRUE(std::isnan(result.metrics.find("rms")->value));
    EXPECT_EQ(result.properties.values, some_result().properties.values);
    EXPECT_EQ(result.warnings, some_result().warnings);
    EXPECT_EQ(result.seconds, 0.1 + 0.2);
    EXPECT_EQ(result.filter, "thin");
    EXPECT_EQ(result.workflow, "thinning");
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(CacheTest, DamagedEntries_AreRemovedToldAndMissing) {
    const EncodedValue encoded(line_of_points(10));
    Cache cache = open();
    cache.keep_value(encoded);
    cache.keep_step(key, some_result());
    cache.keep_run_key(other_key, key);
    for (const std::string_view kind : {"plans", "steps", "values"}) {
        const fs::path file = only(kind);
        std::string bytes = content_of(file);
        bytes.back() = static_cast<char>(bytes.back() ^ 1);
        folder_.write(fs::relative(file, folder_.path()).string(), bytes);
    }
    EXPECT_FALSE(cache.run_key(other_key));
    EXPECT_FALSE(cache.step(key));
    EXPECT_FALSE(cache.value(encoded.content()));
    EXPECT_EQ(told_.size(), 3u);
    for (const std::string& sentence : told_)
        EXPECT_THAT(sentence, testing::AllOf(HasSubstr("counts as missing"), HasSubstr("damaged")));
    EXPECT_FALSE(cache.has_value(encoded.content(), encoded.size()));
    EXPECT_TRUE(cache.keep_value(encoded)) << "and can be kept again";
    EXPECT_EQ(size_of(cache.value(encoded.content())), 10u);
}

TEST_F(CacheTest, EntryOfAnotherKindInItsPlace_IsNotTrusted) {
    Cache cache = open();
    cache.keep_run_key(key, other_key);
    fs::create_directories(folder_ / "cache/v1/steps/aa");
    fs::copy_file(only("plans"), folder_ / "cache/v1/steps/aa" / key);
    EXPECT_FALSE(cache.step(key));
    EXPECT_EQ(told_.size(), 1u);
}

TEST_F(CacheTest, BeyondItsLimit_WhatWasUsedLongestAgoGoes) {
    std::vector<std::string> contents;
    {
        Cache cache = open();
        for (const std::size_t count : {1000, 2000, 3000, 4000}) {
            const EncodedValue encoded(line_of_points(count));
            cache.keep_value(encoded);
            contents.push_back(encoded.content());
        }
        for (std::size_t i = 0; i < contents.size(); ++i)
            age(folder_ / ("cache/v1/values/" + contents[i].substr(0, 2) + "/" + contents[i]),
                10 - static_cast<int>(i));
        EXPECT_TRUE(cache.value(contents[0])) << "used now, so it is the youngest";
        EXPECT_EQ(cache.evict(), 0u) << "within the limit";
    }
    Cache cache = open(150'000);  // limit: 150 kB for 240 kB of values
    const u64 before = cache.info().bytes;
    EXPECT_GT(before, 240'000u);
    EXPECT_GT(cache.evict(), 0u);
    EXPECT_TRUE(cache.value(contents[0]));
    EXPECT_FALSE(cache.value(contents[1]));
    EXPECT_FALSE(cache.value(contents[2]));
    EXPECT_TRUE(cache.value(contents[3]));
    EXPECT_LE(cache.info().bytes, 135'000u);
}

TEST_F(CacheTest, Info_SharesTheBytesByFilterAndByLastUse) {
    const EncodedValue thinned(line_of_points(1000)), scanned(line_of_points(100)), unknown(line_of_points(10));
    const auto result_of = [](const EncodedValue& value, const std::string& filter) {
        StepResult result;
        result.outputs = {{"points", kind_of<PointCloud>(), value.content(), 1}};
        result.filter = filter;
        return result;
    };
    Cache cache = open();
    for (const EncodedValue* value : {&thinned, &scanned, &unknown}) cache.keep_value(*value);
    cache.keep_step(key, result_of(thinned, "thin"));
    cache.keep_step(other_key, result_of(scanned, ""));
    const auto value_file = [&](const EncodedValue& value) {
        return folder_ / ("cache/v1/values/" + value.content().substr(0, 2) + "/" + value.content());
    };
    age(value_file(thinned), 48);
    age(value_file(unknown), 24 * 100);
    const auto size_of_file = [](const fs::path& file) { return static_cast<u64>(fs::file_size(file)); };
    const u64 step = size_of_file(folder_ / "cache/v1/steps/aa" / key);
    const u64 read = size_of_file(folder_ / "cache/v1/steps/bb" / other_key);

    const CacheInfo info = cache.info();
    ASSERT_EQ(info.by_filter.size(), 3u);
    EXPECT_EQ(info.by_filter[0], (CacheUse{"thin", size_of_file(value_file(thinned)) + step}));
    EXPECT_EQ(info.by_filter[1], (CacheUse{"(scans)", size_of_file(value_file(scanned)) + read}));
    EXPECT_EQ(info.by_filter[2], (CacheUse{"(other)", size_of_file(value_file(unknown))}));
    ASSERT_EQ(info.by_age.size(), 4u);
    EXPECT_EQ(info.by_age[0].bytes, size_of_file(value_file(scanned)) + step + read);
    EXPECT_EQ(info.by_age[1].bytes, size_of_file(value_file(thinned)));
    EXPECT_EQ(info.by_age[2].bytes, 0u);
    EXPECT_EQ(info.by_age[3].bytes, size_of_file(value_file(unknown)));
}

TEST_F(CacheTest, Info_SharesTheBytesByWorkflow) {
    const EncodedValue own(line_of_points(1000)), shared(line_of_points(500)), old(line_of_points(100));
    const auto result_of = [](const std::vector<const EncodedValue*>& values, const std::string& workflow) {
        StepResult result;
        for (const EncodedValue* value : values)
            result.outputs.push_back({"points", kind_of<PointCloud>(), value->content(), 1});
        result.workflow = workflow;
        return result;
    };
    Cache cache = open();
    for (const EncodedValue* value : {&own, &shared, &old}) cache.keep_value(*value);
    const std::string old_key(32, 'd');
    cache.keep_step(key, result_of({&own, &shared}, "watertight"));
    cache.keep_step(other_key, result_of({&shared}, "zoom"));
    cache.keep_step(old_key, result_of({&old, &own}, ""));
    cache.keep_step(key, result_of({}, "later"));  // does not replace the result
    cache.keep_run_key(old_key, key);
    const auto bytes_in = [&](const std::string& kind, const std::string& name) {
        return static_cast<u64>(fs::file_size(folder_ / ("cache/v1/" + kind + "/" + name.substr(0, 2) + "/" + name)));
    };
    const CacheInfo info = cache.info();
    ASSERT_EQ(info.by_workflow.size(), 3u);
    EXPECT_EQ(info.by_workflow[0],
              (CacheUse{"watertight", bytes_in("values", own.content()) + bytes_in("values", shared.content()) +
                                          bytes_in("steps", key)}));
    EXPECT_EQ(info.by_workflow[1], (CacheUse{"unknown", bytes_in("values", old.content()) + bytes_in("steps", old_key) +
                                                            bytes_in("plans", old_key)}));
    EXPECT_EQ(info.by_workflow[2], (CacheUse{"zoom", bytes_in("steps", other_key)}));
}

TEST(DefaultCacheLimit, IsATenthOfTheDiskAndAtMostTwentyGibibytes) {
    EXPECT_EQ(default_cache_limit_of(100'000), 10'000u);
    EXPECT_EQ(default_cache_limit_of(u64(200) << 30), u64(20) << 30);
    EXPECT_EQ(default_cache_limit_of(u64(1) << 60), u64(20) << 30);
    const TemporaryFolder folder;
    const u64 expected = default_cache_limit_of(fs::space(folder.path()).capacity);
    EXPECT_EQ(default_cache_limit(folder.path()), expected);
    EXPECT_EQ(default_cache_limit(folder / "not/yet/there"), expected) << "the disk that will hold it";
}

TEST_F(CacheTest, EvictedWhileItIsRead_AValueStays) {
    Cache cache = open(1);
    const EncodedValue encoded(line_of_points(1000));
    cache.keep_value(encoded);
    const std::optional<Value> value = cache.value(encoded.content());
    EXPECT_GT(cache.evict(), 0u);
    EXPECT_FALSE(cache.has_value(encoded.content(), encoded.size()));
    EXPECT_EQ(value->get<PointCloud>()->positions[999], Vec3(999, 0, 0));
}

TEST_F(CacheTest, Clear_RemovesWhatIsTheCachesAndNothingElse) {
    Cache cache = open();
    cache.keep_value(EncodedValue(line_of_points(10)));
    folder_.write("cache/notes.txt", "mine");
    EXPECT_GT(cache.clear(), 0u);
    EXPECT_EQ(cache.info().bytes, 0u);
    EXPECT_EQ(content_of(folder_ / "cache/notes.txt"), "mine");
    EXPECT_TRUE(cache.keep_run_key(key, other_key)) << "and goes on";
}

TEST_F(CacheTest, FolderThatCannotBeMade_IsToldOnceAndDoesNoHarm) {
    folder_.write("cache", "a file");
    Cache cache = open();
    EXPECT_FALSE(cache.keep_run_key(key, other_key));
    EXPECT_FALSE(cache.keep_value(EncodedValue(line_of_points(10))));
    EXPECT_FALSE(cache.run_key(key));
    ASSERT_EQ(told_.size(), 1u);
    EXPECT_THAT(told_[0], HasSubstr("does not store new results"));
}

TEST_F(CacheTest, ManyThreadsWithTheSameEntries_AgreeAndLeaveNoPieces) {
    const EncodedValue encoded(line_of_points(5000));
    std::vector<std::thread> threads;
    std::atomic<int> wrong = 0;
    for (int i = 0; i < 8; ++i)
        threads.emplace_back([&] {
            Cache cache(folder_ / "cache");
            for (int round = 0; round < 20; ++round) {
                if (!cache.keep_value(encoded)) ++wrong;
                if (round % 5 == 4) cache.clear();
                if (const auto value = cache.value(encoded.content()); value && size_of(value) != 5000) ++wrong;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0);
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache/v1"))
        EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry.path();
}

TEST_F(CacheTest, HashOfAFile_IsRememberedOnceItHasSettled) {
    Cache cache = open();
    const fs::path file = folder_.write("scan.ply", "some bytes");
    const std::string hash = cache.file_hash(file);
    EXPECT_EQ(hash, content_hash(file));
    // Rewritten in the same second, with the same size and times: only the bytes differ.
    const auto written = fs::last_write_time(file);
    folder_.write("scan.ply", "same bytes");
    fs::last_write_time(file, written);
    EXPECT_EQ(cache.file_hash(file), content_hash(file));
    EXPECT_NE(cache.file_hash(file), hash);
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(CacheTest, HashOfAFileThatIsNotThere_IsAnError) {
    EXPECT_THAT(sentence_of([&] { open().file_hash(folder_ / "absent"); }), HasSubstr("cannot be read"));
}

TEST(DefaultCacheFolder, FollowsTheEnvironment) {
    const char* const home = std::getenv("HOME");
    const std::string old_home = home ? home : "";
    ::setenv("XDG_CACHE_HOME", "/somewhere", 1);
    EXPECT_EQ(default_cache_folder(), "/somewhere/scanmill");
    ::setenv("XDG_CACHE_HOME", "relative", 1);
    ::setenv("HOME", "/home/me", 1);
    EXPECT_EQ(default_cache_folder(), "/home/me/.cache/scanmill");
    ::unsetenv("HOME");
    EXPECT_EQ(error_of([] { default_cache_folder(); }).remedy(), Remedy::choose_cache_folder);
    ::unsetenv("XDG_CACHE_HOME");
    if (home) ::setenv("HOME", old_home.c_str(), 1);
}

}  // namespace
}  // namespace scanmill::test
