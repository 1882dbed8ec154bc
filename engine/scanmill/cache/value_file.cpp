// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/value_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

using Bytes = std::span<const std::byte>;

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

std::string hash_of(std::string_view bytes) {
    XXH128_canonical_t hash;
    XXH128_canonicalFromHash(&hash, XXH3_128bits(bytes.data(), bytes.size()));
    return {reinterpret_cast<const char*>(hash.digest), sizeof hash.digest};
}

std::string hexadecimal(std::string_view bytes) {
    std::string digits;
    for (const char byte : bytes) digits += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    return digits;
}

std::string head_of(const std::filesystem::path& file, std::string_view kind, std::string_view content) {
    return fmt::format("scanmill {} {} {}\n", kind, file.filename().string(), hexadecimal(hash_of(content)));
}

}  // namespace

void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content) {
    AtomicFile target(file);
    target.write(head_of(file, kind, content));
    target.write(content);
    target.commit(AtomicFile::Sync::no);
}

std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0 && errno == ENOENT) return std::nullopt;
    std::string bytes;
    std::array<char, 4096> part;
    ssize_t length = descriptor < 0 ? -1 : 1;
    while (length > 0) {
        length = ::read(descriptor, part.data(), part.size());
        if (length > 0) bytes.append(part.data(), static_cast<std::size_t>(length));
    }
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    if (length < 0) throw Error("'{}' cannot be read: {}", file.string(), std::generic_category().message(reason));
    const std::size_t end = bytes.find('\n');
    const std::string content = end == std::string::npos ? std::string() : bytes.substr(end + 1);
    if (bytes.substr(0, end + 1) != head_of(file, kind, content))
        throw DamagedFile("'{}' is damaged: its bytes are not those that were written under this name", file.string());
    return content;
}

namespace {

constexpr std::size_t alignment = 64;
constexpr std::array<std::byte, alignment> zeros{};

constexpr std::size_t aligned(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }

Bytes padding(std::size_t bytes) { return std::span(zeros).first(aligned(bytes) - bytes); }

/// Adds every field to `header`. An array is added to `arrays`, which shares its memory; the header holds its index in
/// `arrays` and its element size.
class FieldWriter : public FieldVisitor {
public:
    void frame(const char* name, Frame& frame) override {
        header[name] = {
            {"unit", scanmill::json_of(frame.unit)}, {"origin", scanmill::json_of(frame.origin)}, {"name", frame.name}};
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
                            {"data", stored(column.bytes(), 1)},
                            {"offsets", stored(bytes_of(column.offsets()), sizeof(u64))}});
        header[name] = std::move(rows);
    }

    Json header = Json::object();
    std::vector<Buffer<std::byte>> arrays;

private:
    void bytes_of(const char* name, Buffer<std::byte>& bytes, std::size_t element) override {
        header[name] = stored(bytes, element);
    }
    static Buffer<std::byte> bytes_of(const Buffer<u64>& numbers) {
        const auto bytes = std::as_bytes(numbers.span());
        return {numbers.owner(), bytes.data(), bytes.size()};
    }
    bool json_of(const char* name, Json& json) override {
        header[name] = json;
        return false;
    }
    Json stored(const Buffer<std::byte>& bytes, std::size_t element) {
        arrays.push_back(bytes);
        return {arrays.size() - 1, element};
    }
};

/// Sets every field from the header and the arrays.
class FieldReader : public FieldVisitor {
public:
    FieldReader(const Json& header, const std::vector<Buffer<std::byte>>& arrays) : header_(header), arrays_(arrays) {}

    void frame(const char* name, Frame& frame) override {
        const Json& json = header_.at(name);
        JsonForm<LengthUnit>::read(json.at("unit"), frame.unit);
        JsonForm<Vec3>::read(json.at("origin"), frame.origin);
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
        const auto index = where.at(0).get<std::size_t>();
        if (index >= arrays_.size() || where.at(1) != element || arrays_[index].size() % element != 0)
            throw DamagedFile("an array of the value file is missing, or has another type");
        return arrays_[index];
    }

    const Json& header_;
    const std::vector<Buffer<std::byte>>& arrays_;
};

struct ValueFields {
    std::string header;
    std::vector<Buffer<std::byte>> arrays;
};

ValueFields fields_of(const Value& value) {
    FieldWriter writer;
    visited(value, writer);
    writer.header["kind"] = value.kind().name();
    for (const auto& array : writer.arrays) writer.header["arrays"].push_back(array.size());
    return {cbor_of(writer.header), std::move(writer.arrays)};
}

constexpr std::string_view magic = "SMVALUE4";

struct Preamble {
    char magic[8];
    u64 header_bytes;
    char header_hash[16], arrays_hash[16];
    u64 file_bytes;
    u64 reserved;

    /// `array_hashes` is the concatenation of one digest per array.
    static Preamble of(const ValueFields& fields, std::string_view array_hashes) {
        Preamble preamble{};
        std::memcpy(preamble.magic, scanmill::magic.data(), scanmill::magic.size());
        preamble.header_bytes = fields.header.size();
        hash_of(fields.header).copy(preamble.header_hash, sizeof preamble.header_hash);
        hash_of(array_hashes).copy(preamble.arrays_hash, sizeof preamble.arrays_hash);
        preamble.file_bytes = sizeof preamble + aligned(fields.header.size());
        for (const auto& array : fields.arrays) preamble.file_bytes += aligned(array.size());
        return preamble;
    }
    std::string_view bytes() const { return {reinterpret_cast<const char*>(this), sizeof *this}; }
    /// The preamble identifies every byte of the file through its two hashes.
    ValueName name() const { return {hexadecimal(hash_of(bytes())), file_bytes}; }
};
static_assert(sizeof(Preamble) == alignment);

}  // namespace

ArrayHash::ArrayHash() : state_(XXH3_createState()) { XXH3_128bits_reset(state_.get()); }

void ArrayHash::Free::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

void ArrayHash::add(Bytes part) {
    XXH3_128bits_update(state_.get(), part.data(), part.size());
    bytes_ += part.size();
}

std::string ArrayHash::digest() {
    add(padding(bytes_));
    XXH128_canonical_t hash;
    XXH128_canonicalFromHash(&hash, XXH3_128bits_digest(state_.get()));
    return {reinterpret_cast<const char*>(hash.digest), sizeof hash.digest};
}

EncodedValue::EncodedValue(Value value) : value_(std::move(value)) {
    ValueFields fields = fields_of(value_);
    std::string hashes;
    for (const auto& array : fields.arrays) {
        ArrayHash hash;
        hash.add(array.span());
        hashes += hash.digest();
    }
    const Preamble preamble = Preamble::of(fields, hashes);
    name_ = preamble.name();
    head_ = preamble.bytes();
    head_ += fields.header;
    head_ += text_of(padding(fields.header.size()));
    arrays_ = std::move(fields.arrays);
}

void EncodedValue::write(const std::filesystem::path& file) const {
    AtomicFile target(file);
    target.write(head_);
    for (const auto& array : arrays_) {
        target.write(text_of(array.span()));
        target.write(text_of(padding(array.size())));
    }
    target.commit(AtomicFile::Sync::no);
}

namespace {

/// The value in the mapped file. Throws Error as read_value() does.
Value value_in(const std::shared_ptr<const MappedFile>& map, const std::filesystem::path& file,
               std::string_view content) try {
    const std::string_view bytes = map->bytes();
    Preamble preamble;
    if (bytes.size() < sizeof preamble || !bytes.starts_with(magic))
        throw DamagedFile("'{}' is not a value file", file.string());
    std::memcpy(&preamble, bytes.data(), sizeof preamble);
    if (preamble.file_bytes != bytes.size() || preamble.header_bytes > bytes.size() - sizeof preamble)
        throw DamagedFile("'{}' has {} bytes; expected {}", file.string(), bytes.size(), preamble.file_bytes);
    const DamagedFile damaged("'{}' is damaged: its bytes are not those that were written", file.string());
    const auto require = [&](const char(&expected)[16], std::string_view hashed) {
        if (hash_of(hashed) != std::string_view(expected, sizeof expected)) throw damaged;
    };
    const std::string_view header = bytes.substr(sizeof preamble, preamble.header_bytes);
    require(preamble.header_hash, header);
    const Json json = json_from_cbor(header, file.string());
    std::size_t begin = std::min(bytes.size(), sizeof preamble + aligned(header.size()));
    std::string hashes;
    std::vector<Buffer<std::byte>> arrays;
    for (const Json& size : json.value("arrays", Json::array())) {
        const auto length = size.get<std::size_t>();
        if (length > bytes.size() - begin || aligned(length) > bytes.size() - begin) throw damaged;
        hashes += hash_of(bytes.substr(begin, aligned(length)));
        arrays.push_back(
            length == 0 ? Buffer<std::byte>()
                        : Buffer<std::byte>(map, reinterpret_cast<const std::byte*>(bytes.data() + begin), length));
        begin += aligned(length);
    }
    require(preamble.arrays_hash, hashes);
    if (const std::string found = preamble.name().content; !content.empty() && found != content)
        throw DamagedFile("'{}' is damaged: it holds the value {}", file.string(), found);
    const auto name = json.at("kind").get<std::string>();
    const std::optional<Kind> kind = kind_named(name);
    if (!kind) throw DamagedFile("'{}' contains a value of the unknown kind {}", file.string(), name);
    const std::shared_ptr<void> object = kind->info().make();
    FieldReader reader(json, arrays);
    kind->info().visit(reader, object.get());
    return Value(*kind, object);
} catch (const JsonMismatch&) {
    throw DamagedFile("the header of '{}' is not one that Scanmill writes", file.string());
} catch (const Json::exception&) {
    throw DamagedFile("the header of '{}' is not one that Scanmill writes", file.string());
}

}  // namespace

Value read_value(const std::filesystem::path& file, std::string_view content) {
    std::error_code unknown;
    if (std::filesystem::file_size(file, unknown) == 0) throw DamagedFile("'{}' is empty", file.string());
    std::shared_ptr<const MappedFile> map;
    try {
        map = std::make_shared<const MappedFile>(file);
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}' {}", file.string(), error.sentence()));
    }
    try {
        return value_in(map, file, content);
    } catch (const DamagedFile&) {
        throw;
    } catch (const Error& error) {
        throw DamagedFile(error);
    }
}

namespace {

/// The stream's cloud without data: its arrays have the right sizes but null pointers.
PointCloud cloud_without_data(const PointStream& stream) {
    PointCloud cloud;
    cloud.frame = stream.frame();
    cloud.positions = Buffer<Vec3>(nullptr, nullptr, stream.size());
    const PointCloud without_rows = stream.gather({}, 1);
    for (const Column& column : without_rows.columns) {
        const std::size_t bytes = stream.size() * column.components() * size_of(column.type());
        cloud.columns.add(Column(column.name(), column.type(), column.components(),
                                 Buffer<std::byte>(nullptr, nullptr, bytes), {}, column.length_exponent()));
    }
    return cloud;
}

}  // namespace

ValueName StreamedContent::of(const PointStream& stream, unsigned threads, const std::function<void()>& on_piece) {
    struct Piece {
        Array<Vec3> positions;
        ColumnTable columns;
    };
    const PointCloud cloud = cloud_without_data(stream);
    const bool is_moved = stream.frame().origin != Vec3::Zero();
    if (is_moved) positions_ = {};
    std::vector<ArrayHash> columns(cloud.columns.size());
    if (is_moved || !columns.empty())
        for_each_in_order<Piece>(
            threads, stream.pieces().size() - 1,
            [&](std::size_t index, Piece& piece) {
                if (is_moved) stream.read(index, piece.positions);
                piece.columns = stream.read_columns(index);
            },
            [&](std::size_t, const Piece& piece) {
                if (on_piece) on_piece();
                if (is_moved) positions_.add(std::as_bytes(std::span(piece.positions)));
                auto hash = columns.begin();
                for (const Column& column : piece.columns) (hash++)->add(column.bytes().span());
            });
    std::string hashes = positions_.digest();
    for (ArrayHash& column : columns)
        hashes += column.digest() + ArrayHash().digest();  // the array of offsets is empty
    return Preamble::of(fields_of(std::make_shared<const PointCloud>(cloud)), hashes).name();
}

}  // namespace scanmill
