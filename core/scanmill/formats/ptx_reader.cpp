// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/error.hpp"
#include "scanmill/formats/ptx.hpp"
#include "scanmill/formats/ptx_header.hpp"
#include "scanmill/formats/reading.hpp"
#include "scanmill/formats/text_columns.hpp"
#include "scanmill/formats/text_layout.hpp"

namespace scanmill {

namespace {

class PtxReader {
public:
    PtxReader(std::string_view text, const ReadOptions& options) : text_(text), size_(text.size()), options_(options) {}

    LoadedFile read() {
        for (; text_.next_row(); ++scans_) read_scan();
        if (scans_ == 0) throw Error("holds no points: nothing but blanks");
        if (positions_.empty()) throw Error("holds no points: {} without a return", counted(empty_, "cell", "cells"));
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
                            counted(header.cells(), "cell", "cells"), scans_)
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
