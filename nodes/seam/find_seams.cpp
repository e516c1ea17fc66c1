#include "nodes/seam/find_seams.h"

#include "nodes/seam/protection.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <optional>

namespace fluidcarve {

namespace {

void all_to_original(std::vector<Seams::Seam>& seams) {
    std::vector<std::span<std::uint16_t>> at;
    for (auto& seam : seams) at.push_back(seam.at.all());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, at.front().size(), 4096), [&](const tbb::blocked_range<std::size_t>& range) {
        std::vector<std::uint16_t> entries(seams.size()), scratch;
        for (auto c = range.begin(); c < range.end(); ++c) {
            for (std::size_t n = 0; n < seams.size(); ++n) entries[n] = at[n][c];
            to_original(entries, scratch);
            for (std::size_t n = 0; n < seams.size(); ++n) at[n][c] = entries[n];
        }
    });
}

void require_seam(const EnergyVolume& energy, Window window, int found) {
    if (!energy.protects()) return;
    const Columns columns(energy);
    with_costs(energy, [&](const auto& cost_at) {
        std::vector<std::uint16_t> lowest;
        const auto emptied = lowest_seam(columns, lowest, Band::whole(columns.count(), window), cost_at);
        if (!emptied) return;
        const auto free = [&](std::size_t c) {
            int out = 0;
            for (int entry = window.first; entry <= window.last; ++entry) out += std::isinf(cost_at(c, entry)) ? 0 : 1;
            return out;
        };
        std::size_t blocked = 0;
        while (blocked < columns.count() && free(blocked) > 0) ++blocked;
        const auto column = blocked < columns.count() ? blocked : *emptied;
        throw NoSeam(found, {column, window.size(), free(column)});
    });
}

SeamEntries repeated(const SeamEntries& frame, std::size_t frames) {
    std::vector<std::uint16_t> out;
    out.reserve(frame.size() * frames);
    for (std::size_t t = 0; t < frames; ++t) out.insert(out.end(), frame.begin(), frame.end());
    return out;
}

}  // namespace

void require_room(Seams::Kind kind, int count, Window window, int width) {
    const bool at_end = kind == Seams::Kind::insert && window.last == width - 1;
    const int room = window.size() - (at_end ? 1 : 0);
    if (count <= room) return;
    throw Failure(fmt::format("{} fit: window [{}, {}] has room to {} {}{}", count == 1 ? "1 seam does not" : fmt::format("{} seams do not", count),
                              window.first, window.last, to_text(kind), room == 0 ? "none" : std::to_string(room),
                              at_end ? "; new vertices stand between two old ones, so that none can follow the lattice's last" : ""));
}

NoSeam::NoSeam(int found, const Bottleneck& at)
    : Failure(fmt::format("{} {} possible: protected vertices leave no way past column {}", found, found == 1 ? "seam is" : "seams are", at.column)),
      found(found),
      at(at) {}

FoundSeams find_seams(EnergyVolume& volume, Seams::Kind kind, int count, Window window, const FindSeam& find, const Tick& tick, const KeepSeam& keep,
                      bool still) {
    require_room(kind, count, window, volume.width());
    if (kind == Seams::Kind::insert) window.last = std::min(window.last, volume.width() - 2);
    std::optional<EnergyVolume> sum;
    if (still && count > 0) sum = volume.sum();
    auto& energy = sum ? *sum : volume;

    FoundSeams out;
    for (int n = 0; n < count; ++n) {
        const auto start = std::chrono::steady_clock::now();
        const Window left{window.first, window.last - n};
        require_seam(energy, left, n);
        auto seam = find(energy, left, n, [&](double fraction) { tick((n + fraction) / count); });
        const auto met = energy.met(seam.at);
        out.zero_share.push_back(static_cast<double>(met.zeros) / static_cast<double>(seam.at.size()));
        out.attracted.push_back(met.attracted);
        out.blocked.push_back(met.blocked);
        if (n + 1 < count) energy.remove(seam.at);
        if (still) seam.at = repeated(seam.at, volume.frames());
        if (keep) seam.at = keep(std::move(seam.at));
        out.seams.push_back(std::move(seam));
        out.wall_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    // The last seam was not deleted.
    if (count > 0) out.attracted_left = energy.attracted() - out.attracted.back();
    if (kind == Seams::Kind::insert && count > 0) all_to_original(out.seams);
    return out;
}

}  // namespace fluidcarve
