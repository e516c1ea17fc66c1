#pragma once

#include "carve/base/failure.h"
#include "carve/seam/seams.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/slab_prices.h"
#include "carve/solver/costs/volume.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/seam_bounds.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A solver: finds one seam in a window that holds at least one. It works on the energy as it is
/// now, codes or sums. The seam is feasible, passes no protected vertex, and comes with its energy,
/// in which attracted vertices count 0. One that searches with the help of bounds takes them as a
/// fifth argument, `SeamBounds*`; null: there are none.
/// @param number  number of seams found before; ties lean to one side for even numbers, to the
///   other for odd
class FindSeam {
public:
    template <class Find>
    requires(!std::is_same_v<std::remove_cvref_t<Find>, FindSeam>) FindSeam(Find find) {
        if constexpr (std::is_invocable_v<Find&, const EnergyVolume&, Window, int, const Tick&,
                                          SeamBounds*>)
            find_ = std::move(find);
        else
            find_ = [find = std::move(find)](const EnergyVolume& energy, Window window, int number,
                                             const Tick& tick, SeamBounds* /*bounds*/) mutable {
                return find(energy, window, number, tick);
            };
    }
    Seams::Seam operator()(const EnergyVolume& energy, Window window, int number, const Tick& tick,
                           SeamBounds* bounds = nullptr) const {
        return find_(energy, window, number, tick, bounds);
    }

private:
    std::function<Seams::Seam(const EnergyVolume& energy, Window window, int number,
                              const Tick& tick, SeamBounds* bounds)>
        find_;
};

/// Moves a found seam to where it is kept; null: seams stay in memory.
using KeepSeam = std::function<SeamEntries(SeamEntries)>;

/// Tells a solver that starts from the seam before of the last one that an earlier search found.
/// @param last  its entries in the space in which it was found; those of one frame for static seams
using StartFrom = std::function<void(std::span<const std::uint16_t> last)>;

/// Thrown if protected vertices leave no way for the next seam.
struct NoSeam : Failure {
    /// The column that blocks the way: the first one without a free vertex, else the first that
    /// can't be reached.
    struct Bottleneck {
        std::size_t column;  ///< as in Seams::Seam::at; of a single frame for static seams
        int vertices;        ///< number of vertices that earlier seams left in the window
        int free;            ///< number of those that are not protected
    };
    NoSeam(int found, const Bottleneck& at);
    int found;  ///< number of seams found before
    Bottleneck at;
};

/// Seams and what each of them meets.
struct FoundSeams {
    std::vector<Seams::Seam> seams;
    std::vector<double> wall_s;  ///< per seam, seconds without those of a bound that is found after
                                 ///< it; 0 for seams that were found before
    std::vector<double> zero_share;      ///< per seam, share of its columns without energy, 0 to 1
    std::vector<std::size_t> attracted;  ///< per seam, number of attracted vertices that it takes
    std::vector<std::size_t> blocked;    ///< per seam, number of protected vertices that it passes
    /// Per seam, number of attracted vertices that are left after it.
    std::vector<std::size_t> attracted_left;
    /// Why there are fewer than asked for (Continued::best_effort)
    std::optional<NoSeam> no_more = {};
};

/// The full size of an energy that is at half size along all dimensions of more than one vertex,
/// time included.
struct FullSize {
    Columns columns;  ///< of all frames
    int width;        ///< entries per column
};

/// Continues an earlier search, and tells how far it has come.
struct Continued {
    std::vector<Seams::Seam> before;  ///< the set's first seams, as they were found
    StartFrom start_from;             ///< called with the last of them; null: the solver needs none
    /// Of each new seam whose solver gives no lower bound; null: they get none.
    SeamBounds* bounds = nullptr;
    /// Called with all seams found so far, after each new one.
    std::function<void(const FoundSeams& found)> found;
    /// Bytes that the search may hold besides energies and seams. Beyond, it uses files in
    /// `folder`.
    std::uint64_t memory_budget = ~std::uint64_t{0};
    std::string folder;
    /// If the energy is at half size; then there may be no seams `before`
    std::optional<FullSize> full;
    std::optional<Thick> thick;  ///< nothing: each seam takes one entry
    bool best_effort = false;    ///< if protected vertices leave no way for the next seam, those
                                 ///< found are the result, and nothing is thrown
};

/// Number of seams that a window has room for. An insertion stands between an entry and the next,
/// so it cannot take the lattice's last entry.
/// @param width   entries per column
/// @param finest  2: at half size, where seams come in pairs that stay in the window
int room_in(Seams::Kind kind, Window window, int width, int finest = 1);

/// Requires that the window has room for `count` seams, at least 0.
/// @param width, finest  as for room_in()
/// @throws Failure that says how many are possible
void require_room(Seams::Kind kind, int count, Window window, int width, int finest = 1);

/// The loop around a solver (METHOD 4 and METHOD 8): finds a seam, deletes it from the energy, and
/// so on. Insertions are found as removals and returned as original entries. A continued search
/// gives the same result as one in one go. At half size (METHOD 9 "Half size"), each seam that is
/// found stands for two of full size, side by side: interpolated to the columns, with as much of
/// its energy and bound as a column has. The last one may stand for one.
/// If seams are thick, each slab that is found stands for as many seams as it has vertices
/// (Seams::thickness), and each of them has its share of the slab's price as energy. A slab is
/// found in prices of its own (SlabPrices). Those that are doubled stay in the volume, and keep
/// away from each other.
/// @param volume  used up
/// @param count   number of all seams of full size, including those found before
/// @param window  original entries at full size
/// @param static_   true: each seam is the same in all frames; it is found in their sum, and the
///   volume stays as it is
/// @throws Failure as require_room(); NoSeam
FoundSeams find_seams(EnergyVolume& volume, Seams::Kind kind, int count, Window window,
                      const FindSeam& find, const Tick& tick, const KeepSeam& keep = nullptr,
                      bool static_ = false, const Continued& continued = {});

}  // namespace fluidcarve
