// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/tour.hpp"

#include <algorithm>

#include "scanmill/base/parallel.hpp"

namespace scanmill::probing {

namespace {

/// A line in the tour: its first touch and its direction.
struct Passage {
    const TouchLine* line;
    u32 first;  ///< position in line->rows
    bool backwards;

    u32 count() const { return static_cast<u32>(line->rows.size()); }
    u32 last() const {
        return line->closed ? (backwards ? first + 1 : first + count() - 1) % count() : count() - 1 - first;
    }
    u32 row(u32 step) const { return line->rows[(backwards ? first + count() - step : first + step) % count()]; }
    u32 first_row() const { return line->rows[first]; }
    u32 last_row() const { return line->rows[last()]; }
    Passage reversed() const { return {line, last(), !backwards}; }
};

class Tour {
public:
    Tour(const std::vector<TouchLine>& lines, const std::vector<ProbeTouch>& touches, const Vec3& home, double diagonal,
         const Context& context)
        : touches_(touches),
          home_(home),
          least_gain_(1e-9 * diagonal),
          context_(context) {
        begin_greedily(lines);
        constexpr int most_rounds = 10;
        for (int round = 0; round < most_rounds; ++round) {
            const bool is_reversed = reverse_parts();
            if (!begin_lines_anew() && !is_reversed) break;
        }
    }

    std::vector<u32> rows() const {
        std::vector<u32> rows;
        for (const Passage& passage : passages_)
            for (u32 step = 0; step < passage.count(); ++step) rows.push_back(passage.row(step));
        return rows;
    }

private:
    const Vec3& start(u32 row) const { return touches_[row].start; }
    /// Position from which the probe comes to the passage with index `at`.
    const Vec3& before(std::size_t at) const { return at == 0 ? home_ : start(passages_[at - 1].last_row()); }
    /// Length of the way from a touch to the next passage; 0 at the end of the tour.
    double to_next(u32 row, std::size_t next) const {
        return next < passages_.size() ? (start(passages_[next].first_row()) - start(row)).norm() : 0;
    }

    void begin_greedily(const std::vector<TouchLine>& lines) {
        std::vector<bool> used(lines.size());
        Vec3 from = home_;
        for (std::size_t count = 0; count < lines.size(); ++count) {
            context_.check_cancelled();
            double least = std::numeric_limits<double>::infinity();
            Passage next{};
            for (std::size_t i = 0; i < lines.size(); ++i) {
                if (used[i]) continue;
                const auto size = static_cast<u32>(lines[i].rows.size());
                const u32 step = lines[i].closed ? 1 : std::max(1u, size - 1);
                for (u32 first = 0; first < size; first += step) {
                    const double distance = (start(lines[i].rows[first]) - from).norm();
                    if (distance >= least) continue;
                    least = distance;
                    next = {&lines[i], first, !lines[i].closed && first > 0};
                }
            }
            used[static_cast<std::size_t>(next.line - lines.data())] = true;
            passages_.push_back(next);
            from = start(next.last_row());
        }
    }

    bool reverse_parts() {
        bool is_changed = false;
        for (std::size_t i = 0; i < passages_.size(); ++i) {
            context_.check_cancelled();
            for (std::size_t j = i; j < passages_.size(); ++j) {
                const u32 first = passages_[i].first_row(), last = passages_[j].last_row();
                const double now = (start(first) - before(i)).norm() + to_next(last, j + 1),
                             then = (start(last) - before(i)).norm() + to_next(first, j + 1);
                if (now - then <= least_gain_) continue;
                std::reverse(passages_.begin() + static_cast<std::ptrdiff_t>(i),
                             passages_.begin() + static_cast<std::ptrdiff_t>(j + 1));
                for (std::size_t k = i; k <= j; ++k) passages_[k] = passages_[k].reversed();
                is_changed = true;
            }
        }
        return is_changed;
    }

    bool begin_lines_anew() {
        bool is_changed = false;
        for (std::size_t i = 0; i < passages_.size(); ++i) {
            context_.check_cancelled();
            Passage& passage = passages_[i];
            if (!passage.line->closed) continue;
            const auto cost = [&](const Passage& candidate) {
                return (start(candidate.first_row()) - before(i)).norm() + to_next(candidate.last_row(), i + 1);
            };
            u32 nearest = 0;
            for (u32 first = 1; first < passage.count(); ++first)
                if ((start(passage.line->rows[first]) - before(i)).squaredNorm() <
                    (start(passage.line->rows[nearest]) - before(i)).squaredNorm())
                    nearest = first;
            for (const bool backwards : {false, true}) {
                const Passage candidate{passage.line, nearest, backwards};
                if (cost(passage) - cost(candidate) <= least_gain_) continue;
                passage = candidate;
                is_changed = true;
            }
        }
        return is_changed;
    }

    const std::vector<ProbeTouch>& touches_;
    const Vec3 home_;
    const double least_gain_;
    const Context& context_;
    std::vector<Passage> passages_;
};

double length_of(std::span<const Vec3> path) {
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
    return length;
}

}  // namespace

std::vector<u32> tour_over(const std::vector<TouchLine>& lines, const std::vector<ProbeTouch>& touches,
                           const Vec3& home, double diagonal, const Context& context) {
    return Tour(lines, touches, home, diagonal, context).rows();
}

double add_moves(ProbePlan& plan, const std::vector<u32>& tour, const Machine& machine, const Context& context) {
    const auto from = [&](std::size_t i) { return i == 0 ? machine.home() : plan.touches[tour[i - 1]].start; };
    std::vector<u8> is_straight(tour.size());
    constexpr std::size_t chunk = 16;
    for_each_chunk(context.threads(), tour.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i)
            is_straight[i] = machine.is_move_free(from(i), plan.touches[tour[i]].start);
    });

    double travel = 0;
    const auto add = [&](ProbeMoveType type, u32 row, std::initializer_list<Vec3> points) {
        Array<Vec3> path;
        for (const Vec3& point : points)
            if (path.empty() || path.back() != point) path.push_back(point);
        travel += length_of(path);
        plan.moves.push_back({type, row, std::move(path)});
    };
    for (std::size_t i = 0; i < tour.size(); ++i) {
        ProbeTouch& touch = plan.touches[tour[i]];
        touch.order = static_cast<u32>(i);
        if (is_straight[i])
            add(ProbeMoveType::clearance, tour[i], {from(i), touch.start});
        else
            add(ProbeMoveType::clearance, tour[i],
                {from(i), machine.lifted(from(i)), machine.lifted(touch.start), touch.start});
        add(ProbeMoveType::approach, tour[i], {touch.start, touch.centre});
        add(ProbeMoveType::retract, tour[i], {touch.centre, touch.start});
    }
    return travel;
}

}  // namespace scanmill::probing
