// SPDX-License-Identifier: GPL-3.0-or-later
// The same random table, written by hand in the three encodings, must give equal results, and so must the fast and the
// general path for positions.
#include <limits>
#include <random>

#include "core/formats/support.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

struct Variants {
    std::string ascii, little, big;

    void text(const std::string& piece) {
        ascii += piece;
        little += piece;
        big += piece;
    }
    template <class T>
    void number(T value) {
        if constexpr (std::is_floating_point_v<T>)
            ascii += number_text(static_cast<double>(value)) + " ";
        else
            ascii += std::to_string(value) + " ";
        little += bytes_of(value, false);
        big += bytes_of(value, true);
    }
    void end_row() { ascii += "\n"; }
    static Variants begin() {
        return {"ply\nformat ascii 1.0\n", "ply\nformat binary_little_endian 1.0\n",
                "ply\nformat binary_big_endian 1.0\n"};
    }
};

/// Every type as a scalar and in a list, lists between scalars, an unknown element between them.
Variants random_file(std::mt19937& random, std::size_t vertices, std::size_t faces) {
    Variants file = Variants::begin();
    file.text("element vertex " + std::to_string(vertices) +
              "\nproperty char a\nproperty double z\nproperty list ushort short list_of_short\nproperty float x\n"
              "property uint b\nproperty float32 y\nproperty int16 c\nproperty list uint8 float64 list_of_double\n"
              "property uint64 d\nproperty float nx\nproperty float ny\nproperty float nz\n"
              "element unknown 3\nproperty list int float stuff\nproperty uchar more\nelement face " +
              std::to_string(faces) +
              "\nproperty uchar label\nproperty list int8 uint vertex_indices\nproperty int64 key\nend_header\n");
    const auto real = [&] { return static_cast<float>(static_cast<int>(random() % 20001) - 10000) / 16.0f; };
    for (std::size_t row = 0; row < vertices; ++row) {
        file.number(static_cast<std::int8_t>(random()));
        file.number(static_cast<double>(random()) / 3);
        const auto length = static_cast<std::uint16_t>(random() % 4);
        file.number(length);
        for (int i = 0; i < length; ++i) file.number(static_cast<std::int16_t>(random()));
        file.number(real());
        file.number(static_cast<u32>(random()));
        file.number(real());
        file.number(static_cast<std::int16_t>(random()));
        const auto doubles = static_cast<u8>(random() % 3);
        file.number(doubles);
        for (int i = 0; i < doubles; ++i) file.number(static_cast<double>(random()) * 1e-200);
        file.number(u64(random()) << 32 | random());
        for (int i = 0; i < 3; ++i) file.number(real());
        file.end_row();
    }
    for (int row = 0; row < 3; ++row) {
        file.number(std::int32_t(2));
        file.number(1.5f);
        file.number(2.5f);
        file.number(u8(9));
        file.end_row();
    }
    for (std::size_t row = 0; row < faces; ++row) {
        file.number(static_cast<u8>(random()));
        const auto length = static_cast<std::int8_t>(3 + random() % 3);
        file.number(length);
        for (int i = 0; i < length; ++i) file.number(static_cast<u32>(random() % vertices));
        file.number(static_cast<std::int64_t>(u64(random()) << 32 | random()));
        file.end_row();
    }
    return file;
}

TEST(PlyReader_Encodings, RandomTables_ReadAlikeInAllThree) {
    std::mt19937 random(7);
    for (int round = 0; round < 30; ++round) {
        const Variants file = random_file(random, 1 + random() % 40, 1 + random() % 40);
        const auto ascii = mesh_in(file.ascii, "a.ply");
        ASSERT_EQ(ascii->vertex_columns.size(), 7u);
        ASSERT_EQ(ascii->face_columns.size(), 2u);
        for (const std::string& variant : {file.little, file.big}) {
            const auto mesh = mesh_in(variant, "a.ply");
            EXPECT_TRUE(std::ranges::equal(mesh->positions, ascii->positions));
            EXPECT_TRUE(std::ranges::equal(mesh->triangles, ascii->triangles));
            EXPECT_EQ(mesh->frame, ascii->frame);
            EXPECT_EQ(mesh->vertex_columns, ascii->vertex_columns);
            EXPECT_EQ(mesh->face_columns, ascii->face_columns);
        }
    }
}

TEST(PlyReader_Encodings, AreNamed) {
    std::mt19937 random(8);
    const Variants file = random_file(random, 3, 1);
    EXPECT_EQ(read_bytes(file.ascii, "a").encoding, "ascii");
    EXPECT_EQ(read_bytes(file.little, "a").encoding, "binary little-endian");
    EXPECT_EQ(read_bytes(file.big, "a").encoding, "binary big-endian");
    EXPECT_EQ(read_bytes(file.big, "a").format, "PLY");
}

/// Points with adjacent x, y, z (the fast path) or separate ones (the general path).
template <class Scalar>
std::string points_file(const std::vector<std::array<Scalar, 3>>& points, bool side_by_side, bool big_endian) {
    const std::string type = sizeof(Scalar) == 4 ? "float" : "double";
    std::string file = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                       "_endian 1.0\nelement vertex " + std::to_string(points.size()) + "\nproperty uchar before\n";
    for (const char* axis : {"x", "y", "z"})
        file += "property " + type + " " + axis + "\n" +
                (side_by_side || *axis == 'z' ? "" : std::string("property uchar after_") + axis + "\n");
    file += "property short after\nend_header\n";
    for (std::size_t row = 0; row < points.size(); ++row) {
        file += bytes_of(static_cast<u8>(row));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            file += bytes_of(points[row][axis], big_endian);
            if (!side_by_side && axis < 2) file += 'x';
        }
        file += bytes_of(static_cast<std::int16_t>(row), big_endian);
    }
    return file;
}

template <class Scalar>
void expect_all_ways_alike(const std::vector<std::array<Scalar, 3>>& points) {
    for (bool side_by_side : {true, false})
        for (bool big_endian : {false, true}) {
            const auto cloud = points_in(points_file(points, side_by_side, big_endian), "a.ply");
            ASSERT_EQ(cloud->size(), points.size());
            for (std::size_t row = 0; row < points.size(); ++row) {
                const Vec3 p = world_of(*cloud, row);
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const double expected = static_cast<double>(points[row][axis]);
                    const double found = p[static_cast<int>(axis)];
                    ASSERT_TRUE(found == expected || (std::isnan(found) && std::isnan(expected))) << row << " " << axis;
                }
            }
            EXPECT_EQ(numbers_of<std::int16_t>(cloud->columns.find("after")).back(),
                      static_cast<std::int16_t>(points.size() - 1));
            EXPECT_EQ(numbers_of<u8>(cloud->columns.find("before")).back(), static_cast<u8>(points.size() - 1));
        }
}

TEST(PlyReader_Positions, FastAndPlainWay_GiveTheFilesCoordinates) {
    std::mt19937 random(9);
    for (std::size_t count : {1, 2, 1023, 1024, 1025, 5000}) {
        std::vector<std::array<float, 3>> floats(count);
        std::vector<std::array<double, 3>> doubles(count);
        for (std::size_t row = 0; row < count; ++row)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                floats[row][axis] = static_cast<float>(random()) / 7.0f;
                doubles[row][axis] = 1e7 * static_cast<double>(axis) + static_cast<double>(random()) / 4294967296.0;
            }
        expect_all_ways_alike(floats);
        expect_all_ways_alike(doubles);
    }
}

TEST(PlyReader_Positions, FarPointsAmongInvalidOnes_GetTheOriginOfTheFiniteOnes) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    // The invalid rows come first, last, and alone in their block; a NaN must not hide the bounds of its neighbours.
    std::vector<std::array<float, 3>> points(3000, {4096.25f, -8192.5f, 0.0f});
    points[0] = {nan, 1e30f, 0};
    points[1] = {4097, -8193, 1};
    points[1500] = {inf, 0, 0};
    points[2999] = {0, 0, -inf};
    for (bool side_by_side : {true, false}) {
        const auto cloud = points_in(points_file(points, side_by_side, false), "a.ply");
        EXPECT_NEAR(cloud->frame.origin.x(), 4096, 4);
        EXPECT_NEAR(cloud->frame.origin.y(), -8192, 4);
        EXPECT_EQ(cloud->frame.origin.z(), 0);
        EXPECT_EQ(world_of(*cloud, 1), Vec3(4097, -8193, 1));
        EXPECT_EQ(world_of(*cloud, 1500).x(), std::numeric_limits<double>::infinity());
        EXPECT_TRUE(std::isnan(world_of(*cloud, 0).x()));
    }
}

TEST(PlyReader_Positions, IntegerCoordinates_BecomeDouble) {
    std::string file =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty ushort y\nproperty int "
        "z\nend_header\n";
    file += bytes_of(std::int8_t(-5)) + bytes_of(std::uint16_t(65535)) + bytes_of(std::int32_t(-2000000000));
    EXPECT_EQ(world_of(*points_in(file, "a.ply"), 0), Vec3(-5, 65535, -2000000000));
}

}  // namespace
}  // namespace scanmill::test
