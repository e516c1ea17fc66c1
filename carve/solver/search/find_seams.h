#pragma once

#include "carve/base/failure.h"
#include "carve/seam/seams.h"
#include "carve/seam/window.h"
#include "carve/solver/costs/energy_volume.h"
#include "carve/solver/costs/slab_prices.h"
#include "carve/solver/search/columns.h"
#include "carve/solver/search/find_seam.h"
#include "carve/solver/search/seam_bounds.h"
#include "carve/solver/search/seam_part.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Gives the last seam of an earlier search to a solver that starts from the previous seam.
/// @param last  its entries in the space in which it was found; those of one frame for static seams
using StartFrom = std::function<void(std::span<const std::uint16_t> last)>;

/// Thrown if protected vertices leave no way for the next seam.
struct NoSeam : Failure {
    /// The column that blocks the way: the first one without a free vertex, else the first that
    /// can't be reached.
    struct Bottleneck {
        std::size_t column;  ///< as in Seams::Seam::at; of a single frame for static seams
        int vertices;        ///< number of vertices that earlier seams left in the window
        int free;            ///< how many of these are not protected
    };
    NoSeam(int found, const Bottleneck& at);
    int found;  ///< number of seams found before
    Bottleneck at;
};

/// Found seams, with statistics.
struct FoundSeams {
    std::vector<Seams::Seam> seams;
    std::vector<double> wall_s;      ///< per seam, search time in seconds, without a bound found
                                     ///< afterwards; 0 for seams of an earlier search
    std::vector<double> zero_share;  ///< per seam, share of its columns without energy, 0 to 1
    std::vector<std::size_t> attracted;  ///< per seam, number of attracted vertices taken
    std::vector<std::size_t> blocked;    ///< per seam, number of protected vertices passed
    /// Per seam, number of attracted vertices left after it.
    std::vector<std::size_t> attracted_left;
    /// Why there are fewer than asked for (SearchOptions::best_effort)
    std::optional<NoSeam> no_more = {};
};

/// The full size of an energy that is at half size along all dimensions of more than one vertex,
/// time included.
struct FullSize {
    Columns columns;  ///< of all frames
    int width;        ///< entries per column
};

/// Options of find_seams(): an earlier search to continue, bounds, progress and memory.
struct SearchOptions {
    std::vector<Seams::Seam> before;  ///< the set's first seams, as they were found
    StartFrom start_from;             ///< called with the last of them; null: the solver needs none
    /// Gives a lower bound to each new seam whose solver gives none; null: no bound.
    SeamBounds* bounds = nullptr;
    /// Called with all seams found so far, after each new one.
    std::function<void(const FoundSeams& found)> found;
    /// Moves a found seam to its storage; null: seams stay in memory.
    std::function<SeamEntries(SeamEntries)> keep;
    Limits limits;  ///< of what the search holds besides energies and seams
    /// Set if the energy is at half size; then `before` must be empty
    std::optional<FullSize> full;
    std::optional<Thick> thick;  ///< nothing: each seam takes one entry
    bool best_effort = false;    ///< if protected vertices leave no way for the next seam, return
                                 ///< the seams found instead of throwing NoSeam
};

/// Number of seams that a window has room for. An insertion stands between an entry and the next,
/// so it cannot take the lattice's last entry.
/// @param width   entries per column
/// @param finest  2: at half size, where seams come in pairs that stay in the window
int room_in(Seams::Kind kind, Window window, int width, int finest = 1);

/// Requires that the window has room for `count` seams, at least 0.
/// @param width, finest  as for room_in()
/// @throws Failure that says how many are possible
void require_room(Seams::Kind kind, int count, Window window, int width, int finest);

/// The loop around a solver (METHOD 4 and METHOD 8): finds a seam, deletes it from the energy, and
/// so on. Insertions are found as removals and returned as original entries. A continued search
/// gives the same result as an uninterrupted one. At half size (METHOD 9 "Half size"), each found
/// seam stands for two of full size, side by side: it is interpolated to the columns, and its
/// energy and bound are scaled by their number. The last one may stand for one.
/// If seams are thick, each found slab stands for as many seams as it has vertices
/// (Seams::thickness), and each of these has an equal share of the slab's price as energy. Slabs
/// are found in prices of their own (SlabPrices). Doubled slabs stay in the volume, and keep away
/// from each other.
/// @param volume  is consumed
/// @param count   of seams of full size, including those found before
/// @throws Failure as require_room(); NoSeam
FoundSeams find_seams(EnergyVolume& volume, const SeamPart& part, int count, const FindSeam& find,
                      const Tick& tick, const SearchOptions& options = {});

}  // namespace fluidcarve
