// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tables of meshes and points in mesh formats, written by other programs, with the content that another reader finds.

#include <Eigen/Geometry>
#include <cmath>

#include "core/formats/support.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {

struct MeshSample {
    const char* file;
    const char* what;
    std::size_t vertices;  ///< 0: the file is refused
    std::size_t triangles;  ///< 0: the file is read as points
    double area;
    /// A part of a warning or, without vertices, of the refusal; empty when no warning is allowed.
    const char* warnings = "";
};

inline double area_of(const TriangleMesh& mesh) {
    double sum = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
        sum += (b - a).cross(c - a).norm() / 2;
    }
    return sum;
}

inline void expect_as_stated(const MeshSample& sample, const fs::path& folder) {
    SCOPED_TRACE(std::string(sample.file) + ": " + sample.what);
    Warnings warnings;
    try {
        const LoadedFile loaded = read_file(folder / sample.file, warnings.reading());
        if (const auto* cloud = loaded.value.find<PointCloud>()) {
            EXPECT_EQ(cloud->size(), sample.vertices);
            EXPECT_EQ(sample.triangles, 0u);
        } else {
            const TriangleMesh& mesh = *loaded.value.get<TriangleMesh>();
            require_consistent(mesh);
            EXPECT_EQ(mesh.positions.size(), sample.vertices);
            EXPECT_EQ(mesh.triangles.size(), sample.triangles);
            if (std::isnan(sample.area))
                EXPECT_TRUE(std::isnan(area_of(mesh)));
            else
                EXPECT_NEAR(area_of(mesh), sample.area, 1e-12 * sample.area);
        }
    } catch (const Error& error) {
        EXPECT_EQ(sample.vertices, 0u) << error.what();
        warnings.sentences.push_back(error.sentence());
    }
    if (std::string_view(sample.warnings).empty())
        EXPECT_THAT(warnings.sentences, testing::IsEmpty());
    else
        EXPECT_THAT(warnings.sentences, testing::Contains(testing::HasSubstr(sample.warnings)));
}

/// Checks every sample, and that every file of the folder is in the table.
inline void expect_as_stated(const std::vector<MeshSample>& samples, const fs::path& folder) {
    for (const MeshSample& sample : samples) expect_as_stated(sample, folder);
    std::size_t files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) files += entry.is_regular_file();
    EXPECT_EQ(files, samples.size());
}

}  // namespace scanmill::test
