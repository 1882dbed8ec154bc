// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Chunks of a batch for a scheduler: shards of about equal time, each with a file that lists its units.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/records/run_records.hpp"
#include "scanmill/session/shard.hpp"

namespace scanmill {

/// The file of a chunk. `batch --cells FILE` runs its units.
struct ChunkFile {
    std::string shard, key_of_cells;  ///< as in RunStart
    std::vector<std::size_t> units;
};
constexpr auto fields(const ChunkFile*) {
    using R = ChunkFile;
    return std::tuple{field("shard", &R::shard, "Number of the chunk and of all chunks, as 3/40."),
                      field("key-of-cells", &R::key_of_cells, "Changes if the batch's cells do."),
                      field("units", &R::units, "Scans and runs of the batch, by number.")};
}
ChunkFile read_chunk(const std::filesystem::path& file);

/// The time and memory that a unit needs.
struct UnitCost {
    double seconds = 0;
    u64 memory = 0;  ///< in bytes
    bool is_recorded = false;  ///< false: estimated from the sizes of its files
};

/// The costs of all units of the batch. They are the largest of the last runs of the batch that `records` has, in which
/// steps were computed; without such a run, they are estimated: a second and 100 bytes of memory per byte of the scan
/// for every million bytes, for each variant.
std::vector<UnitCost> unit_costs(const CheckedBatch& batch, const RunRecords* records);

struct Chunk {
    ChunkFile file;
    double seconds = 0;  ///< sum over the units
    double longest = 0;  ///< the longest unit
    u64 memory = 0;  ///< the most that a unit needs
};

/// Divides the units, in their order, into chunks that end when `seconds` is reached. Pre: seconds > 0.
std::vector<Chunk> chunks_of(const CheckedBatch& batch, const std::vector<UnitCost>& costs, double seconds);

/// The folder of a chunk's outputs in the folder `folder` of an export, and the file of the chunk: `parts/0003` and
/// `chunks/0003.json`.
std::filesystem::path part_of_chunk(const std::filesystem::path& folder, std::size_t number);
std::filesystem::path file_of_chunk(const std::filesystem::path& folder, std::size_t number);

/// `failed`: the last run was interrupted or killed, the machine ran out of memory or disk, or the folder has no
/// records that can be read. A chunk of which scans failed for other reasons is done.
enum class ChunkState { waiting, running, done, failed };
constexpr std::array<std::string_view, 4> names_of(const ChunkState*) {
    return {"waiting", "running", "done", "failed"};
}

struct ChunkStatus {
    std::size_t chunk = 0, cells = 0, failed_cells = 0;
    ChunkState state = ChunkState::waiting;
};
constexpr auto fields(const ChunkStatus*) {
    using R = ChunkStatus;
    return std::tuple{field("chunk", &R::chunk, "Number of the chunk, from 1."), field("state", &R::state),
                      field("cells", &R::cells, "Recorded cells of its last run."),
                      field("failed-cells", &R::failed_cells)};
}

struct BatchStatusDocument {
    std::vector<ChunkStatus> chunks;
};
constexpr auto fields(const BatchStatusDocument*) { return std::tuple{field("chunks", &BatchStatusDocument::chunks)}; }

/// The states of all chunks in the folder of an export. Throws Error if it has no chunks.
std::vector<ChunkStatus> chunk_states(const std::filesystem::path& folder);

}  // namespace scanmill
