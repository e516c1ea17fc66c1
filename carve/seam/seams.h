#pragma once

#include "carve/lattice/lattice.h"
#include "carve/seam/anchor.h"
#include "carve/seam/seam_entries.h"
#include "carve/seam/warp.h"
#include "carve/seam/window.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// Seams through one lattice over a sequence, in the order in which they were found. A seam holds
/// one entry per column, an index along the carved axis. A column is `(lateral, slice, layer)`:
/// `(j, k, t)` if u is carved, `(i, k, t)` for v, `(i, j, t)` for w. Seams of frames have the
/// columns `(j, k, i)`, and their entries are indices into `frames`. A warp may stand in place of
/// the seams.
struct Seams {
    enum class Kind { remove, insert };
    struct Seam {
        /// Entries `[column]`, lateral fastest, then slice, then layer; columns() of them.
        /// `remove`: index in the space that this seam is carved from. `insert`: original index of
        /// the entry that is doubled.
        SeamEntries at;
        double energy = 0;  ///< sum over all columns, in the units of the energy
        /// Lower bound on the energy of any seam that could be taken instead; nothing if not asked
        /// for.
        std::optional<double> lower_bound = std::nullopt;
    };

    Axis axis = Axis::u;
    Kind kind = Kind::remove;
    bool closed = false;  ///< the lattice's last plane is followed by its first
    bool around = false;  ///< the lattice goes around its rig: the last lateral column is followed
                          ///< by the first
    std::array<int, 3> shape{};  ///< I, J, K before these seams are carved
    std::vector<int> frames;     ///< frame numbers; `t` is an index into this
    std::string lattice;         ///< description of the lattice
    std::string lattice_hash;    ///< one for all frames, or, if the lattice changes, one per frame,
                                 ///< separated by commas
    std::optional<Window> window, pair_window;  ///< vertices that seams may take; nothing:
                                                ///< whole_window(); for pairs, the range of their
                                                ///< entries
    std::optional<Window> pair_below;  ///< of a warp: a second pair_window, below the window
    Anchor anchor;
    /// Vertices of a slab (METHOD 8 "Thick seams"); 1: seams are thin. Each group of this many
    /// consecutive seams, of `seams` and of `pairs`, is a slab; the last slab may have fewer. In a
    /// slab, removals have the same entries, and insertions have consecutive entries.
    int thickness = 1;
    std::vector<Seam> seams;
    /// The second seam of each pair (paper 3.6), or empty. They are of the opposite kind, and all
    /// lie above all `seams`. Their entries are counted as if the other window had no seams.
    std::vector<Seam> pairs;
    /// It has warp_vertices() and warp_rings(); find_bounds() and, without a pair window,
    /// anchor_at(anchor) have been called. `kind` does not apply to it.
    std::optional<Warp> warp;

    /// Number of seams; 1 for a warp.
    std::size_t size() const { return warp ? 1 : seams.size(); }
    bool in_time() const { return axis == Axis::t; }  ///< whether they are seams of frames
    /// Vertices along the axis before the carve; for seams of frames, the number of frames.
    int before() const {
        return in_time() ? static_cast<int>(frames.size()) : shape[dimension(axis)];
    }
    int laterals() const { return shape[lateral_dimension(axis)]; }
    int slices() const { return shape[slice_dimension(axis)]; }
    /// Whether the last slice is followed by the first.
    bool slices_close() const { return closed && axis != Axis::w; }
    /// The vertices that seams may take if no window is stated. Around a rig they leave out the rig
    /// itself, where all columns meet.
    Window whole_window() const { return {around && !in_time() ? 1 : 0, before() - 1}; }
    std::array<int, 3> warp_vertices() const { return {before(), laterals(), slices()}; }
    Warp::Rings warp_rings() const { return {around, slices_close()}; }
    std::size_t columns_per_frame() const {
        return static_cast<std::size_t>(laterals()) * static_cast<std::size_t>(slices());
    }
    /// Number of groups of columns_per_frame() columns in a seam: one per frame; for seams of
    /// frames, one per vertex along u.
    std::size_t layers() const {
        return in_time() ? static_cast<std::size_t>(shape[0]) : frames.size();
    }
    std::size_t columns() const { return columns_per_frame() * layers(); }  ///< of a seam
    bool paired() const { return !pairs.empty(); }
    bool thick() const { return thickness > 1; }
    /// The lattice hash of a frame.
    /// @param t  index of the frame in `frames`
    std::string lattice_hash_at(std::size_t t) const;
    /// The shape I, J, K that the first `count` seams leave. Pairs and seams of frames do not
    /// change it. A warp leaves as many whole vertices as hold all of its content, in all columns
    /// and frames.
    std::array<int, 3> shape_after(std::size_t count) const;
    /// How far the beginning of the space moves when the first `count` seams are carved, so that
    /// the anchor stays in place; vertices along the axis. 0 to `count` for removals, -`count` to 0
    /// for insertions, 0 for pairs; for a warp the least displacement of a first vertex, rounded
    /// down.
    int shift_after(std::size_t count) const;
    /// shift_after() for every count from 0 on, for Anchor::At::vertex. Set by find_shifts().
    std::vector<int> shifts;
    /// Computes `shifts`. Call it once seams and anchor are set.
    void find_shifts();

private:
    /// The entries that the warped content reaches, in the indices of the space before.
    Window warped() const;
};

/// The kind of the seams that a count asks for, by its sign: positive inserts, negative removes. 0
/// counts as a removal.
/// @param count  Count::value or Count::of()
constexpr Seams::Kind kind_asked(double count) {
    return count > 0 ? Seams::Kind::insert : Seams::Kind::remove;
}
/// Vertices by which `count` seams lengthen the axis; below 0 for removals.
constexpr int growth(Seams::Kind kind, int count) {
    return kind == Seams::Kind::remove ? -count : count;
}
/// The kind of the second seam of a pair.
constexpr Seams::Kind opposite(Seams::Kind kind) {
    return kind == Seams::Kind::remove ? Seams::Kind::insert : Seams::Kind::remove;
}

/// "low", "middle", "high", or the vertex.
std::string to_text(const Anchor& anchor);
/// "remove" or "insert".
std::string to_text(Seams::Kind kind);

/// Converts one column's removals from indices in the space that their predecessors leave to
/// original indices.
/// @param entries  in the order of the seams; become original indices, in the same order
/// @param scratch  becomes the original indices, rising
void to_original(std::span<std::uint16_t> entries, std::vector<std::uint16_t>& scratch);

}  // namespace fluidcarve
