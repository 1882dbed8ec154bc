// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/common/text_columns.hpp"

namespace scanmill {

namespace {

class PtxReader {
public:
    PtxReader(std::string_view text, const ReadOptions& options) : text_(text), size_(text.size()), options_(options) {}

    LoadedFile read() {
        for (; text_.next_row(); ++scans_) {
            if (options_.view == 0 || options_.view == scans_ + 1)
                read_scan();
            else
                skip_scan();
        }
        if (scans_ == 0) throw Error("holds no points: only blanks");
        if (options_.view > scans_)
            throw Error("has no scan {}; it has {}", options_.view, count_text(scans_, "scan", "scans"))
                .hint(fmt::format("name a scan from #1 to #{}, or the file without a number for all", scans_));
        if (positions_.empty())
            throw Error("holds no points: {} without a return", count_text(empty_, "cell", "cells"));
        require_countable(positions_.size(), "points");
        if (empty_ > 0)
            warn(options_.on_warning, "{} of {} cells without a return (0 0 0) left out", empty_,
                 empty_ + positions_.size());
        if (has_several())
            warn(options_.on_warning, "{} scans were read as one cloud; the column 'scan' has their numbers", scans_);
        warn(options_.on_warning,
             "the order of the cells in columns and rows was left out; the column 'approach' has the directions to the "
             "scanner");
        TriangleMesh vertices;
        vertices.vertex_columns = columns();
        LoadedFile loaded = loaded_file("PTX", "ascii", {}, std::move(positions_), std::move(vertices), options_);
        loaded.nan_is_no_return = true;
        return loaded;
    }

    /// The number of scans. Reads the numbers of columns and rows, and counts lines.
    u32 count() {
        for (; text_.next_row(); ++scans_) skip_scan();
        return static_cast<u32>(scans_);
    }

private:
    bool has_several() const { return scans_ > 1 && options_.view == 0; }

    /// Reads a row of `size` numbers. `what` names the row in messages. Pre: the cursor is in the row.
    template <int size>
    Eigen::RowVector<double, size> read_numbers(std::string_view what) {
        if (const std::size_t found = text_.count_tokens(); found != size)
            throw Error("line {}: the {} of scan {} has {} in a row; {} are needed", text_.line(), what, scans_,
                        count_text(found, "number", "numbers"), size);
        Eigen::RowVector<double, size> numbers;
        for (double& number : numbers) number = next_number(text_, "the {} of scan {}", what, scans_);
        return numbers;
    }

    u64 read_count(std::string_view what) {
        u64 count = 0;
        if (!text_.number(count) || text_.more())
            throw Error("line {}: expected the number of {} of scan {}", text_.line(), what, scans_)
                .hint("after the ten lines of its header, a scan has one line for each cell of its grid");
        return count;
    }

    /// The numbers of columns and rows of a scan. Pre: the cursor is in its first row.
    std::pair<u64, u64> read_size() {
        const std::size_t first_line = text_.line();
        const u64 columns = read_count("columns");
        require_row(text_, 1, header_lines, fmt::format("lines of the header of scan {}", scans_));
        const u64 rows = read_count("rows");
        constexpr u64 least_cell = 8;  // "0 0 0 0" and a line end
        if (rows > 0 && columns > (size_ / least_cell + 1) / rows)
            throw Error("line {}: scan {} promises {} x {} cells; the file has only {}", first_line, scans_, columns,
                        rows, count_text(size_, "byte", "bytes"))
                .hint(truncated_hint);
        return {columns, rows};
    }

    void skip_scan() {
        const auto [columns, rows] = read_size();
        const u64 left = header_lines - 2 + columns * rows;
        const std::string lines = fmt::format("lines of scan {}", scans_);
        for (u64 line = 0; line < left; ++line) require_row(text_, line, left, lines);
    }

    void read_scan() {
        const auto [columns, rows] = read_size();
        u64 lines = 2;
        const std::string header = fmt::format("lines of the header of scan {}", scans_);
        const auto next_header_line = [&] { require_row(text_, lines++, header_lines, header); };
        for (const std::string_view what : {"position", "x axis", "y axis", "z axis"}) {
            next_header_line();
            read_numbers<3>(what);
        }
        Eigen::Matrix4d matrix;
        for (int row = 0; row < 4; ++row) {
            next_header_line();
            matrix.row(row) = read_numbers<4>("matrix");
        }
        require_placement(matrix);

        has_colours_.reset();
        const std::string cells = fmt::format("cells of scan {}", scans_);
        for (u64 cell = 0; cell < columns * rows; ++cell) {
            require_row(text_, cell, columns * rows, cells);
            read_cell(matrix);
        }
    }

    void require_placement(const Eigen::Matrix4d& matrix) const {
        constexpr double singular = 1e-9, rigid = 1e-3;
        if (!matrix.allFinite())
            throw Error("line {}: the matrix of scan {} has a NaN or an infinity", text_.line(), scans_);
        if (matrix.col(3) != Eigen::Vector4d(0, 0, 0, 1))
            throw Error(
                "line {}: the last numbers in the matrix rows of scan {} are {}, {}, {}, {}; 0, 0, 0, 1 are needed",
                text_.line(), scans_, matrix(0, 3), matrix(1, 3), matrix(2, 3), matrix(3, 3))
                .hint("PTX has the translation in the last row; a program that wrote it in the last column is wrong");
        const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
        const Eigen::Vector3d lengths = linear.rowwise().norm();
        const double volume = linear.determinant();
        if (!(std::abs(volume) > singular * lengths.prod()))
            throw Error("line {}: the matrix of scan {} is singular (determinant {})", text_.line(), scans_, volume)
                .hint("it would flatten the scan: export the file again");
        if (!(linear * linear.transpose()).isIdentity(rigid))
            warn(options_.on_warning,
                 "the matrix of scan {} is not a rigid motion, its axes are {:.4g}, {:.4g} and {:.4g} long; it was "
                 "applied as it is",
                 scans_, lengths[0], lengths[1], lengths[2]);
        if (volume < 0) warn(options_.on_warning, "the matrix of scan {} mirrors; it was applied as it is", scans_);
    }

    double number() {
        if (!text_.more()) throw_width();
        return next_number(text_, "a cell of scan {}", scans_);
    }

    void read_cell(const Eigen::Matrix4d& matrix) {
        Vec3 local;
        for (double& coordinate : local) coordinate = number();
        const double intensity = number();
        const bool is_coloured = text_.more();
        if (local == Vec3::Zero()) {
            ++empty_;
            return;
        }
        if (is_coloured)
            for (std::size_t channel = 1; channel < 4; ++channel) values_[channel].push_back(number());
        if (text_.more()) throw_width();
        if (has_colours_.value_or(is_coloured) != is_coloured)
            throw Error("line {}: a cell {} red, green and blue; the cells before it in scan {} {}", text_.line(),
                        is_coloured ? "has" : "lacks", scans_, is_coloured ? "have none" : "have them");
        has_colours_ = is_coloured;
        values_[0].push_back(intensity);
        scan_of_.push_back(static_cast<u32>(scans_));
        // Points are row vectors. The identity must not change the bits of a zero or an infinite coordinate.
        const bool moves = matrix != Eigen::Matrix4d::Identity();
        const auto placed = [&]() -> Vec3 {
            return (local.transpose() * matrix.topLeftCorner<3, 3>() + matrix.bottomLeftCorner<1, 3>()).transpose();
        };
        positions_.push_back(moves ? placed() : local);
        // The direction of a point with a huge or infinite coordinate is not finite; it becomes 0.
        const Vec3 direction =
            (moves ? Vec3(matrix.topLeftCorner<3, 3>().transpose() * -local) : Vec3(-local)).stableNormalized();
        for (const double number : direction)
            approaches_.push_back(direction.allFinite() ? static_cast<float>(number) : 0.0f);
    }

    [[noreturn]] void throw_width() const {
        throw Error("line {}: a cell of scan {} has neither 4 numbers (x y z intensity) nor 7 (also red green blue)",
                    text_.line(), scans_);
    }

    ColumnTable columns() {
        const std::size_t coloured = values_[1].size();
        if (coloured > 0 && coloured < positions_.size())
            warn(options_.on_warning, "the colours of {} of {} points were left out: not every scan has them", coloured,
                 positions_.size());
        std::vector<std::string> names{"intensity", "red", "green", "blue"};
        const std::size_t kept = coloured == positions_.size() ? 4 : 1;
        names.resize(kept);
        values_.resize(kept);
        ColumnTable table = text_columns(std::move(names), std::move(values_), false, options_.on_warning);
        table.add(Column("approach", 3, Buffer<float>(std::move(approaches_))));
        if (has_several()) table.add(Column("scan", 1, Buffer(std::move(scan_of_))));
        return table;
    }

    static constexpr u64 header_lines = 10;
    TextCursor text_;
    std::size_t size_;
    const ReadOptions options_;
    std::size_t scans_ = 0;
    u64 empty_ = 0;
    std::optional<bool> has_colours_;  // of this scan; empty before its first point
    Array<Vec3> positions_;
    std::vector<Array<double>> values_{4};  // intensity, red, green, blue
    Array<float> approaches_;  // unit vectors to the scanner
    Array<u32> scan_of_;
};

Recognition recognise(std::string_view head, u64) {
    TextCursor text(without_byte_order_mark(head));
    for (const std::size_t width : {1, 1, 3, 3, 3, 3, 4, 4, 4, 4})
        if (!text.next_row() || text.count_tokens() != width || !is_row_of_numbers(text)) return Recognition::no;
    return Recognition::certain;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) {
    return PtxReader(without_byte_order_mark(file.bytes), options).read();
}

}  // namespace

Format ptx_format() {
    Format format{"PTX", {"ptx"}, recognise, read, {}};
    format.count_views = [](std::string_view text) { return PtxReader(without_byte_order_mark(text), {}).count(); };
    return format;
}

}  // namespace scanmill
