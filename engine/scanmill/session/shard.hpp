// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Divides the cells of a batch among machines.
///
/// A *unit* is what one machine computes: a scan or object with all its cells, which share steps; a run over several
/// scans of a workflow that takes a list; or the run of a workflow without inputs. Units are numbered from 0: first the
/// scans in the order of the batch, then the other runs in the order of the parts.

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scanmill/batch/batch.hpp"
#include "scanmill/graph/graph.hpp"

namespace scanmill {

/// Part `number` of `count`. Without further choice, shard i of n has the units i - 1, i - 1 + n, i - 1 + 2 n …
struct Shard {
    std::size_t number = 1, count = 1;

    /// Parses "3/7". Throws Error unless both are whole numbers and 1 <= number <= count.
    static Shard parse(std::string_view text);
    std::string text() const;
    bool operator==(const Shard&) const = default;
};

std::size_t units(const CheckedBatch& batch);

/// Equal for batches with the same cells: the same workflows, steps, values and names of scans, in the same order.
/// Paths count from the folder of the batch file, so that machines may mount it at different places.
std::string key_of_cells(const CheckedBatch& batch);

/// The places of cells among all cells of a batch, in the order in which one run of the whole batch would have them.
class CellPlaces {
public:
    /// Pre: no cell was removed from the batch yet.
    explicit CellPlaces(const CheckedBatch& batch);
    /// Sets RunCell::place of every cell of the graph.
    void set(RunGraph& graph) const;

private:
    std::map<std::pair<std::string, std::string>, std::size_t> first_;  // of a run, by workflow and scan
};

/// Removes all other units. Throws Error if none is left: the batch has fewer units than shards.
void choose(CheckedBatch& batch, const Shard& shard);
/// Removes all units but these. Throws Error for a number that the batch does not have.
void choose(CheckedBatch& batch, const std::vector<std::size_t>& units);

}  // namespace scanmill
