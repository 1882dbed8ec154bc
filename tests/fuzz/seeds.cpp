// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/seeds.hpp"

#include <bit>
#include <cstdint>
#include <cstring>

#include "core/formats/las/las_support.hpp"
#ifdef SCANMILL_LAZ
#include "formats/laz/laz_support.hpp"
#endif
#include "scanmill/io/output_buffer.hpp"
#include "support/gzip.hpp"

namespace scanmill::test {

namespace {

/// A text, followed by binary numbers.
class Bytes {
public:
    Bytes(std::string text, std::endian order) : bytes_(std::move(text)), order_(order) {}

    template <class T>
    Bytes& put(std::initializer_list<T> numbers) {
        for (T number : numbers) {
            if (order_ != std::endian::native) number = byte_swapped(number);
            const std::size_t at = bytes_.size();
            bytes_.resize(at + sizeof(T));
            std::memcpy(bytes_.data() + at, &number, sizeof(T));
        }
        return *this;
    }
    const std::string& all() const { return bytes_; }

private:
    std::string bytes_;
    std::endian order_;
};

std::string ply_header(std::endian order, const std::string& elements) {
    const std::string format = order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    return "ply\nformat " + format + " 1.0\ncomment unit mm\n" + elements + "end_header\n";
}

/// Four points with everything that has a meaning: normals, colours, a column of several components, one of lists.
std::string ply_points(std::endian order) {
    Bytes file(ply_header(order,
                          "comment components 2 pair\nelement vertex 4\nproperty float x\nproperty float y\n"
                          "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                          "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty short pair_0\n"
                          "property short pair_1\nproperty list uchar int64 numbers\n"),
               order);
    for (const float z : {0.f, 1.f, 2.f, 1000000.f}) {
        file.put<float>({z, 0.5f, z, 0, 0, 1}).put<std::uint8_t>({255, 128, 0}).put<std::int16_t>({-1, 7});
        file.put<std::uint8_t>({2}).put<std::int64_t>({-5, 6});
    }
    return file.all();
}

/// Three points far from zero that can be read piece by piece, with columns before and after, and a line end.
std::string ply_stream(std::endian order) {
    Bytes file(ply_header(order,
                          "comment frame part\nelement vertex 3\nproperty uchar flag\nproperty double x\n"
                          "property double y\nproperty double z\nproperty float nx\nproperty float ny\n"
                          "property float nz\nelement face 0\nproperty list uchar int vertex_indices\n"),
               order);
    for (const double x : {5e6, 5e6 + 1, 5e6 + 2})
        file.put<std::uint8_t>({1}).put<double>({x, 0.5, -x}).put<float>({0, 0, 1});
    return file.all() + "\n";
}

/// A tetrahedron as a quad, two triangles and a strip, with edges; doubles far from zero.
std::string ply_mesh(std::endian order) {
    Bytes file(ply_header(order,
                          "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                          "element face 3\nproperty list uchar int vertex_indices\nproperty uchar part\n"
                          "element tristrips 1\nproperty list uint int vertex_indices\n"
                          "element edge 1\nproperty int vertex1\nproperty int vertex2\nproperty float length\n"
                          "element sharp_edge 1\nproperty uint vertex1\nproperty uint vertex2\n"
                          "element camera 1\nproperty float focus\n"),
               order);
    file.put<double>({1e6, 0, 0, 1e6 + 1, 0, 0, 1e6, 1, 0, 1e6, 0, 1});
    file.put<std::uint8_t>({4}).put<std::int32_t>({0, 1, 2, 3}).put<std::uint8_t>({1});
    file.put<std::uint8_t>({3}).put<std::int32_t>({0, 1, 3}).put<std::uint8_t>({2});
    file.put<std::uint8_t>({2}).put<std::int32_t>({0, 1}).put<std::uint8_t>({3});
    file.put<std::uint32_t>({6}).put<std::int32_t>({0, 1, 2, -1, 3, 1});
    file.put<std::int32_t>({1, 0}).put<float>({1}).put<std::uint32_t>({3, 2}).put<float>({35});
    return file.all();
}

std::string stl(std::string header, std::uint32_t promised, std::uint16_t attribute) {
    header.resize(80, ' ');
    Bytes file(header, std::endian::little);
    file.put<std::uint32_t>({promised});
    file.put<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}).put<std::uint16_t>({attribute});
    file.put<float>({0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 0}).put<std::uint16_t>({0});
    return file.all();
}

/// ASCII as little-endian UTF-16 with its mark.
std::string utf16(std::string_view text) {
    std::string bytes = "\xff\xfe";
    for (const char c : text) bytes += {c, '\0'};
    return bytes;
}

/// Two points of the format, with extra bytes described and the unit of a survey.
std::string las(u32 minor_version, u32 point_format, std::size_t point_size) {
    LasBytes file;
    file.minor_version = minor_version;
    file.point_format = point_format;
    file.scale = {0.001, 0.001, 0.01};
    file.offset = {500000, 4900000, 0};
    file.add_record("LASF_Projection", 34735, geo_keys({{3076, 9001}}));
    file.add_record("LASF_Spec", 4, las_extra(3, "range", 8, 0.5));
    file.points = {las_point(point_size + 2, 1, -2, 3), las_point(point_size + 2, 4000, 5000, -6000)};
    return file.file();
}

void add_laz(std::vector<Seed>& seeds) {
#ifdef SCANMILL_LAZ
    constexpr std::size_t points = 5, extra = 2;
    for (const u32 format : {1u, 3u, 5u, 7u, 10u})
        seeds.push_back({"laz", "format_" + std::to_string(format) + ".laz",
                         laz_file(noisy_points(format, points, extra), {.chunk_size = 2})});
    const LasBytes old = noisy_points(3, points);
    seeds.push_back({"laz", "one_run.laz", laz_file(old, {.method = LASZIP_COMPRESSOR_POINTWISE, .version = 1})});
    seeds.push_back({"laz", "chunks_differ.laz", laz_file(noisy_points(6, points), {.chunks = {1, 3, 1}})});
    const std::string bytes = laz_file(old);
    seeds.push_back({"laz", "table_cut_short.laz", bytes.substr(0, bytes.size() - 3)});
#else
    (void)seeds;
#endif
}

}  // namespace

std::vector<Seed> binary_seeds() {
    const std::string points = ply_points(std::endian::little);
    std::vector<Seed> seeds{
        {"ply", "points_little_endian.ply", points},
        {"ply", "points_big_endian.ply", ply_points(std::endian::big)},
        {"ply", "stream_little_endian.ply", ply_stream(std::endian::little)},
        {"ply", "stream_big_endian.ply", ply_stream(std::endian::big)},
        {"ply", "mesh_little_endian.ply", ply_mesh(std::endian::little)},
        {"ply", "mesh_big_endian.ply", ply_mesh(std::endian::big)},
        {"ply", "truncated_in_a_list.ply", points.substr(0, points.size() - 3)},
        {"stl", "two_facets.stl", stl("binary STL by scanmill; unit mm; frame part", 2, 0)},
        {"stl", "control_character_in_the_name.stl", stl("binary STL by scanmill; frame part  \x16", 2, 0)},
        {"stl", "attribute.stl", stl("solid in name only", 2, 31)},
        {"stl", "more_promised_than_there.stl", stl("", 3, 0)},
        {"ply", "gzip.ply", gzipped(points)},
        {"ply", "gzip_cut_short.ply", gzipped(points).substr(0, 100)},
        {"xyz", "gzip_of_two_members.xyz", gzipped("1 2 3\n") + gzipped("4 5 6\n")},
        {"xyz", "gzip_of_nothing.xyz", gzipped("")},
        {"csv", "utf16.csv", utf16("X;Y;Z\r\n1,5;2,5;3,5\r\n")},
        {"csv", "utf16_odd.csv", utf16("1;2;3\n") + "4"},
        {"las", "oldest.las", las(0, 0, 20)},
        {"las", "colours.las", las(2, 3, 34)},
        {"las", "newest.las", las(4, 8, 38)},
        {"las", "waves.las", las(4, 10, 67)},
        {"las", "compressed.las", las(2, 128, 20)},
    };
    add_laz(seeds);
    return seeds;
}

}  // namespace scanmill::test
