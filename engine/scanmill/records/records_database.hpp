// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The records' SQLite file: its tables by version, and its errors as ours. Private to the records.

#include <SQLiteCpp/SQLiteCpp.h>
#include <SQLiteCpp/VariadicBind.h>

#include <map>
#include <nlohmann/json.hpp>

#include "scanmill/base/error.hpp"
#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// Calls SQLite; what it refuses becomes a sentence about the records.
template <class Action>
auto about(const std::string& file, Action&& action) {
    try {
        return action();
    } catch (const SQLite::Exception& error) {
        throw Error("the records '{}': {}", file, error.what());
    }
}

struct RunRecords::Database {
    Database(const std::filesystem::path& path, int flags) : file(path.string()), sqlite(file, flags, patience) {}

    /// Brings the tables to the last version; makes them in an empty file.
    void migrate();
    int version() { return sqlite.execAndGet("PRAGMA user_version").getInt(); }
    /// Throws Error for tables of a newer Scanmill.
    void require_known(int version) const;

    static constexpr int patience = 1000;  // milliseconds, while another run writes
    std::string file;
    SQLite::Database sqlite;
    std::map<std::pair<std::int64_t, std::size_t>, std::int64_t> step_ids;  // of a run's nodes
};

}  // namespace scanmill
