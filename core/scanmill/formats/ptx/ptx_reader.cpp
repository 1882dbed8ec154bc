// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_columns.hpp"
#include "scanmill/formats/common/text_layout.hpp"
#include "scanmill/formats/ptx/detail/ptx_header.hpp"
#include "scanmill/formats/ptx/ptx.hpp"

namespace scanmill {

namespace {

class HeaderReader {
public:
    HeaderReader(TextCursor& text, std::size_t scan, const ReadOptions& options)
        : text_(text),
          scan_(scan),
          options_(options) {}

    PtxHeader read(std::size_t text_size) {
        header_.line = text_.line();
        read_count("columns", header_.columns);
        next_row("rows");
        read_count("rows", header_.rows);
        require_room(text_size);
        for (const std::string_view what : {"position", "x axis", "y axis", "z axis"}) read_numbers<3>(what);
        Eigen::Matrix4d matrix;
        for (int row = 0; row < 4; ++row) matrix.row(row) = read_numbers<4>("matrix");
        header_.linear = matrix.topLeftCorner<3, 3>();
        header_.shift = matrix.bottomLeftCorner<1, 3>();
        require_placement(matrix);
        return header_;
    }

private:
    void next_row(std::string_view what) {
        if (!text_.next_row())
            throw Error("line {}: the text ends before the {} of scan {}", text_.line(), what, scan_)
                .hint("the file is truncated: fetch or export it again");
    }

    void read_count(std::string_view what, u64& count) {
        if (!text_.number(count) || text_.more())
            throw Error("line {}: expected the number of {} of scan {}", text_.line(), what, scan_)
                .hint("behind its ten lines of header a scan has one line for each cell of its grid");
    }

    template <int size>
    Eigen::RowVector<double, size> read_numbers(std::string_view what) {
        next_row(what);
        Eigen::RowVector<double, size> numbers;
        for (int i = 0; i < size; ++i) {
            if (!text_.more())
                throw Error("line {}: the {} of scan {} has {} in a row; {} are needed", text_.line(), what, scan_,
                            count_text(static_cast<u64>(i), "number", "numbers"), size);
            if (!text_.number(numbers[i]))
                throw Error("line {}: {} is no number for the {} of scan {}", text_.line(), quote(text_.last_token()),
                            what, scan_);
        }
        if (text_.more())
            throw Error("line {}: the {} of scan {} has {} numbers in a row; {} are needed", text_.line(), what, scan_,
                        static_cast<std::size_t>(size) + text_.count_tokens(), size);
        return numbers;
    }

    void require_room(std::size_t text_size) const {
        constexpr u64 least_cell = 8;  // "0 0 0 0" and a line end
        const u64 most = text_size / least_cell + 1;
        if (header_.rows > 0 && header_.columns > most / header_.rows)
            throw Error("line {}: scan {} promises {} x {} cells; the file has only {}", header_.line, scan_,
                        header_.columns, header_.rows, count_text(text_size, "byte", "bytes"))
                .hint("the file is truncated or its header is wrong: fetch or export it again");
    }

    void require_placement(const Eigen::Matrix4d& matrix) const {
        constexpr double singular = 1e-9, rigid = 1e-3;
        if (!matrix.allFinite())
            throw Error("line {}: the matrix of scan {} has a NaN or an infinity", text_.line(), scan_);
        if (matrix.col(3) != Eigen::Vector4d(0, 0, 0, 1))
            throw Error(
                "line {}: the last numbers in the matrix rows of scan {} are {}, {}, {}, {}; 0, 0, 0, 1 are "
                "needed",
                text_.line(), scan_, matrix(0, 3), matrix(1, 3), matrix(2, 3), matrix(3, 3))
                .hint("PTX has the translation in the last row; a program that wrote it in the last column is wrong");
        const Eigen::Vector3d lengths = header_.linear.rowwise().norm();
        const double volume = header_.linear.determinant();
        if (!(std::abs(volume) > singular * lengths.prod()))
            throw Error("line {}: the matrix of scan {} is singular (determinant {})", text_.line(), scan_, volume)
                .hint("it would flatten the scan: export the file again");
        const Eigen::Matrix3d product = header_.linear * header_.linear.transpose();
        if (!product.isIdentity(rigid))
            warn(
                options_.on_warning,
                "the matrix of scan {} is no rigid motion, its axes are {:.4g}, {:.4g} and {:.4g} long; it was applied "
                "as it is",
                scan_, lengths[0], lengths[1], lengths[2]);
        if (volume < 0) warn(options_.on_warning, "the matrix of scan {} mirrors; it was applied as it is", scan_);
    }

    TextCursor& text_;
    std::size_t scan_;
    const ReadOptions& options_;
    PtxHeader header_;
};

}  // namespace

PtxHeader read_ptx_header(TextCursor& text, std::size_t scan, std::size_t text_size, const ReadOptions& options) {
    return HeaderReader(text, scan, options).read(text_size);
}

namespace {

class PtxReader {
public:
    PtxReader(std::string_view text, const ReadOptions& options) : text_(text), size_(text.size()), options_(options) {}

    LoadedFile read() {
        for (; text_.next_row(); ++scans_) read_scan();
        if (scans_ == 0) throw Error("holds no points: nothing but blanks");
        if (positions_.empty())
            throw Error("holds no points: {} without a return", count_text(empty_, "cell", "cells"));
        require_countable(positions_.size(), "points");
        tell();

        LoadedFile loaded;
        loaded.format = "PTX";
        loaded.encoding = "ascii";
        PointCloud cloud;
        cloud.frame.unit = options_.unit;
        move_near_origin(positions_, bounding_box(positions_), cloud.frame);
        cloud.columns = columns();
        cloud.positions = std::move(positions_);
        loaded.value = std::make_shared<const PointCloud>(std::move(cloud));
        return loaded;
    }

private:
    void read_scan() {
        const PtxHeader header = read_ptx_header(text_, scans_, size_, options_);
        has_colours_.reset();
        for (u64 cell = 0; cell < header.cells(); ++cell) {
            if (!text_.next_row())
                throw Error("line {}: the text ends after {} of the {} of scan {}", text_.line(), cell,
                            count_text(header.cells(), "cell", "cells"), scans_)
                    .hint("the file is truncated: fetch or export it again");
            read_cell(header);
        }
    }

    void read_cell(const PtxHeader& header) {
        Vec3 local;
        double intensity = 0;
        for (int axis = 0; axis < 3; ++axis) local[axis] = number();
        intensity = number();
        const bool is_coloured = text_.more();
        if (local == Vec3::Zero()) {
            ++empty_;
            return;  // whatever the rest says
        }
        if (is_coloured)
            for (Array<double>& channel : colours_) channel.push_back(number());
        if (text_.more()) throw_width();
        if (has_colours_.value_or(is_coloured) != is_coloured)
            throw Error("line {}: a cell {} red, green and blue; those before in scan {} {}", text_.line(),
                        is_coloured ? "has" : "lacks", scans_, is_coloured ? "have none" : "have them");
        has_colours_ = is_coloured;
        positions_.push_back(header.moves() ? header.placed(local) : local);
        intensities_.push_back(intensity);
        scan_of_.push_back(static_cast<u32>(scans_));
    }

    double number() {
        double value = 0;
        if (!text_.more()) throw_width();
        if (!text_.number(value))
            throw Error("line {}: {} is no number for a cell of scan {}", text_.line(), quote(text_.last_token()),
                        scans_);
        return value;
    }

    [[noreturn]] void throw_width() const {
        throw Error("line {}: a cell of scan {} has neither 4 numbers (x y z intensity) nor 7 (red green blue, too)",
                    text_.line(), scans_);
    }

    void tell() const {
        if (empty_ > 0)
            warn(options_.on_warning, "{} of {} cells without a return (0 0 0) left out", empty_,
                 empty_ + positions_.size());
        if (scans_ > 1)
            warn(options_.on_warning, "{} scans were read as one cloud; the column 'scan' tells them apart", scans_);
        warn(options_.on_warning,
             "the order of the cells in columns and rows and the scanner's position were left out");
    }

    ColumnTable columns() {
        ColumnTable table;
        table.add(Column("intensity", 1, Buffer(std::move(intensities_))));
        add_colours(table);
        if (scans_ > 1) table.add(Column("scan", 1, Buffer(std::move(scan_of_))));
        return table;
    }

    void add_colours(ColumnTable& table) {
        const std::size_t coloured = colours_[0].size();
        if (coloured == 0) return;
        if (coloured < positions_.size()) {
            warn(options_.on_warning, "the colours of {} of {} points were left out: not every scan has them", coloured,
                 positions_.size());
            return;
        }
        const std::array<const Array<double>*, 3> components{&colours_[0], &colours_[1], &colours_[2]};
        if (const auto colour = as_colour(components)) {
            table.add(*colour);
            return;
        }
        warn(options_.on_warning,
             "the colours are no whole numbers from 0 to 255; they are kept as red, green and blue");
        constexpr std::array<const char*, 3> names{"red", "green", "blue"};
        for (std::size_t i = 0; i < 3; ++i) table.add(Column(names[i], 1, Buffer(std::move(colours_[i]))));
    }

    TextCursor text_;
    std::size_t size_;
    const ReadOptions& options_;
    std::size_t scans_ = 0;
    u64 empty_ = 0;
    std::optional<bool> has_colours_;  // of this scan
    Array<Vec3> positions_;
    Array<double> intensities_;
    Array<u32> scan_of_;
    std::array<Array<double>, 3> colours_;
};

}  // namespace

Recognition recognise_ptx(std::string_view head, u64) {
    TextCursor text(without_byte_order_mark(head));
    for (const std::size_t width : {1, 1, 3, 3, 3, 3, 4, 4, 4, 4})
        if (!text.next_row() || text.count_tokens() != width || !is_row_of_numbers(text)) return Recognition::no;
    return Recognition::certain;
}

LoadedFile read_ptx(const FileBytes& file, const ReadOptions& options) {
    return PtxReader(without_byte_order_mark(file.bytes), options).read();
}

}  // namespace scanmill
