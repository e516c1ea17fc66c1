#include "carve/solver/search/find_seams.h"

#include "carve/solver/costs/half.h"
#include "carve/solver/search/coarse.h"
#include "carve/solver/search/deleted_entries.h"
#include "carve/solver/search/protection.h"
#include "carve/solver/search/slab_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace fluidcarve {

namespace {

/// The place where the next seam is blocked, if any. @param found  number of seams found before
std::optional<NoSeam> blocked_seam(const EnergyVolume& energy, Window window, int found) {
    std::optional<NoSeam> out;
    if (!energy.protects()) return out;
    const Columns columns(energy);
    with_costs(energy, [&](const auto& cost_at) {
        std::vector<std::uint16_t> lowest;
        const auto emptied =
            lowest_seam(columns, lowest, Band::whole(columns.count(), window), cost_at);
        if (!emptied) return;
        const auto free_at = [&](std::size_t c) {
            int room = 0;
            for (int entry = window.first; entry <= window.last; ++entry)
                room += !std::isinf(cost_at(c, entry));
            return room;
        };
        std::size_t blocked = 0;
        while (blocked < columns.count() && free_at(blocked) > 0) ++blocked;
        const auto column = blocked < columns.count() ? blocked : *emptied;
        out.emplace(found, NoSeam::Bottleneck{column, window.size(), free_at(column)});
    });
    return out;
}

/// Whether insertions in a window would have to follow the lattice's last vertex.
bool ends_lattice(Seams::Kind kind, Window window, int width) {
    return kind == Seams::Kind::insert && window.last == width - 1;
}

/// The window of half size whose seams, interpolated to full size, stay in a window.
Window half_window(Window window) { return {halved(window.first), halved(window.last) - 1}; }

/// The place where a seam of half size is blocked, at full size.
NoSeam at_full_size(const NoSeam& none, int found, const EnergyVolume& energy,
                    const FullSize& full) {
    const auto place = Columns(energy).place(none.at.column);
    return {found,
            {full.columns.at(2 * place.lateral, 2 * place.slice, 2 * place.t), 2 * none.at.vertices,
             2 * none.at.free}};
}

}  // namespace

int room_in(Seams::Kind kind, Window window, int width, int finest) {
    if (ends_lattice(kind, window, width)) --window.last;
    return finest == 2 ? 2 * std::max(half_window(window).size(), 0) : window.size();
}

void require_room(Seams::Kind kind, int count, Window window, int width, int finest) {
    const int room = room_in(kind, window, width, finest);
    if (count <= room) return;
    const auto at_half_size = finest == 2
                                  ? fmt::format(" at half size; at full size (`finest: 1`) for {}",
                                                room_in(kind, window, width))
                                  : "";
    throw Failure(fmt::format(
        "{} fit: window [{}, {}] has room to {} {}{}{}",
        count == 1 ? "1 seam does not" : fmt::format("{} seams do not", count), window.first,
        window.last, to_text(kind), room == 0 ? "none" : std::to_string(room), at_half_size,
        ends_lattice(kind, window, width) ? "; a new vertex goes between two old ones, so none can "
                                            "follow the lattice's last vertex"
                                          : ""));
}

NoSeam::NoSeam(int found, const Bottleneck& at)
    : Failure(fmt::format("{} {} possible: protected vertices leave no way past column {}", found,
                          found == 1 ? "seam is" : "seams are", at.column)),
      found(found),
      at(at) {}

namespace {

/// The loop of find_seams(), search by search.
class SeamsInTurn {
public:
    SeamsInTurn(EnergyVolume& volume, const SeamPart& part, int count, const SearchOptions& options)
        : volume_(volume),
          kind_(part.kind),
          count_(count),
          window_(part.window),
          static_(part.static_),
          options_(options),
          full_(options.full),
          width_(full_ ? full_->width : volume.width()),
          thickness_(options.thick ? options.thick->thickness : 1) {
        require_room(kind_, count_, window_, width_, full_ ? 2 : 1);
        if (inserts()) window_.last = std::min(window_.last, width_ - 2);
        if (full_) window_ = half_window(window_);
        if (count_ == 0) return;
        thickness_ = std::min(thickness_, window_.size());
        if (options.thick)
            slabs_.emplace(volume, Thick{thickness_, options.thick->weights}, inserts(), static_,
                           options.limits);
        else if (static_) sum_ = volume.sum();
        if (inserts() && !slabs_) deleted_.emplace(columns(), width_, options.limits);
    }

    FoundSeams run(const FindSeam& find, const Tick& tick) {
        take_known(tick);
        const int known = searches_;
        while (found() < count_) {
            const auto start = std::chrono::steady_clock::now();
            const int thickness = thickness_now();
            const auto left = window_left(thickness);
            if (slabs_) slabs_->price(thickness);
            const auto& energy = this->energy();
            if (auto none = blocked(energy, left)) {
                if (!options_.best_effort) throw NoSeam(*none);
                out_.no_more = std::move(none);
                break;
            }
            const int done = searches_ - known,
                      left_to_do = (count_ - found() + each() - 1) / each();
            const auto tell = [&](double fraction) {
                tick((done + fraction) / (done + left_to_do));
            };
            auto* const bounds = slabs_ ? nullptr : options_.bounds;
            auto seam = slabs_ ? slabs_->find(find, thickness, left, searches_, tell)
                               : find(energy, left, searches_, tell, bounds);
            const auto end = std::chrono::steady_clock::now();
            if (!seam.lower_bound && bounds)
                seam.lower_bound =
                    bounds->energy_bound(energy, left, seam.at.all(), searches_, tell);
            const auto bounded = std::chrono::steady_clock::now() - end;
            count_met(energy, seam.at);
            take(seam.at, thickness, left);
            const auto seconds =
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start - bounded)
                    .count();
            add(std::move(seam), thickness, seconds);
            if (options_.found) options_.found(out_);
        }
        return std::move(out_);
    }

private:
    int found() const { return static_cast<int>(out_.seams.size()); }
    bool inserts() const { return kind_ == Seams::Kind::insert; }
    /// The energy in which seams are searched.
    const EnergyVolume& energy() const {
        return slabs_ ? slabs_->prices() : sum_ ? *sum_ : volume_;
    }
    /// Number of seams that each found seam or slab stands for.
    int each() const { return thickness_ * (full_ ? 2 : 1); }
    /// The thickness of the next slab. It does not depend on how many seams are wanted, so that a
    /// continued search finds the same slabs.
    int thickness_now() const {
        return slabs_ && !inserts() ? std::min(thickness_, window_.size() - taken_) : thickness_;
    }
    /// The entries that the next seam may take, or with which the next slab may begin.
    Window window_left(int thickness) const {
        return {window_.first, window_.last - taken_ - thickness + 1};
    }
    /// Why no seam is left, at full size; nothing: there is one.
    std::optional<NoSeam> blocked(const EnergyVolume& energy, Window left) const {
        auto out = blocked_seam(energy, left, found());
        if (out && full_) out = at_full_size(*out, found(), energy, *full_);
        return out;
    }
    Columns full_columns() const {
        const auto& of = full_->columns;
        return static_ ? Columns(static_cast<int>(of.laterals()), static_cast<int>(of.slices()), 1,
                                 of.ring(1), of.ring(0))
                       : of;
    }
    std::size_t columns() const {
        return full_ ? full_columns().count()
                     : volume_.columns_per_frame() * (static_ ? 1 : volume_.frames());
    }
    std::size_t all_frames() const { return full_ ? full_->columns.frames() : volume_.frames(); }

    /// Records the statistics of a found seam, for all seams that it stands for.
    void count_met(const EnergyVolume& energy, std::span<const std::uint16_t> at) {
        const auto met = energy.met(at);
        for (int n = 0; n < std::min(each(), count_ - static_cast<int>(out_.zero_share.size()));
             ++n) {
            out_.zero_share.push_back(static_cast<double>(met.zeros) /
                                      static_cast<double>(at.size()));
            out_.attracted.push_back(met.attracted);
            out_.blocked.push_back(met.blocked);
            out_.attracted_left.push_back(energy.attracted() - met.attracted);
        }
    }

    /// Deletes a seam from the volume, or records that it is doubled. The last one is not taken:
    /// no search follows it.
    void take(std::span<const std::uint16_t> at, int thickness, Window left) {
        const int number = searches_++;
        if (static_cast<int>(out_.zero_share.size()) >= count_) return;
        if (slabs_) {
            slabs_->take(at, thickness);
            // Doubled slabs stay in the volume.
            if (inserts()) return;
        } else {
            if (options_.bounds) options_.bounds->follow(energy(), left, at, number);
            (sum_ ? *sum_ : volume_).remove(at, left);
        }
        taken_ += thickness;
    }

    /// Adds a found seam to the set, as the seams that it stands for.
    void add(Seams::Seam seam, int thickness, double seconds) {
        if (full_) {
            auto shape = volume_.shape();
            if (static_) shape.frames = 1;
            const Columns here(shape);
            const double share = static_cast<double>(columns()) / static_cast<double>(here.count());
            const int most =
                width_ - (inserts() && slabs_ ? 1 : found()) - (slabs_ ? 2 * thickness : 1);
            seam.at = prolong_seam(here, seam.at, full_columns(), {0, most});
            seam.energy *= share;
            if (seam.lower_bound) *seam.lower_bound *= share;
        }
        if (slabs_) {
            seam.energy /= each();
            if (seam.lower_bound) *seam.lower_bound /= each();
        }
        complete(seam, 0, seconds);
    }

    /// Adds the seams that a found seam stands for, from the n-th on.
    void complete(const Seams::Seam& seam, int n, double seconds) {
        const int some = std::min(each(), n + count_ - found());
        for (const int first = n; n < some; ++n) {
            auto one = seam;
            if (deleted_) deleted_->to_original(one.at.all());
            // The vertices of a slab that is doubled follow each other.
            if (slabs_ && inserts())
                for (auto& entry : one.at.all()) entry = static_cast<std::uint16_t>(entry + n);
            if (static_) one.at = SeamEntries::repeated(one.at, all_frames());
            if (options_.keep) one.at = options_.keep(std::move(one.at));
            out_.seams.push_back(std::move(one));
            out_.wall_s.push_back(seconds / (some - first));
        }
    }

    /// Takes the seams that an earlier search found. Of a slab, it may have left the last ones to
    /// find.
    void take_known(const Tick& tick) {
        std::vector<std::uint16_t> last;
        const auto& before = options_.before;
        for (std::size_t n = 0; n < before.size(); n += static_cast<std::size_t>(each())) {
            tick(0);
            last.assign(before[n].at.begin(),
                        before[n].at.begin() + static_cast<std::ptrdiff_t>(columns()));
            if (deleted_) deleted_->from_original(last);
            const int thickness = thickness_now();
            if (slabs_) slabs_->price(thickness);
            count_met(energy(), last);
            const auto left = window_left(thickness);
            take(last, thickness, left);
            const auto end = std::min(before.size(), n + static_cast<std::size_t>(each()));
            for (auto m = n; m < end; ++m) {
                out_.seams.push_back(before[m]);
                out_.wall_s.push_back(0);
            }
            if (const int known = static_cast<int>(end - n); known < each()) {
                auto seam = before[n];
                seam.at = last;
                complete(seam, known, 0);
            }
        }
        if (!last.empty() && options_.start_from) options_.start_from(last);
    }

    EnergyVolume& volume_;
    const Seams::Kind kind_;
    const int count_;
    Window window_;
    const bool static_;
    const SearchOptions& options_;
    const std::optional<FullSize>& full_;
    const int width_;
    int thickness_;
    std::optional<SlabSearch> slabs_;        ///< if seams are thick
    std::optional<EnergyVolume> sum_;        ///< of all frames, for static thin seams
    std::optional<DeletedEntries> deleted_;  ///< of thin seams that are doubled
    int searches_ = 0;                       ///< seams or slabs that are known
    int taken_ = 0;                          ///< entries that they took from the window
    FoundSeams out_;
};

}  // namespace

FoundSeams find_seams(EnergyVolume& volume, const SeamPart& part, int count, const FindSeam& find,
                      const Tick& tick, const SearchOptions& options) {
    return SeamsInTurn(volume, part, count, options).run(find, tick);
}

}  // namespace fluidcarve
