#include "nodes/seam/find_seams.h"

#include "graph/problem.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

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

}  // namespace

FoundSeams find_seams(EnergyVolume& energy, Seams::Kind kind, int count, Window window, const FindSeam& find, const Tick& tick, const KeepSeam& keep) {
    if (kind == Seams::Kind::insert) window.last = std::min(window.last, energy.width() - 2);
    if (count > window.size())
        throw Failure(fmt::format("{} seams do not fit: from vertex {} to {} there is room for {} to {}", count, window.first, window.last,
                                  std::max(window.size(), 0), to_text(kind)));

    FoundSeams out;
    for (int n = 0; n < count; ++n) {
        const auto start = std::chrono::steady_clock::now();
        auto seam = find(energy, {window.first, window.last - n}, n, [&](double fraction) { tick((n + fraction) / count); });
        if (keep) seam.at = keep(std::move(seam.at));
        out.seams.push_back(std::move(seam));
        if (n + 1 < count) energy.remove(out.seams.back().at);
        out.wall_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    if (kind == Seams::Kind::insert && count > 0) all_to_original(out.seams);
    return out;
}

}  // namespace fluidcarve
