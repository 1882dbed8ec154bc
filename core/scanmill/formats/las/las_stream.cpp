// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "scanmill/base/parallel.hpp"
#include "scanmill/formats/las/detail/las_columns.hpp"
#include "scanmill/formats/las/detail/las_content.hpp"
#include "scanmill/io/unnamed_file.hpp"

namespace scanmill {

namespace {

constexpr std::size_t rows_per_piece = std::size_t(1) << 16;

/// A stream over the records of an uncompressed file, or over the records that were restored from a compressed one.
class LasStream : public PointStream {
public:
    LasStream(std::unique_ptr<MappedFile> file, LasContent content)
        : file_(std::move(file)),
          content_(std::move(content)),
          header_(content_.parts.header) {
        for (std::size_t row = 0; row < header_.points; row += rows_per_piece) pieces_.push_back(row);
        pieces_.push_back(header_.points);
    }

    /// Returns false if a coordinate is not finite.
    bool open(const ReadOptions& options, unsigned threads, const OnWorldPositions& on_positions,
              const LasDecompress& decompress) {
        frame_.unit = content_.unit;
        LasFacts facts;
        if (decompress)
            restore(facts, threads, on_positions, decompress);
        else
            read_all(facts, threads, on_positions);
        world_.box = facts.box(header_, Vec3::Zero());
        world_.finite = world_.box.low.allFinite() && world_.box.high.allFinite();
        if (!world_.finite) return false;
        columns_ = las_columns(header_, content_.extras, facts, options);
        choose_near_origin(facts);
        return true;
    }

    ColumnTable read_columns(std::size_t piece) const override {
        const std::string_view records = records_of(piece);
        LasTable table(columns_, records.size() / header_.point_size);
        file_->fetch(records);
        table.decode(0, records, header_.point_size);
        file_->release(records);
        return table.finish();
    }

private:
    std::string_view records_of(std::size_t piece) const {
        return records_.substr(pieces_[piece] * header_.point_size,
                               (pieces_[piece + 1] - pieces_[piece]) * header_.point_size);
    }

    /// Restores the points into an unnamed file, which replaces the compressed file.
    void restore(LasFacts& facts, unsigned threads, const OnWorldPositions& on_positions,
                 const LasDecompress& decompress) {
        UnnamedFile restored;
        content_.parts.release = [this](std::string_view part) { file_->release(part); };
        Array<Vec3> positions;
        decompress(content_.parts, threads, [&](std::string_view records) {
            restored.append(records);
            facts.add(header_, records);
            if (!on_positions) return;
            positions.resize(records.size() / header_.point_size);
            las_positions(header_, Vec3::Zero(), records, positions);
            on_positions(positions);
        });
        content_.parts.release = {};
        content_.parts.records.clear();  // they view the compressed file
        file_ = restored.map();
        content_.parts.bytes = records_ = file_->bytes();
    }

    void read_all(LasFacts& facts, unsigned threads, const OnWorldPositions& on_positions) {
        records_ = content_.points();
        struct Room {
            Array<Vec3> positions;
            LasFacts facts;
        };
        for_each_in_order<Room>(
            threads, pieces_.size() - 1,
            [&](std::size_t piece, Room& room) {
                const std::string_view records = records_of(piece);
                file_->fetch(records);
                room.facts = {};
                room.facts.add(header_, records);
                room.positions.resize(records.size() / header_.point_size);
                las_positions(header_, Vec3::Zero(), records, room.positions);
                file_->release(records);
            },
            [&](std::size_t, const Room& room) {
                facts.add(room.facts);
                if (on_positions) on_positions(room.positions);
            });
    }

    /// Positions near the origin resolve more than world positions, so they are not derived from these. The origin is
    /// that of the whole reader.
    void choose_near_origin(const LasFacts& facts) {
        const auto read_piece = [this](std::size_t piece, Array<Vec3>& buffer) -> std::span<const Vec3> {
            read(piece, buffer);
            return buffer;
        };
        box_ = scanmill::robust_box({pieces_, read_piece}, world_.box);
        frame_.origin = distant_origin(box_.robust);
        if (frame_.origin == Vec3::Zero()) return;
        box_ = scanmill::robust_box({pieces_, read_piece}, facts.box(header_, frame_.origin));
    }

    /// Reads positions relative to `origin`; returns the bounds of the world positions.
    FiniteBounds read_from(const Vec3& origin, std::size_t piece, Array<Vec3>& positions) const {
        const std::string_view records = records_of(piece);
        file_->fetch(records);
        positions.resize(records.size() / header_.point_size);
        las_positions(header_, origin, records, positions);
        LasFacts facts;
        facts.add_bounds(header_, records);
        file_->release(records);
        return {facts.box(header_, Vec3::Zero())};
    }

    FiniteBounds read_world(std::size_t piece, Array<Vec3>& positions) const override {
        return read_from(Vec3::Zero(), piece, positions);
    }
    FiniteBounds read_near(std::size_t piece, Array<Vec3>& positions) const override {
        return read_from(frame_.origin, piece, positions);
    }

    /// The records of these rows. Rows that are far apart load as many pages as all rows, so pages are released after
    /// each stretch.
    Array<char> picked_records(std::span<const u32> rows) const {
        constexpr std::size_t longest_stretch = std::size_t(1) << 20;
        const std::size_t size = header_.point_size;
        Array<char> picked(rows.size() * size);
        char* destination = picked.data();
        u32 first = rows.front();
        for (const u32 row : rows) {
            if ((row - first) * size > longest_stretch) {
                file_->release(records_.substr(first * size, (row - first) * size));
                first = row;
            }
            destination = std::ranges::copy(records_.substr(row * size, size), destination).out;
        }
        file_->release(records_.substr(first * size, (rows.back() - first + 1) * size));
        return picked;
    }

    PointCloud gather_from(const Vec3& origin, std::span<const u32> rows, unsigned threads, FiniteBounds& world) const {
        Array<Vec3> positions(rows.size());
        LasTable table(columns_, rows.size());
        constexpr std::size_t block = 1 << 14;
        std::vector<LasFacts> parts((rows.size() + block - 1) / block);
        for_each_chunk(threads, rows.size(), block, [&](std::size_t begin, std::size_t end) {
            const Array<char> picked = picked_records(rows.subspan(begin, end - begin));
            const std::string_view records(picked.data(), picked.size());
            las_positions(header_, origin, records, std::span(positions).subspan(begin, end - begin));
            table.decode(begin, records, header_.point_size);
            parts[begin / block].add_bounds(header_, records);
        });
        for (const LasFacts& part : parts) world.add({part.box(header_, Vec3::Zero())});
        PointCloud cloud;
        cloud.positions = std::move(positions);
        cloud.columns = table.finish();
        return cloud;
    }

    PointCloud gather_world(std::span<const u32> rows, unsigned threads) const override {
        FiniteBounds world;
        return gather_from(Vec3::Zero(), rows, threads, world);
    }
    PointCloud gather_near(std::span<const u32> rows, unsigned threads, FiniteBounds& world) const override {
        return gather_from(frame_.origin, rows, threads, world);
    }

    std::unique_ptr<MappedFile> file_;
    LasContent content_;
    const LasHeader& header_;
    std::string_view records_;
    std::vector<LasColumn> columns_;
};

}  // namespace

bool may_be_las_stream(std::string_view file, bool reads_compressed) {
    if (!file.starts_with(las_magic)) return false;
    LasParts parts{read_las_header(file), {}, file, {}};
    parts.records = read_las_records(parts.header, file, {});
    if (is_compressed(parts) != reads_compressed) return false;
    require_las_points(parts.header, file);
    return true;
}

std::unique_ptr<PointStream> open_las_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions,
                                             const LasDecompress& decompress) {
    // A file that is not streamed after all is read whole, which gives the same warnings.
    std::vector<std::string> warnings;
    ReadOptions kept = options;
    kept.on_warning = [&](std::string sentence) { warnings.push_back(std::move(sentence)); };
    LasContent content = read_las_content({{}, file->bytes()}, kept, bool(decompress));
    auto stream = std::make_unique<LasStream>(std::move(file), std::move(content));
    if (!stream->open(kept, threads, on_positions, decompress)) return nullptr;
    for (std::string& sentence : warnings) warn(options.on_warning, "{}", sentence);
    return stream;
}

}  // namespace scanmill
