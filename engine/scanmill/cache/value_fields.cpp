// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/value_fields.hpp"

#include <nlohmann/json.hpp>

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/kind_traits.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::json;

/// Takes a value apart: every field adds to the header; arrays add themselves, and where they are, to the header.
class FieldWriter : public FieldVisitor {
public:
    void frame(const char* name, Frame& frame) override {
        header[name] = {{"unit", static_cast<int>(frame.unit)}, {"origin", frame.origin}, {"name", frame.name}};
    }
    void positions(const char* name, Buffer<Vec3>& positions) override { plain(name, positions); }
    void directions(const char* name, Buffer<Vec3>& directions) override { plain(name, directions); }
    void lengths(const char* name, Buffer<double>& lengths, int) override { plain(name, lengths); }
    void columns(const char* name, ColumnTable& table) override {
        Json rows = Json::array();
        for (const Column& column : table)
            rows.push_back({{"name", column.name()},
                            {"type", static_cast<int>(column.type())},
                            {"components", column.components()},
                            {"length-exponent", column.length_exponent()},
                            {"data", stored(std::as_bytes(column.bytes().span()), 1)},
                            {"offsets", stored(std::as_bytes(column.offsets().span()), sizeof(u64))}});
        header[name] = std::move(rows);
    }

    Json header = Json::object();
    std::vector<std::span<const std::byte>> arrays;

private:
    void bytes_of(const char* name, Buffer<std::byte>& bytes, std::size_t element) override {
        header[name] = stored(bytes.span(), element);
    }
    bool json_of(const char* name, Json& json) override {
        header[name] = json;
        return false;
    }
    Json stored(std::span<const std::byte> bytes, std::size_t element) {
        const Json where{{"begin", end_}, {"bytes", bytes.size()}, {"element", element}};
        arrays.push_back(bytes);
        end_ += aligned(bytes.size());
        return where;
    }
    std::size_t end_ = 0;
};

/// Puts a value together again, field by field.
class FieldReader : public FieldVisitor {
public:
    FieldReader(const Json& header, std::string_view arrays, const std::shared_ptr<const void>& owner)
        : header_(header),
          arrays_(arrays),
          owner_(owner) {}

    void frame(const char* name, Frame& frame) override {
        const Json& json = header_.at(name);
        frame.unit = static_cast<LengthUnit>(json.at("unit").get<int>());
        frame.origin = json.at("origin").get<Vec3>();
        frame.name = json.at("name").get<std::string>();
    }
    void positions(const char* name, Buffer<Vec3>& positions) override { plain(name, positions); }
    void directions(const char* name, Buffer<Vec3>& directions) override { plain(name, directions); }
    void lengths(const char* name, Buffer<double>& lengths, int) override { plain(name, lengths); }
    void columns(const char* name, ColumnTable& table) override {
        for (const Json& row : header_.at(name)) {
            const Buffer<std::byte> offsets = stored(row.at("offsets"), sizeof(u64));
            table.add(Column(row.at("name").get<std::string>(), static_cast<ScalarType>(row.at("type").get<int>()),
                             row.at("components").get<u32>(), stored(row.at("data"), 1),
                             Buffer<u64>(offsets.owner(), reinterpret_cast<const u64*>(offsets.data()),
                                         offsets.size() / sizeof(u64)),
                             row.at("length-exponent").get<int>()));
        }
    }

private:
    void bytes_of(const char* name, Buffer<std::byte>& bytes, std::size_t element) override {
        bytes = stored(header_.at(name), element);
    }
    bool json_of(const char* name, Json& json) override {
        json = header_.at(name);
        return true;
    }
    Buffer<std::byte> stored(const Json& where, std::size_t element) const {
        const auto begin = where.at("begin").get<std::size_t>(), bytes = where.at("bytes").get<std::size_t>();
        if (begin % value_alignment != 0 || begin > arrays_.size() || bytes > arrays_.size() - begin ||
            where.at("element").get<std::size_t>() != element || bytes % element != 0)
            throw Error("an array of the value file is outside the file, or of another type");
        if (bytes == 0) return {};
        return {owner_, reinterpret_cast<const std::byte*>(arrays_.data() + begin), bytes};
    }

    const Json& header_;
    std::string_view arrays_;
    const std::shared_ptr<const void>& owner_;
};

}  // namespace

ValueFields fields_of(const Value& value) {
    FieldWriter writer;
    visited(value, writer);
    writer.header["kind"] = value.kind().name();
    ValueFields fields;
    Json::to_cbor(writer.header, fields.header);
    fields.arrays = std::move(writer.arrays);
    return fields;
}

Value value_of(std::string_view header, std::string_view arrays, const std::shared_ptr<const void>& owner) try {
    const Json json = Json::from_cbor(header);
    const auto name = json.at("kind").get<std::string>();
    const std::optional<Kind> kind = kind_named(name);
    if (!kind) throw Error("the value file contains a value of the unknown kind {}", name);
    const std::shared_ptr<void> object = kind->info().make();
    FieldReader reader(json, arrays, owner);
    kind->info().visit(reader, object.get());
    return Value(*kind, object);
} catch (const Json::exception&) {
    throw Error("the header of the value file is not one that Scanmill writes");
}

}  // namespace scanmill
