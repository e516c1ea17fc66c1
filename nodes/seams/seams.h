#pragma once

#include "nodes/lattice/lattice.h"
#include "nodes/seams/anchor.h"
#include "nodes/seams/seam_entries.h"
#include "nodes/seams/window.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// Seams through one lattice over a sequence, in the order in which they were found.
/// For the carved axis a seam holds one entry per column; a column is `(lateral, k, t)`, lateral = j for u, i for v.
struct Seams {
    enum class Kind { remove, insert };
    struct Seam {
        /// `remove`: index in the space as it is when this seam is carved; `insert`: the original index that is doubled.
        /// Size columns_per_frame() * frames, lateral fastest, then k, then t.
        SeamEntries at;
        double energy = 0;                                 ///< sum over all columns, in the units of the energy
        std::optional<double> lower_bound = std::nullopt;  ///< what no seam there could be below, if it was asked for
    };

    Axis axis = Axis::u;
    Kind kind = Kind::remove;
    bool closed = false;                        ///< the lattice's last plane is followed by its first
    std::array<int, 3> shape{};                 ///< I, J, K before these seams
    std::vector<int> frames;                    ///< frame numbers; a frame's `t` is its place here
    std::string lattice;                        ///< description of the lattice
    std::string lattice_hash;                   ///< one for all frames; of a lattice that changes one per frame, separated by commas
    std::optional<Window> window, pair_window;  ///< vertices that seams may take; nothing: all, of pairs as far as they reach
    Anchor anchor;
    std::vector<Seam> seams;
    /// Empty, or the other seam of each pair (paper 3.6): of the opposite kind, all on the positive side of all `seams`.
    /// Entries count no seam of the other window.
    std::vector<Seam> pairs;

    int carved() const { return shape[static_cast<std::size_t>(axis)]; }  ///< vertices along the carved axis
    int lateral() const { return shape[axis == Axis::u ? 1 : 0]; }
    std::size_t columns_per_frame() const { return static_cast<std::size_t>(lateral()) * static_cast<std::size_t>(shape[2]); }
    bool paired() const { return !pairs.empty(); }
    /// @param t  a frame's place
    std::string lattice_hash_at(std::size_t t) const;
    /// The shape that the first `count` of these seams leave; pairs leave it as it is.
    std::array<int, 3> shape_after(std::size_t count) const;
    /// Where the carved space begins once the first `count` of these seams are carved, in vertices from where it began before, so that the
    /// anchor stays in place: 0 to `count` if they are removed, -`count` to 0 if they are inserted, 0 for pairs.
    int shift_after(std::size_t count) const;
    /// For Anchor::At::vertex: shift_after() of every count from 0 on. Set by find_shifts().
    std::vector<int> shifts;
    /// To be called when seams and anchor are set.
    void find_shifts();
};

/// What the other seam of a pair does.
constexpr Seams::Kind opposite(Seams::Kind kind) { return kind == Seams::Kind::remove ? Seams::Kind::insert : Seams::Kind::remove; }

/// "u" or "v".
std::string to_text(Axis axis);
/// "low", "middle", "high", or the vertex.
std::string to_text(const Anchor& anchor);
/// "remove" or "insert".
std::string to_text(Seams::Kind kind);

/// Turns one column's removals, each an index in the space that its predecessors leave, into original indices.
/// @param entries   in the order of the seams; becomes their original indices, in the same order
/// @param scratch   becomes the original indices in rising order
void to_original(std::span<std::uint16_t> entries, std::vector<std::uint16_t>& scratch);

}  // namespace fluidcarve
