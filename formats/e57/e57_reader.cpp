// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <xercesc/sax/SAXException.hpp>
#include <xercesc/util/OutOfMemoryException.hpp>
#include <xercesc/util/XMLException.hpp>

#include "e57/columns.hpp"
#include "e57/container.hpp"
#include "e57/e57.hpp"
#include "e57/scan.hpp"
#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/io/memory.hpp"
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace scanmill::e57_format {

namespace {

constexpr std::size_t block_size = 65'536;
constexpr const char* damaged_hint = "the file is damaged: fetch or export it again";

/// libE57Format does not free everything when it refuses a file. While an object of this class exists, the leak checker
/// of a test build does not record blocks.
class LeaksAllowed {
#if defined(__SANITIZE_ADDRESS__)
    __lsan::ScopedDisabler disabler_;
#else
public:
    LeaksAllowed() {}  // NOLINT: not defaulted, or the objects would count as unused
#endif
};

/// The sentence for an exception of libE57Format, which describes its own internals.
Error error_of(const ::e57::E57Exception& exception) {
    constexpr std::size_t longest = 160;
    if (exception.errorCode() == ::e57::ErrorBadChecksum) {
        const std::string context = exception.context(), key = "page=";
        const std::size_t page = context.find(key);
        return Error("a checksum is wrong{}",
                     page == std::string::npos
                         ? ""
                         : " in page " + context.substr(page + key.size(),
                                                        context.find_first_not_of("0123456789", page + key.size()) -
                                                            page - key.size()))
            .hint(damaged_hint);
    }
    std::string what = exception.errorStr(), context = exception.context();
    if (const std::size_t message = context.find("parserMessage="); message != std::string::npos)
        what += ": " + context.substr(message + std::string_view("parserMessage=").size(), longest);
    for (char& c : what)
        if (static_cast<unsigned char>(c) < ' ') c = '?';
    return Error("libE57Format refuses it: {}", what).hint(damaged_hint);
}

/// The result of `action`. Turns exceptions of libE57Format and xerces-c into an Error.
template <class Action>
auto translated(Action&& action) {
    try {
        return action();
    } catch (const ::e57::E57Exception& exception) {
        throw error_of(exception);
    } catch (const xercesc::OutOfMemoryException&) {
        throw std::bad_alloc();
    } catch (const xercesc::XMLException&) {
        throw Error("its XML section cannot be parsed").hint(damaged_hint);
    } catch (const xercesc::SAXException&) {
        throw Error("its XML section cannot be parsed").hint(damaged_hint);
    } catch (const std::logic_error& error) {  // a checked index of libE57Format
        throw Error("libE57Format refuses it: {}", error.what()).hint(damaged_hint);
    }
}

/// translated(), with the scan's number before the sentence of an Error.
template <class Action>
auto of_scan(u32 number, Action&& action) {
    try {
        return translated(std::forward<Action>(action));
    } catch (const Error& error) {
        throw error.reworded(fmt::format("scan {}: {}", number, error.sentence()));
    }
}

::e57::ImageFile opened(std::string_view bytes) {
    static std::mutex parsing;  // XMLPlatformUtils::Initialize() and Terminate() are not thread-safe
    const std::scoped_lock lock(parsing);
    return {bytes.data(), bytes.size(), ::e57::ChecksumAll};
}

/// Cosine and sine of any usual angle; NaN for others, whose points are then invalid.
elementary::Turn turn(double angle) {
    constexpr double whole = 2 * std::numbers::pi, whole_rest = 2.4492935982947064e-16, most = 100;
    if (!(std::abs(angle) <= most)) return {std::nan(""), std::nan("")};
    const double turns = std::nearbyint(angle / whole);  // 0 for the standard's range, -π to π
    return elementary::turn_of((angle - turns * whole) - turns * whole_rest);
}

class E57Reader {
public:
    E57Reader(std::string_view bytes, const ReadOptions& options) : bytes_(bytes), options_(options) {}

    LoadedFile read() {
        const LeaksAllowed leaks_allowed;
        const Contents contents = checked_contents(bytes_);
        if (contents.scans == 0)
            throw Error("has no scans{}",
                        contents.images > 0
                            ? ", only " + count_text(contents.images, "image", "images") + "; images are not read"
                            : "")
                .hint("export it with its points");
        if (options_.view > contents.scans)
            throw Error("has no scan {}; it has {}", options_.view, count_text(contents.scans, "scan", "scans"))
                .hint(fmt::format("name a scan from #1 to #{}, or the file without a number for all", contents.scans));
        const ::e57::ImageFile file = translated([&] { return opened(bytes_); });
        describe(file, contents);
        require_room();
        for (ColumnPlan& plan : planned_columns(scans_, options_.on_warning)) columns_.emplace_back(std::move(plan));
        u64 records = 0;
        for (const Scan& scan : scans_) records += scan.records;
        if (records == 0) throw Error("{} no points", scans_.size() == 1 ? "its scan has" : "its scans have");
        require_countable(records, "points");
        require_memory(records);
        for (const Scan& scan : scans_)
            of_scan(scan.number, [&] {
                read_scan(file, scan);
                return 0;
            });
        if (positions_.empty()) throw Error("has no valid points: all {} are marked as invalid", invalid_);
        report(contents);
        return finished();
    }

private:
    /// Describes the chosen scans. Other scans may be broken.
    void describe(const ::e57::ImageFile& file, const Contents& contents) {
        const ::e57::VectorNode all = translated([&] {
            const ::e57::Node node = file.root().get("data3D");
            if (node.type() != ::e57::TypeVector) throw Error("its list of scans (data3D) is not a vector");
            return ::e57::VectorNode(node);
        });
        if (all.childCount() != contents.scans)
            throw Error("its XML section has {}, of which {} are listed in data3D",
                        count_text(contents.scans, "scan", "scans"), all.childCount());
        for (u32 number = 1; number <= contents.scans; ++number) {
            if (options_.view > 0 && options_.view != number) continue;
            scans_.push_back(of_scan(number, [&] {
                const ::e57::Node node = all.get(number - 1);
                if (node.type() != ::e57::TypeStructure) throw Error("it is not a structure");
                return described(::e57::StructureNode(node), number, options_.on_warning);
            }));
        }
    }

    /// Every scan has its own part of the file. Scans that promise more records than its bits can hold are refused
    /// before memory is allocated for them.
    void require_room() const {
        u64 left = 8 * bytes_.size();
        for (const Scan& scan : scans_) {
            if (scan.records > left / scan.bits)
                throw Error("scan {}: it promises {} of {}; the file has {}", scan.number,
                            count_text(scan.records, "point", "points"), count_text(scan.bits, "bit", "bits"),
                            count_text(bytes_.size(), "byte", "bytes"))
                    .hint(truncated_hint);
            left -= scan.records * scan.bits;
        }
    }

    void require_memory(u64 records) {
        std::size_t row = sizeof(Vec3) + (scans_.size() > 1 ? sizeof(u32) : 0);
        has_approach_ = std::ranges::all_of(scans_, [](const Scan& scan) {
            const bool is_spherical = scan.has({"sphericalRange", "sphericalAzimuth", "sphericalElevation"});
            return scan.records == 0 || is_spherical || scan.has({"rowIndex", "columnIndex"});
        });
        if (has_approach_) row += 3 * sizeof(float);
        for (const GrowingColumn& column : columns_) row += column.row_size();
        if (const u64 available = available_memory(); records > available / row)
            throw Error("its {} need {} of memory; {} are available", count_text(records, "point", "points"),
                        byte_size_text(records * row), byte_size_text(available))
                .hint("read one of its scans, as FILE.e57#1, or use a machine with more memory");
        // A point has rarely less than four bytes. With less, the arrays grow as the data come.
        constexpr std::size_t least_point = 4;
        const auto rows = static_cast<std::size_t>(std::min<u64>(records, bytes_.size() / least_point));
        positions_.reserve(rows);
        for (GrowingColumn& column : columns_) column.reserve(rows);
        if (has_approach_) approaches_.reserve(3 * rows);
        if (scans_.size() > 1) scan_of_.reserve(rows);
    }

    void read_scan(const ::e57::ImageFile& file, const Scan& scan) {
        comments_.insert(comments_.end(), scan.comments.begin(), scan.comments.end());
        if (scan.records == 0) return;
        const bool is_cartesian = scan.has({"cartesianX", "cartesianY", "cartesianZ"});
        if (!is_cartesian && !scan.has({"sphericalRange", "sphericalAzimuth", "sphericalElevation"}))
            throw Error("its points have neither cartesian nor spherical coordinates that are numbers");
        const std::string state = is_cartesian ? "cartesianInvalidState" : "sphericalInvalidState";
        Block block;
        std::vector<::e57::SourceDestBuffer> buffers;
        const auto capacity = static_cast<std::size_t>(std::min<u64>(block_size, scan.records));
        const auto add = [&](const std::string& name) {
            const auto [found, is_new] = block.try_emplace(name);
            if (!is_new) return;
            // Conversion and scaling are on: floats and scaled integers are read as doubles.
            if (scan.field(name)->is_integer) {
                found->second.integers.assign(capacity, 0);
                buffers.emplace_back(file, name, found->second.integers.data(), capacity, true, true);
            } else {
                found->second.reals.assign(capacity, 0);
                buffers.emplace_back(file, name, found->second.reals.data(), capacity, true, true);
            }
        };
        const std::vector<std::string> coordinates =
            is_cartesian ? std::vector<std::string>{"cartesianX", "cartesianY", "cartesianZ"}
                         : std::vector<std::string>{"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
        for (const std::string& name : coordinates) add(name);
        if (scan.field(state)) add(state);
        for (const GrowingColumn& column : columns_)
            for (const std::string& name : column.plan().sources.at(scan.number).fields) add(name);

        ::e57::CompressedVectorNode points = scan.points;
        ::e57::CompressedVectorReader reader = points.reader(buffers);
        std::vector<u32> valid;
        u64 done = 0;
        while (const unsigned count = reader.read()) {
            done += count;
            valid.clear();
            const auto states = block.find(state);
            for (u32 row = 0; row < count; ++row)
                if (states == block.end() || states->second.number(row) == 0) valid.push_back(row);
            invalid_ += count - valid.size();
            add_positions(scan, block, coordinates, is_cartesian, valid);
            for (GrowingColumn& column : columns_) column.append(scan, block, valid);
        }
        reader.close();
        if (done != scan.records)
            throw Error("it promises {}; its data hold {}", count_text(scan.records, "point", "points"), done)
                .hint(truncated_hint);
    }

    void add_positions(const Scan& scan, const Block& block, const std::vector<std::string>& coordinates,
                       bool is_cartesian, std::span<const u32> rows) {
        std::array<const FieldBlock*, 3> fields{};
        for (std::size_t i = 0; i < 3; ++i) fields[i] = &block.find(coordinates[i])->second;
        for (const u32 row : rows) {
            const Vec3 numbers(fields[0]->number(row), fields[1]->number(row), fields[2]->number(row));
            const Vec3 local = is_cartesian ? numbers : from_spherical(numbers);
            positions_.push_back(scan.pose ? scan.pose->apply(local) : local);
            if (scans_.size() > 1) scan_of_.push_back(scan.number - 1);
            if (!has_approach_) continue;
            Vec3 direction = Vec3(-local).stableNormalized();
            if (scan.pose) direction = scan.pose->rotation * direction;
            for (const double number : direction)
                approaches_.push_back(direction.allFinite() ? static_cast<float>(number) : 0.0f);
        }
    }

    static Vec3 from_spherical(const Vec3& numbers) {
        constexpr double steepest = std::numbers::pi / 2 + 1e-6;
        if (numbers[0] < 0) throw Error("a point has the range {:.6g} m; ranges are positive", numbers[0]);
        if (std::abs(numbers[2]) > steepest)
            throw Error("a point has the elevation {:.6g}; elevations are angles in radians, from -1.5708 to 1.5708",
                        numbers[2])
                .hint("export it again, with angles in radians");
        const auto [cosine, sine] = turn(numbers[1]);
        const auto [cosine_up, sine_up] = turn(numbers[2]);
        const double across = numbers[0] * cosine_up;
        return {across * cosine, across * sine, numbers[0] * sine_up};
    }

    void report(const Contents& contents) {
        const auto& warning = options_.on_warning;
        if (invalid_ > 0)
            warn(warning, "{} of {} points were left out: their coordinates are marked as invalid", invalid_,
                 invalid_ + positions_.size());
        for (const GrowingColumn& column : columns_)
            if (column.plan().is_flag && column.set_rows() > 0)
                warn(warning, "{} marked as invalid by the column '{}'; their stored values were kept",
                     count_text(column.set_rows(), "point is", "points are"), column.plan().name);
        for (const Scan& scan : scans_)
            if (scan.records == 0) warn(warning, "scan {} has no points", scan.number);
        if (scans_.size() > 1)
            warn(warning,
                 "{} scans were read as one cloud in their common frame; the column 'scan' has their numbers, from 0",
                 scans_.size());
        if (contents.images > 0) warn(warning, "{} left out", count_text(contents.images, "image was", "images were"));
    }

    LoadedFile finished() {
        PointCloud points;
        points.frame.unit = chosen_unit(LengthUnit::metre, options_);
        move_near_origin(positions_, points.frame);
        points.positions = std::move(positions_);
        for (GrowingColumn& column : columns_)
            if (!column.plan().is_flag || column.set_rows() > 0) points.columns.add(std::move(column).finished());
        if (has_approach_ && !points.columns.find("approach"))
            points.columns.add(Column("approach", 3, Buffer<float>(std::move(approaches_))));
        if (scans_.size() > 1 && !points.columns.find("scan"))
            points.columns.add(Column("scan", 1, Buffer(std::move(scan_of_))));
        LoadedFile loaded;
        loaded.format = "E57";
        loaded.encoding = "binary";
        loaded.comments = std::move(comments_);
        loaded.value = std::make_shared<const PointCloud>(std::move(points));
        return loaded;
    }

    std::string_view bytes_;
    const ReadOptions& options_;
    std::vector<Scan> scans_;  // the chosen ones
    std::vector<GrowingColumn> columns_;
    std::vector<std::string> comments_;
    Array<Vec3> positions_;
    Array<float> approaches_;  // unit vectors to the scanner
    Array<u32> scan_of_;
    bool has_approach_ = false;
    u64 invalid_ = 0;
};

}  // namespace

LoadedFile read_e57(const FileBytes& file, const ReadOptions& options) { return E57Reader(file.bytes, options).read(); }

u32 count_scans(std::string_view bytes) { return checked_contents(bytes).scans; }

}  // namespace scanmill::e57_format
