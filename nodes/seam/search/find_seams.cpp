#include "nodes/seam/search/find_seams.h"

#include "nodes/seam/energy/half.h"
#include "nodes/seam/search/coarse.h"
#include "nodes/seam/search/protection.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <optional>

namespace fluidcarve {

namespace {

/// A bit for each original entry of each column: whether it is deleted.
class Deleted {
public:
    Deleted(std::size_t columns, int width, std::uint64_t memory_budget, const std::string& folder)
        : words_((static_cast<std::size_t>(width) + 15) / 16), store_(1, columns * words_, memory_budget, folder) {}

    /// Deletes a seam.
    /// @param at  its entries in the space that earlier seams left; become original entries
    void to_original(std::span<std::uint16_t> at) {
        each(at, [](std::span<std::uint16_t> words, std::uint16_t& entry) {
            int left = entry;  // remaining entries before it
            std::size_t w = 0;
            const auto there_are = [&] { return 16 - std::popcount(words[w]); };
            for (; left >= there_are(); ++w) left -= there_are();
            auto there = static_cast<std::uint16_t>(~words[w]);
            for (; left > 0; --left) there = static_cast<std::uint16_t>(there & (there - 1));
            const int bit = std::countr_zero(there);
            mark(words[w], bit);
            entry = static_cast<std::uint16_t>(w * 16 + static_cast<std::size_t>(bit));
        });
    }
    /// The same in the other direction: takes original entries, which become entries in that space.
    void from_original(std::span<std::uint16_t> at) {
        each(at, [](std::span<std::uint16_t> words, std::uint16_t& entry) {
            const std::size_t w = entry / 16u;
            const int bit = entry % 16;
            int before = std::popcount(static_cast<std::uint16_t>(words[w] & ((1u << bit) - 1)));
            for (const auto word : words.first(w)) before += std::popcount(word);
            mark(words[w], bit);
            entry = static_cast<std::uint16_t>(entry - before);
        });
    }

private:
    static void mark(std::uint16_t& word, int bit) { word = static_cast<std::uint16_t>(word | (1u << bit)); }
    template <class Visit>
    void each(std::span<std::uint16_t> at, const Visit& visit) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, at.size(), 4096), [&](const tbb::blocked_range<std::size_t>& range) {
            for (auto c = range.begin(); c < range.end(); ++c) visit(store_.entries(0).subspan(c * words_, words_), at[c]);
        });
    }

    std::size_t words_;  ///< per column
    FrameStore store_;
};

/// Where the way of the next seam is blocked, if it is. @param found  number of seams found before
std::optional<NoSeam> blocked_seam(const EnergyVolume& energy, Window window, int found) {
    std::optional<NoSeam> out;
    if (!energy.protects()) return out;
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
        out.emplace(found, NoSeam::Bottleneck{column, window.size(), free(column)});
    });
    return out;
}

/// Whether insertions in a window would have to follow the lattice's last vertex.
bool ends_lattice(Seams::Kind kind, Window window, int width) { return kind == Seams::Kind::insert && window.last == width - 1; }

/// The window of half size whose seams, interpolated to full size, stay in a window.
Window half_window(Window window) { return {halved(window.first), halved(window.last) - 1}; }

/// Where a seam of half size finds no way, at full size.
NoSeam at_full_size(const NoSeam& none, int found, const EnergyVolume& energy, const FullSize& full) {
    const auto place = Columns(energy).place(none.at.column);
    return {found, {full.columns.at(2 * place.lateral, 2 * place.k, 2 * place.t), 2 * none.at.vertices, 2 * none.at.free}};
}

SeamEntries repeated(const SeamEntries& frame, std::size_t frames) {
    std::vector<std::uint16_t> out;
    out.reserve(frame.size() * frames);
    for (std::size_t t = 0; t < frames; ++t) out.insert(out.end(), frame.begin(), frame.end());
    return out;
}

}  // namespace

int room_in(Seams::Kind kind, Window window, int width, int finest) {
    if (ends_lattice(kind, window, width)) --window.last;
    return finest == 2 ? 2 * std::max(half_window(window).size(), 0) : window.size();
}

void require_room(Seams::Kind kind, int count, Window window, int width, int finest) {
    const int room = room_in(kind, window, width, finest);
    if (count <= room) return;
    const auto at_half_size = finest == 2 ? fmt::format(" at half size; at full size (`finest: 1`) for {}", room_in(kind, window, width)) : "";
    throw Failure(
        fmt::format("{} fit: window [{}, {}] has room to {} {}{}{}", count == 1 ? "1 seam does not" : fmt::format("{} seams do not", count), window.first,
                    window.last, to_text(kind), room == 0 ? "none" : std::to_string(room), at_half_size,
                    ends_lattice(kind, window, width) ? "; a new vertex goes between two old ones, so none can follow the lattice's last vertex" : ""));
}

NoSeam::NoSeam(int found, const Bottleneck& at)
    : Failure(fmt::format("{} {} possible: protected vertices leave no way past column {}", found, found == 1 ? "seam is" : "seams are", at.column)),
      found(found),
      at(at) {}

FoundSeams find_seams(EnergyVolume& volume, Seams::Kind kind, int count, Window window, const FindSeam& find, const Tick& tick, const KeepSeam& keep,
                      bool static_, const Continued& continued) {
    const auto& full = continued.full;
    const int width = full ? full->width : volume.width();
    // Seams that come of one that is found.
    const int each = full ? 2 : 1, searches = (count + each - 1) / each;
    require_room(kind, count, window, width, each);
    if (kind == Seams::Kind::insert) window.last = std::min(window.last, width - 2);
    if (full) window = half_window(window);
    std::optional<EnergyVolume> sum;
    if (static_ && count > 0) sum = volume.sum();
    auto& energy = sum ? *sum : volume;

    const auto full_columns = [&] {
        const auto& of = full->columns;
        return sum ? Columns(static_cast<int>(of.laterals()), static_cast<int>(of.slices()), 1, of.ring(1), of.ring(0)) : of;
    };
    const auto columns = full ? full_columns().count() : energy.columns_per_frame() * energy.frames();
    const auto all_frames = full ? full->columns.frames() : volume.frames();
    std::optional<Deleted> deleted;
    if (kind == Seams::Kind::insert && count > 0) deleted.emplace(columns, width, continued.memory_budget, continued.folder);

    FoundSeams out;
    // The last seam is not deleted: no search follows it.
    const auto meet = [&](std::span<const std::uint16_t> at, int number) {
        const auto met = energy.met(at);
        for (int n = 0; n < std::min(each, count - each * number); ++n) {
            out.zero_share.push_back(static_cast<double>(met.zeros) / static_cast<double>(at.size()));
            out.attracted.push_back(met.attracted);
            out.blocked.push_back(met.blocked);
            out.attracted_left.push_back(energy.attracted() - met.attracted);
        }
        if (number + 1 == searches) return;
        const Window left{window.first, window.last - number};
        if (continued.bounds) continued.bounds->follow(energy, left, at, number);
        energy.remove(at, left);
    };
    // A seam that was found becomes seams of the set.
    const auto add = [&](Seams::Seam seam, int number, double seconds) {
        if (full) {
            const Columns here(energy);
            const double share = static_cast<double>(columns) / static_cast<double>(here.count());
            seam.at = prolong_seam(here, seam.at, full_columns(), {0, width - each * number - 1});
            seam.energy *= share;
            if (seam.lower_bound) *seam.lower_bound *= share;
        }
        const int some = std::min(each, count - each * number);
        for (int n = 0; n < some; ++n) {
            auto one = seam;
            if (deleted) deleted->to_original(one.at.all());
            if (static_) one.at = repeated(one.at, all_frames);
            if (keep) one.at = keep(std::move(one.at));
            out.seams.push_back(std::move(one));
            out.wall_s.push_back(seconds / some);
        }
    };
    std::vector<std::uint16_t> last;
    for (const auto& seam : continued.before) {
        tick(0);
        last.assign(seam.at.begin(), seam.at.begin() + static_cast<std::ptrdiff_t>(columns));
        if (deleted) deleted->from_original(last);
        meet(last, static_cast<int>(out.seams.size()));
        out.seams.push_back(seam);
        out.wall_s.push_back(0);
    }
    if (!last.empty() && continued.start_from) continued.start_from(last);
    const int known = static_cast<int>(out.seams.size());
    for (int n = known; n < searches; ++n) {
        const auto start = std::chrono::steady_clock::now();
        const Window left{window.first, window.last - n};
        if (auto blocked = blocked_seam(energy, left, n)) {
            if (full) blocked = at_full_size(*blocked, each * n, energy, *full);
            if (!continued.best_effort) throw NoSeam(*blocked);
            out.no_more = std::move(blocked);
            break;
        }
        const auto tell = [&](double fraction) { tick((n - known + fraction) / (searches - known)); };
        auto seam = find(energy, left, n, tell, continued.bounds);
        const auto end = std::chrono::steady_clock::now();
        if (!seam.lower_bound && continued.bounds) seam.lower_bound = continued.bounds->energy_bound(energy, left, seam.at.all(), n, tell);
        const auto bounded = std::chrono::steady_clock::now() - end;
        meet(seam.at, n);
        const auto seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start - bounded).count();
        add(std::move(seam), n, seconds);
        if (continued.found) continued.found(out);
    }
    return out;
}

}  // namespace fluidcarve
