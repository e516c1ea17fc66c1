#include "nodes/seam/greedy.h"

#include "nodes/seam/energy_code.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <utility>

namespace fluidcarve {

namespace {

using Entry = std::uint16_t;

/// Columns fetched ahead of their turn. A seam drifts by at most an entry per column, so its line is known by then.
constexpr std::size_t ahead = 12;

/// Seams that advance together through all columns, so that the energy is read once for all of them.
class Sweep {
public:
    /// @param starts  the entry of each seam in the first column
    /// @param kept    frames of entries to keep: 2 to race, all of them to record
    Sweep(const EnergyVolume& energy, Window window, int number, std::span<const Entry> starts, std::size_t kept)
        : energy_(energy),
          first_(static_cast<unsigned>(window.first)),
          last_(static_cast<unsigned>(window.last)),
          below_first_(number % 2 == 0),
          starts_(starts),
          kept_(kept),
          entries_(kept * energy.columns_per_frame() * starts.size()),
          sums_(starts.size(), 0.0) {}

    void run(const Tick& tick) {
        for (std::size_t t = 0; t < energy_.frames(); ++t) {
            tick(static_cast<double>(t) / static_cast<double>(energy_.frames()));
            pass_frame(t);
        }
    }

    const std::vector<double>& sums() const { return sums_; }
    /// `[t][column]`, if there is but one seam and all frames are kept.
    std::vector<Entry> take_entries() { return std::move(entries_); }

private:
    Entry* frame(std::size_t t) { return entries_.data() + t % kept_ * energy_.columns_per_frame() * starts_.size(); }

    void pass_frame(std::size_t t) {
        const auto seams = starts_.size(), laterals = static_cast<std::size_t>(energy_.laterals()), columns = energy_.columns_per_frame();
        const auto* const slab = energy_.slab(t);
        Entry* const now = frame(t);
        const Entry* const before = t > 0 ? frame(t - 1) : nullptr;
        for (std::size_t c = 0; c < columns; ++c) {
            // A neighbour that does not exist is replaced by one that does.
            const Entry* beside = c % laterals > 0 ? now + (c - 1) * seams : nullptr;
            const Entry* under = c >= laterals ? now + (c - laterals) * seams : nullptr;
            const Entry* earlier = before ? before + c * seams : nullptr;
            const Entry* const nearest = beside ? beside : under ? under : earlier;
            const auto* const column = slab + c * energy_.stride();
            if (!nearest) {
                start(column, now);
                continue;
            }
            pass_column(column, now + c * seams, nearest, under ? under : nearest, earlier ? earlier : nearest);
        }
    }

    void start(const std::uint16_t* column, Entry* out) {
        for (std::size_t s = 0; s < starts_.size(); ++s) {
            out[s] = starts_[s];
            sums_[s] += decode_energy(column[out[s]]);
        }
    }

    void pass_column(const std::uint16_t* column, Entry* out, const Entry* a, const Entry* b, const Entry* c) {
        for (std::size_t s = 0; s < starts_.size(); ++s) {
            // Neighbours are within 2 of each other, so that what they allow is 1 to 3 entries.
            const unsigned most = std::max({a[s], b[s], c[s]}), least = std::min({a[s], b[s], c[s]});
            const unsigned low = most > first_ ? most - 1 : first_, high = std::min(least + 1, last_);
            const unsigned stay = std::clamp<unsigned>(a[s], low, high), middle = (low + high) / 2;
            const auto best = std::min({key(column, low, stay), key(column, middle, stay), key(column, high, stay)});
            out[s] = static_cast<Entry>(best);
            sums_[s] += decode_energy(static_cast<std::uint16_t>(best >> 32));
            __builtin_prefetch(column + ahead * energy_.stride() + out[s]);
        }
    }

    /// Orders candidates by energy, then by ties, then by entry.
    std::uint64_t key(const std::uint16_t* column, unsigned entry, unsigned stay) const {
        const unsigned tie = entry == stay ? 0 : (entry < stay) == below_first_ ? 1 : 2;
        return std::uint64_t{column[entry]} << 32 | tie << 16 | entry;
    }

    const EnergyVolume& energy_;
    const unsigned first_, last_;
    const bool below_first_;
    const std::span<const Entry> starts_;
    const std::size_t kept_;
    std::vector<Entry> entries_;
    std::vector<double> sums_;
};

std::vector<Entry> spread(Window window, int starts) {
    const int count = std::min(starts, window.size());
    std::vector<Entry> out;
    for (int s = 0; s < count; ++s) out.push_back(static_cast<Entry>(window.first + (2 * s + 1) * static_cast<std::int64_t>(window.size()) / (2 * count)));
    return out;
}

/// The start of the cheapest seam.
Entry race(const EnergyVolume& energy, Window window, int number, std::span<const Entry> starts, const Tick& tick) {
    const auto threads = std::min<std::size_t>(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), starts.size());
    std::vector<double> sums(starts.size());
    tbb::parallel_for(std::size_t{0}, threads, [&](std::size_t n) {
        const auto begin = starts.size() * n / threads, end = starts.size() * (n + 1) / threads;
        Sweep sweep(energy, window, number, starts.subspan(begin, end - begin), 2);
        sweep.run(tick);
        std::copy(sweep.sums().begin(), sweep.sums().end(), sums.begin() + static_cast<std::ptrdiff_t>(begin));
    });
    return starts[static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin())];
}

}  // namespace

Seams::Seam greedy_seam(const EnergyVolume& energy, Window window, int number, int starts, const Tick& tick) {
    const auto entries = spread(window, starts);
    // Only the winner's entries are worth their memory: it runs once more.
    const std::vector<Entry> winner{entries.size() == 1 ? entries[0] : race(energy, window, number, entries, [&](double fraction) { tick(0.9 * fraction); })};
    Sweep sweep(energy, window, number, winner, energy.frames());
    sweep.run([&](double fraction) { tick(0.9 + 0.1 * fraction); });
    const double cost = sweep.sums()[0];
    return {sweep.take_entries(), cost};
}

}  // namespace fluidcarve
