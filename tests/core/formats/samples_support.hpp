// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tables of files that other programs wrote, with the expected content of each.

#include <set>

#include "core/formats/support.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {

struct Sample {
    const char* file;  ///< under 6-formats
    std::size_t points;  ///< 0: the file is refused
    /// The names of the columns, or a part of the refusal.
    std::string warnings;
    Vec3 last{0, 0, 0};  ///< the last point, in the world
};

/// Reads every sample, and makes sure that the table has every file in those folders of the collection.
inline void check_samples(const std::vector<Sample>& samples, const std::vector<const char*>& folders) {
    SCANMILL_REAL_SCAN(collection, shared_data, "6-formats");
    std::set<std::string> unknown;
    for (const char* folder : folders)
        for (const auto& entry : fs::recursive_directory_iterator(collection / folder))
            if (entry.is_regular_file()) unknown.insert(fs::relative(entry.path(), collection).string());
    for (const Sample& sample : samples) {
        EXPECT_EQ(unknown.erase(sample.file), 1u) << sample.file;
        try {
            const auto cloud = read_points(collection / sample.file);
            EXPECT_EQ(cloud->size(), sample.points) << sample.file;
            std::string names;
            for (const Column& column : cloud->columns) names += (names.empty() ? "" : " ") + column.name();
            EXPECT_EQ(names, sample.warnings) << sample.file;
            // Half a unit in the last place of 10^7.
            EXPECT_LT((world_of(*cloud, cloud->size() - 1) - sample.last).norm(), 1e-9) << sample.file;
        } catch (const Error& error) {
            EXPECT_EQ(sample.points, 0u) << sample.file << ": " << error.sentence();
            EXPECT_THAT(error.sentence(), testing::HasSubstr(sample.warnings)) << sample.file;
        }
    }
    EXPECT_THAT(unknown, testing::IsEmpty());
}

}  // namespace scanmill::test
