#pragma once

#include "graph/text/problem.h"
#include "nodes/seam/energy/volume.h"
#include "nodes/seams/seams.h"
#include "nodes/seams/window.h"

#include <functional>
#include <vector>

namespace fluidcarve {

/// Told a few times a second how far the work has come, 0 to 1, from several threads at once; stops it by throwing.
using Tick = std::function<void(double fraction)>;

/// A solver: one seam inside a window in which there is one, in the energy as it is now, codes or sums, feasible, past all
/// protected vertices, with its energy; that of attracted vertices is 0.
/// @param number  how many seams were found before; ties lean to one side for even numbers, to the other for odd
using FindSeam = std::function<Seams::Seam(const EnergyVolume& energy, Window window, int number, const Tick& tick)>;

/// Where a found seam is kept; none: in memory.
using KeepSeam = std::function<SeamEntries(SeamEntries)>;

struct FoundSeams {
    std::vector<Seams::Seam> seams;
    std::vector<double> wall_s;               ///< per seam; 0 of those that were found before
    std::vector<double> zero_share;           ///< per seam, how much of its columns has no energy, 0 to 1
    std::vector<std::size_t> attracted;       ///< per seam, how many attracted vertices it takes
    std::vector<std::size_t> blocked;         ///< per seam, how many protected vertices it passes
    std::vector<std::size_t> attracted_left;  ///< per seam, how many it and those before leave
};

/// A search that goes on where another ended, and tells how far it has come.
struct Continued {
    std::vector<Seams::Seam> before;  ///< the set's first seams, as they were found
    /// Told of the last of them, for solvers that start from it: its entries in the space in which it was found, of one frame if still.
    std::function<void(std::span<const std::uint16_t> last)> start_from;
    /// Told of all seams that are there, after each that is found.
    std::function<void(const FoundSeams& found)> found;
    /// Bytes that the search may hold beside energies and seams before it moves to files in the folder.
    std::uint64_t memory_budget = ~std::uint64_t{0};
    std::string folder;
};

/// Protected vertices leave no way for the next seam.
struct NoSeam : Failure {
    /// Where a way would have to lead: the first column that has no free vertex, else the first that can't be reached.
    struct Bottleneck {
        std::size_t column;  ///< as in Seams::Seam::at; if still, of a single frame
        int vertices;        ///< that seams before left in the window
        int free;            ///< of those
    };
    NoSeam(int found, const Bottleneck& at);
    int found;  ///< seams before
    Bottleneck at;
};

/// Whether the window has room for `count` seams, at least 0. An insertion stands between an entry and the next: it leaves
/// out the lattice's last.
/// @param width  entries per column
/// @throws Failure that says how many are possible
void require_room(Seams::Kind kind, int count, Window window, int width);

/// The loop around a solver (METHOD 4 and METHOD 8): finds a seam, deletes it from the energy, and so on. Insertions are found
/// as removals and returned as original entries. What is found is the same at once or continued.
/// @param volume  used up
/// @param count   of all seams, those found before included
/// @param window  original entries
/// @param still   each seam is the same in all frames; found in their sum, and the volume stays as it is
/// @throws Failure as require_room; NoSeam
FoundSeams find_seams(EnergyVolume& volume, Seams::Kind kind, int count, Window window, const FindSeam& find, const Tick& tick, const KeepSeam& keep = nullptr,
                      bool still = false, const Continued& continued = {});

}  // namespace fluidcarve
