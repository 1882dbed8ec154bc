// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The ten lines before the cells of one scan in a PTX file.

#include <Eigen/Dense>

#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill {

struct PtxHeader {
    u64 columns = 0, rows = 0;
    std::size_t line = 0;  ///< of `columns`
    /// World = local * linear + shift, as row vectors.
    Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
    Eigen::RowVector3d shift = Eigen::RowVector3d::Zero();

    u64 cells() const { return columns * rows; }
    bool moves() const { return linear != Eigen::Matrix3d::Identity() || shift != Eigen::RowVector3d::Zero(); }
    Vec3 placed(const Vec3& local) const { return (local.transpose() * linear + shift).transpose(); }
};

/// Reads the header that begins in the cursor's row and leaves the cursor in its last row. `scan` counts from 0, for
/// messages; `text_size` bounds the cells. What is odd about the matrix is told. Throws Error with the line.
PtxHeader read_ptx_header(TextCursor& text, std::size_t scan, std::size_t text_size, const ReadOptions& options);

}  // namespace scanmill
