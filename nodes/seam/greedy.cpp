#include "nodes/seam/greedy.h"

#include "nodes/seam/energy_code.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace fluidcarve {

namespace {

using Entry = std::uint16_t;

/// Columns fetched ahead of their turn. A seam drifts by at most an entry per column, so its line is known by then.
constexpr std::size_t ahead = 12;

/// Most seams that race at once: what they leave behind takes a quarter of a byte for each in every column.
constexpr std::size_t group = 64;

/// Seams that advance together through all columns, so that the energy is read once for all of them. Each leaves behind
/// its steps: by how much, -1 to 1, its entry differs from that of the nearest column before.
class Sweep {
public:
    /// @param starts  the entry of each seam in the first column
    Sweep(const EnergyVolume& energy, Window window, int number, std::span<const Entry> starts)
        : energy_(energy),
          first_(static_cast<unsigned>(window.first)),
          last_(static_cast<unsigned>(window.last)),
          below_first_(number % 2 == 0),
          starts_(starts),
          step_bytes_((starts.size() + 3) / 4),
          entries_(2 * energy.columns_per_frame() * starts.size()),
          steps_(energy.frames() * energy.columns_per_frame() * step_bytes_),
          sums_(starts.size(), 0.0) {}

    void run(const Tick& tick) {
        for (std::size_t t = 0; t < energy_.frames(); ++t) {
            tick(static_cast<double>(t) / static_cast<double>(energy_.frames()));
            pass_frame(t);
        }
    }

    const std::vector<double>& sums() const { return sums_; }

    /// `[t][column]` of one seam.
    std::vector<Entry> entries(std::size_t seam) const {
        const auto laterals = static_cast<std::size_t>(energy_.laterals()), columns = energy_.columns_per_frame();
        std::vector<Entry> out(energy_.frames() * columns);
        out[0] = starts_[seam];
        for (std::size_t n = 1; n < out.size(); ++n) {
            const auto c = n % columns;
            const auto nearest = c % laterals > 0 ? out[n - 1] : c >= laterals ? out[n - laterals] : out[n - columns];
            const int step = (steps_[n * step_bytes_ + seam / 4] >> (2 * (seam % 4)) & 3) - 1;
            out[n] = static_cast<Entry>(nearest + step);
        }
        return out;
    }

private:
    Entry* frame(std::size_t t) { return entries_.data() + t % 2 * energy_.columns_per_frame() * starts_.size(); }

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
            pass_column(column, now + c * seams, nearest, under ? under : nearest, earlier ? earlier : nearest,
                        steps_.data() + (t * columns + c) * step_bytes_);
        }
    }

    void start(const std::uint16_t* column, Entry* out) {
        for (std::size_t s = 0; s < starts_.size(); ++s) {
            out[s] = starts_[s];
            sums_[s] += decode_energy(column[out[s]]);
        }
    }

    void pass_column(const std::uint16_t* column, Entry* out, const Entry* a, const Entry* b, const Entry* c, std::uint8_t* steps) {
        for (std::size_t s = 0; s < starts_.size(); ++s) {
            // Neighbours are within 2 of each other, so that what they allow is 1 to 3 entries.
            const unsigned most = std::max({a[s], b[s], c[s]}), least = std::min({a[s], b[s], c[s]});
            const unsigned low = most > first_ ? most - 1 : first_, high = std::min(least + 1, last_);
            const unsigned stay = std::clamp<unsigned>(a[s], low, high), middle = (low + high) / 2;
            const auto best = std::min({key(column, low, stay), key(column, middle, stay), key(column, high, stay)});
            out[s] = static_cast<Entry>(best);
            steps[s / 4] = static_cast<std::uint8_t>(steps[s / 4] | (out[s] - a[s] + 1) << (2 * (s % 4)));
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
    const std::size_t step_bytes_;
    std::vector<Entry> entries_;
    std::vector<std::uint8_t> steps_;  ///< `[t][column]`, two bits per seam
    std::vector<double> sums_;
};

std::vector<Entry> spread(Window window, int starts) {
    const int count = std::min(starts, window.size());
    std::vector<Entry> out;
    for (int s = 0; s < count; ++s) out.push_back(static_cast<Entry>(window.first + (2 * s + 1) * static_cast<std::int64_t>(window.size()) / (2 * count)));
    return out;
}

/// The cheapest of seams that race in as many sweeps as there are threads; of equals the first.
Seams::Seam race(const EnergyVolume& energy, Window window, int number, std::span<const Entry> starts, const Tick& tick) {
    const auto threads = std::min<std::size_t>(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()), starts.size());
    std::vector<std::optional<Sweep>> sweeps(threads);
    tbb::parallel_for(std::size_t{0}, threads, [&](std::size_t n) {
        const auto begin = starts.size() * n / threads, end = starts.size() * (n + 1) / threads;
        sweeps[n].emplace(energy, window, number, starts.subspan(begin, end - begin));
        sweeps[n]->run(tick);
    });
    const Sweep* best = nullptr;
    std::size_t seam = 0;
    for (const auto& sweep : sweeps)
        for (std::size_t s = 0; s < sweep->sums().size(); ++s)
            if (!best || sweep->sums()[s] < best->sums()[seam]) {
                best = &*sweep;
                seam = s;
            }
    return {best->entries(seam), best->sums()[seam]};
}

}  // namespace

Seams::Seam greedy_seam(const EnergyVolume& energy, Window window, int number, int starts, const Tick& tick) {
    const auto entries = spread(window, starts);
    const auto groups = (entries.size() + group - 1) / group;
    std::optional<Seams::Seam> best;
    for (std::size_t n = 0; n < groups; ++n) {
        const auto some = std::span(entries).subspan(n * group).first(std::min(group, entries.size() - n * group));
        auto seam = race(energy, window, number, some, [&](double fraction) { tick((static_cast<double>(n) + fraction) / static_cast<double>(groups)); });
        if (!best || seam.energy < best->energy) best = std::move(seam);
    }
    return std::move(*best);
}

}  // namespace fluidcarve
