// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/ptx_header.hpp"

#include "scanmill/filter/error.hpp"

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
                            counted(static_cast<u64>(i), "number", "numbers"), size);
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
                        header_.columns, header_.rows, counted(text_size, "byte", "bytes"))
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

}  // namespace scanmill
