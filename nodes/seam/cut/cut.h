#pragma once

#include "nodes/seam/search/band.h"
#include "nodes/seam/search/columns.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fluidcarve {

/// The cheapest seam in a band, as a minimum cut (METHOD 8 "The cut").
///
/// Node (c, a) stands between the entries a-1 and a of column c, and says whether the seam is at a or above. Up a column
/// an arc costs what the entry between its ends does, down it none can be cut; nor can arcs to the next lower node in
/// each neighbouring column, which keep neighbours within 1. Where steps cost something, arcs to the nodes at the same height
/// beside it cost that. None of the arcs is stored: they follow from the place of a node. A node holds what its arcs still let
/// through, its excess and its distance to the sink: 40 bytes, 64 where steps cost something, and 8 for each column.
///
/// The flow is found by push-relabel (Goldberg and Tarjan 1988) in sweeps over the rows of columns, with distances
/// computed anew by breadth-first search (Cherkassky and Goldberg 1997), and without its second phase: excess that can
/// not reach the sink stays where it is. Chosen over augmenting paths, whose trees want as much memory again and do not
/// run in parallel: here blocks of rows do, every second at a time, so that the result does not depend on the number of
/// threads. At any time what can still reach the sink is one side of a cut, dearer than the flow by the excess in it; so a
/// tolerance makes it stop early, with proof.
class Cut {
public:
    /// The cost of a column's entries in the band, 0 to most_cost or endless; written for entries band.first to band.last.
    using CostOf = std::function<void(std::size_t column, Band::Column band, std::int32_t* costs)>;
    /// No seam goes through an entry of this cost if it can go elsewhere. Not for the ends of a column.
    static constexpr std::int32_t endless = 0x7FFFFFFF;
    static constexpr std::int32_t most_cost = 1 << 26;

    /// What steps cost, 0 to most_cost: being at entry + 1 in column `high` and at entry in its neighbour `low`; written for
    /// entries from `first` on.
    using LiftsOf = std::function<void(std::size_t high, std::size_t low, bool in_time, int first, std::span<std::int32_t> lifts)>;

    /// @param lifts_of  none: steps are free
    /// @param reversed  of equal seams the lowest is found, not the highest
    Cut(const Columns& columns, const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of = nullptr, bool reversed = false);

    /// @param tolerance  how much the seam may cost above the least, as a share of the flow
    /// @return false if more flow came together than an arc holds, 31 bits: then there is no seam, and lower costs are wanted
    [[nodiscard]] bool solve(double tolerance, const std::function<void()>& tick);

    /// Entry per column; feasible.
    std::vector<std::uint16_t> seam() const;
    /// What any seam in the band costs at least.
    std::int64_t flow() const { return flow_; }
    /// What the seam costs.
    std::int64_t cost() const { return flow_ + left_; }
    std::size_t nodes() const { return tags_.size(); }

private:
    using Label = std::uint32_t;
    static constexpr Label far = 0xFFFFFF;

    /// What arcs of a node let through, but those that let everything through.
    struct Arcs {
        std::int32_t up;                            ///< to the next node of the column
        std::int32_t lowered[Columns::directions];  ///< flow that went to the next lower node of each neighbour
    };
    struct Column {
        std::uint32_t begin;  ///< its first node, that of entry first + 1
        std::uint16_t first, last;
        int size() const { return last - first; }
    };
    struct Spot {
        std::uint32_t column;
        std::uint16_t entry;
    };
    /// All that a search has to know of a node: its distance to the sink in arcs, at most, and which of its figures are
    /// not 0.
    class Tag {
    public:
        Label label() const { return bits_ >> 8; }
        void set_label(Label label) { bits_ = label << 8 | (bits_ & 0xFF); }
        bool lowered(std::size_t direction) const { return bits_ >> direction & 1; }
        bool up() const { return bits_ >> 6 & 1; }
        bool excess() const { return bits_ >> 7 & 1; }
        void set_lowered(std::size_t direction, bool is) { set(direction, is); }
        void set_up(bool is) { set(6, is); }
        void set_excess(bool is) { set(7, is); }

    private:
        void set(std::size_t bit, bool is) { bits_ = (bits_ & ~(1u << bit)) | static_cast<std::uint32_t>(is) << bit; }
        std::uint32_t bits_ = far << 8;
    };
    /// A part of the columns: `low` to below `high` along lateral, k and t.
    struct Box {
        std::array<std::size_t, 3> low, high;
    };
    class Region;

    static constexpr std::uint32_t none = ~std::uint32_t{0};
    /// The node below an entry.
    static std::uint32_t node(const Column& column, int entry) {
        return entry > column.first && entry <= column.last ? column.begin + static_cast<std::uint32_t>(entry - column.first - 1) : none;
    }
    void fill(const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of);
    void add_lifts(std::size_t column, const LiftsOf& lifts_of, std::vector<std::int32_t>& costs, std::vector<std::int32_t>& lifts);
    void lifts(std::size_t high, std::size_t low, unsigned direction, int first, const LiftsOf& lifts_of, std::span<std::int32_t> out) const;
    std::vector<Box> tiles(std::size_t nodes, bool shifted) const;
    std::vector<Box> slabs() const;
    bool solve_tiles(bool shifted, double tolerance);
    bool solve_whole(double tolerance, const std::function<void()>& tick);

    const Columns columns_;
    const bool reversed_;
    std::vector<Column> column_;
    std::vector<std::uint16_t> sides_;  ///< per column, which neighbours it has in its region
    std::vector<Tag> tags_;
    std::vector<std::int64_t> excess_;
    std::vector<Arcs> arcs_;
    std::vector<std::array<std::int32_t, Columns::directions>> level_;  ///< to the neighbours' nodes at the same height; empty if steps are free
    std::int64_t flow_ = 0, left_ = 0;
};

}  // namespace fluidcarve
