// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Visits every part of an object of any kind, for reading as well as for changing it.
///
/// KindTraits<T>::visit() calls one function per part and says what the part means: a visitor that moves an object
/// changes positions and directions, one that converts units changes lengths, one that stores it takes everything.

#include <nlohmann/json.hpp>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

class FieldVisitor {
public:
    virtual ~FieldVisitor() = default;

    virtual void frame(const char* name, Frame& frame) = 0;
    /// Relative to the frame's origin.
    virtual void positions(const char* name, Buffer<Vec3>& positions) = 0;
    /// Unit vectors, or zero.
    virtual void directions(const char* name, Buffer<Vec3>& directions) = 0;
    /// Lengths raised to `exponent`.
    virtual void lengths(const char* name, Buffer<double>& lengths, int exponent) = 0;
    virtual void columns(const char* name, ColumnTable& columns) = 0;
    /// Numbers that neither a motion nor a unit changes: indices, labels.
    template <class T>
    void plain(const char* name, Buffer<T>& elements) {
        Buffer<std::byte> bytes(elements.owner(), reinterpret_cast<const std::byte*>(elements.data()),
                                elements.size() * sizeof(T));
        bytes_of(name, bytes, sizeof(T));
        elements = Buffer<T>(bytes.owner(), reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T));
    }
    /// A small part with a JSON form, which neither a motion nor a unit changes.
    template <class T>
    void small(const char* name, T& part) {
        nlohmann::json json = part;
        if (json_of(name, json)) part = json.get<T>();
    }

private:
    virtual void bytes_of(const char* name, Buffer<std::byte>& bytes, std::size_t element) = 0;
    /// True when it replaced the JSON.
    virtual bool json_of(const char* name, nlohmann::json& json) = 0;
};

/// A visitor that changes nothing; overrides say what changes.
class FieldChange : public FieldVisitor {
public:
    void frame(const char*, Frame&) override {}
    void positions(const char*, Buffer<Vec3>&) override {}
    void directions(const char*, Buffer<Vec3>&) override {}
    void lengths(const char*, Buffer<double>&, int) override {}
    void columns(const char*, ColumnTable&) override {}

private:
    void bytes_of(const char*, Buffer<std::byte>&, std::size_t) override {}
    bool json_of(const char*, nlohmann::json&) override { return false; }
};

}  // namespace scanmill

namespace nlohmann {

/// Vectors and matrices as lists of numbers; a matrix as a list of rows.
template <int rows, int columns>
struct adl_serializer<Eigen::Matrix<double, rows, columns>> {
    static void to_json(json& value, const Eigen::Matrix<double, rows, columns>& matrix) {
        value = json::array();
        for (int row = 0; row < rows; ++row) {
            if constexpr (columns == 1)
                value.push_back(matrix[row]);
            else
                value.push_back(json(Eigen::Vector<double, columns>(matrix.row(row).transpose())));
        }
    }
    static void from_json(const json& value, Eigen::Matrix<double, rows, columns>& matrix) {
        for (int row = 0; row < rows; ++row) {
            const json& item = value.at(static_cast<std::size_t>(row));
            if constexpr (columns == 1)
                matrix[row] = item.get<double>();
            else
                matrix.row(row) = item.get<Eigen::Vector<double, columns>>().transpose();
        }
    }
};

}  // namespace nlohmann
