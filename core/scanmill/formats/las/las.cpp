// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/las/detail/las_columns.hpp"
#include "scanmill/formats/las/detail/las_content.hpp"

namespace scanmill {

namespace {

/// The records of all points, in one or more pieces.
class Pieces {
public:
    explicit Pieces(std::size_t record_size) : record_size_(record_size) {}

    /// Divides the records of an uncompressed file into pieces that fit the cache of a core.
    void add_all(std::string_view records) {
        constexpr std::size_t piece_rows = 1 << 12;
        for (std::size_t i = 0; i < records.size(); i += piece_rows * record_size_)
            add(records.substr(i, piece_rows * record_size_));
    }
    void add(std::string_view records) {
        pieces_.push_back(records);
        begin_.push_back(begin_.back() + records.size() / record_size_);
    }
    /// Keeps a copy.
    void add_copy(std::string_view records) {
        copies_.emplace_back(records.begin(), records.end());
        add({copies_.back().data(), copies_.back().size()});
    }

    std::size_t size() const { return pieces_.size(); }
    std::size_t rows() const { return begin_.back(); }
    std::span<const std::size_t> begin() const { return begin_; }
    std::string_view operator[](std::size_t piece) const { return pieces_[piece]; }
    std::size_t rows_of(std::size_t piece) const { return begin_[piece + 1] - begin_[piece]; }

private:
    std::size_t record_size_;
    std::vector<std::string_view> pieces_;
    std::vector<std::size_t> begin_{0};
    std::vector<Array<char>> copies_;
};

PointCloud cloud_of(const LasContent& content, const Pieces& pieces, const ReadOptions& options) {
    const LasHeader& header = content.parts.header;
    LasFacts facts;
    for (std::size_t i = 0; i < pieces.size(); ++i) facts.add(header, pieces[i]);
    const std::vector<LasColumn> columns = las_columns(header, content.extras, facts, options);

    PointCloud cloud;
    cloud.frame.unit = content.unit;
    const auto read_world = [&](std::size_t piece, Array<Vec3>& buffer) -> std::span<const Vec3> {
        buffer.resize(pieces.rows_of(piece));
        las_positions(header, Vec3::Zero(), pieces[piece], buffer);
        return buffer;
    };
    BoundingBox box = facts.box(header, Vec3::Zero());
    if (!box.low.allFinite() || !box.high.allFinite()) {
        // A huge scale makes some coordinates infinite; the box is that of the others.
        box = {};
        Array<Vec3> buffer;
        for (std::size_t i = 0; i < pieces.size(); ++i)
            if (const BoundingBox part = bounding_box(read_world(i, buffer)); !part.empty())
                for (const Vec3& corner : {part.low, part.high}) box.add(corner);
    }
    cloud.frame.origin = distant_origin(robust_box({pieces.begin(), read_world}, box).robust);

    Array<Vec3> positions(pieces.rows());
    LasTable table(columns, pieces.rows());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const std::size_t begin = pieces.begin()[i];
        las_positions(header, cloud.frame.origin, pieces[i], std::span(positions).subspan(begin, pieces.rows_of(i)));
        table.decode(begin, pieces[i], header.point_size);
    }
    cloud.positions = std::move(positions);
    cloud.columns = table.finish();
    return cloud;
}

bool is_las(std::string_view head, bool compressed) {
    return head.starts_with(las_magic) && is_marked_compressed(head) == compressed;
}

}  // namespace

LoadedFile read_las(const FileBytes& file, const ReadOptions& options, const LazForm* laz) {
    const LasContent content = read_las_content(file, options, laz != nullptr);
    const LasHeader& header = content.parts.header;
    const std::string compression = laz ? laz->encoding(content.parts) + ", " : "";
    Pieces pieces(header.point_size);
    if (laz)
        laz->decompress(content.parts, 1, [&](std::string_view records) { pieces.add_copy(records); });
    else
        pieces.add_all(content.points());
    return {std::make_shared<const PointCloud>(cloud_of(content, pieces, options)), laz ? "LAZ" : "LAS",
            fmt::format("{}binary little-endian, 1.{}, point format {}", compression, header.minor_version,
                        header.point_format),
            content.comments};
}

Format las_format() {
    const auto recognise = [](std::string_view head, u64) {
        return is_las(head, false) ? Recognition::certain : Recognition::no;
    };
    const auto read = [](const FileBytes& file, const ReadOptions& options) { return read_las(file, options); };
    Format las{"LAS", {"las"}, recognise, read, {}};
    las.memory_per_byte = 5;
    las.may_stream = [](std::string_view file) { return may_be_las_stream(file, false); };
    las.open_stream = [](std::unique_ptr<MappedFile> file, const ReadOptions& options, unsigned threads,
                         const OnWorldPositions& on_positions) {
        return open_las_stream(std::move(file), options, threads, on_positions);
    };
    return las;
}

Format refused_laz_format() {
    const auto recognise = [](std::string_view head, u64) {
        return is_las(head, true) ? Recognition::certain : Recognition::no;
    };
    const auto refuse = [](const FileBytes& file, const ReadOptions& options) { return read_las(file, options); };
    return {"LAZ", {"laz"}, recognise, refuse, {}, true};
}

}  // namespace scanmill
