#pragma once

#include "carve/solver/cut/residual.h"
#include "carve/solver/search/band.h"
#include "carve/solver/search/columns.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace fluidcarve {

/// Finds the cheapest seam in a band, as a minimum cut (METHOD 8 "The cut").
///
/// Node (c, a) stands between entries a-1 and a of column c. It says whether the seam is at a or
/// above. An arc up a column costs as much as the entry between its ends. Arcs down a column
/// cannot be cut, nor can arcs to the next lower node in each neighbouring column; the latter keep
/// neighbours within 1. If steps cost something, arcs to the nodes at the same height in
/// neighbouring columns cost that. No arcs are stored: they follow from the place of a node. A
/// node stores the residual capacities of its arcs, its excess and its distance to the sink: 40
/// bytes, 64 if steps cost something, and 8 per column.
///
/// The flow is found by push-relabel (Goldberg and Tarjan 1988), in sweeps over the rows of
/// columns. Distances are recomputed by breadth-first search (Cherkassky and Goldberg 1997). The
/// second phase is left out: excess that cannot reach the sink stays where it is. Augmenting paths
/// would need as much memory again for their trees, and do not run in parallel. Push-relabel runs
/// on blocks of rows in parallel, every second block at a time, so that the result does not depend
/// on the number of threads. At any time, the nodes that can still reach the sink are one side of
/// a cut, which costs more than the flow by the excess in it. So a tolerance makes the search stop
/// early, with proof.
class Cut {
public:
    /// Writes the costs of a column's entries band.first to band.last: 0 to most_cost, or endless.
    using CostOf = std::function<void(std::size_t column, Band::Column band, std::int32_t* costs)>;
    /// Cost of an entry that no seam takes if it can go elsewhere. Not for the ends of a column.
    static constexpr std::int32_t endless = Residual::endless;
    static constexpr std::int32_t most_cost = 1 << 26;
    /// Nodes of a tile: they fit into a core's own cache.
    static constexpr std::size_t tile_nodes = 16384;
    /// Largest number of nodes that is solved without tiles.
    static constexpr std::size_t most_untiled = 4 * tile_nodes;

    /// Writes the costs of steps, 0 to most_cost: being at entry + 1 in column `high` and at entry
    /// in its neighbour `low`, for entries from `first` on.
    using LiftsOf = std::function<void(std::size_t high, std::size_t low, bool in_time, int first,
                                       std::span<std::int32_t> lifts)>;

    /// @param lifts_of  null: steps are free
    /// @param reversed  of equal seams, true finds the lowest, false the highest
    Cut(const Columns& columns, const Band& band, const CostOf& cost_of,
        const LiftsOf& lifts_of = nullptr, bool reversed = false);

    /// Finds the flow, and with it the seam.
    /// @param tolerance  how much the seam may cost above the least, as a share of the flow
    /// @param check      called often; may throw to stop
    /// @return false if more flow gathered than an arc holds, 31 bits: then there is no seam, and
    ///   lower costs are needed
    [[nodiscard]] bool solve(double tolerance, const std::function<void()>& check);

    /// The seam: an entry per column; feasible.
    std::vector<std::uint16_t> seam() const;
    /// Lower bound on the cost of any seam in the band, in the units of CostOf.
    std::int64_t flow() const { return flow_; }
    /// Cost of the seam, in the units of CostOf.
    std::int64_t cost() const { return flow_ + left_; }
    std::size_t nodes() const { return graph_.tags.size(); }

private:
    void fill(const Band& band, const CostOf& cost_of, const LiftsOf& lifts_of);
    void add_lifts(std::size_t column, const LiftsOf& lifts_of, std::vector<std::int32_t>& costs,
                   std::vector<std::int32_t>& lifts);
    void lifts(std::size_t high, std::size_t low, unsigned direction, int first,
               const LiftsOf& lifts_of, std::span<std::int32_t> out) const;
    std::vector<ColumnBox> tiles(std::size_t nodes, bool shifted) const;
    std::vector<ColumnBox> layers() const;
    bool solve_tiles(bool shifted, double tolerance);
    bool solve_whole(double tolerance, const std::function<void()>& check);

    const bool reversed_;
    Residual graph_;
    std::int64_t flow_ = 0, left_ = 0;
};

}  // namespace fluidcarve
