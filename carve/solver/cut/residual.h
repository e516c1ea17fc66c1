#pragma once

#include "carve/solver/search/columns.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace fluidcarve {

/// The graph of a cut (see cut.h): its nodes, and the residual capacities of their arcs.
struct Residual {
    /// A node's distance to the sink, in arcs.
    using Label = std::uint32_t;
    /// No way to the sink.
    static constexpr Label far = 0xFFFFFF;
    /// Capacity of an arc that cannot be cut.
    static constexpr std::int32_t endless = 0x7FFFFFFF;

    /// A node's excess, and the residual capacities of its arcs, except arcs of unlimited
    /// capacity.
    struct Arcs {
        using Packed __attribute__((aligned(4))) = std::int64_t;  // 36 bytes in all, not 40
        Packed excess;                                            ///< flow in minus flow out
        std::int32_t up;                            ///< to the next node of the column
        std::int32_t lowered[Columns::directions];  ///< flow that went to the next lower node of
                                                    ///< each neighbour
    };
    struct Column {
        std::uint32_t begin;  ///< its first node, the one below entry first + 1
        std::uint16_t first, last;
        int size() const { return last - first; }
    };
    /// A node, given by its column and the entry above it.
    struct Spot {
        std::uint32_t column;
        std::uint16_t entry;
    };
    /// All that a search reads of a node: an estimate of its distance to the sink, and which of
    /// its capacities and excess are not 0.
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
        void set(std::size_t bit, bool is) {
            bits_ = (bits_ & ~(1u << bit)) | static_cast<std::uint32_t>(is) << bit;
        }
        std::uint32_t bits_ = far << 8;
    };

    static constexpr std::uint32_t none = ~std::uint32_t{0};
    /// The node below an entry; none if the column has no such node.
    static std::uint32_t node(const Column& column, int entry) {
        return entry > column.first && entry <= column.last
                   ? column.begin + static_cast<std::uint32_t>(entry - column.first - 1)
                   : none;
    }

    const Columns layout;
    std::vector<Column> columns{};
    std::vector<std::uint16_t> sides{};  ///< `[column]`: which neighbours it has in its region
    std::vector<Tag> tags{};
    std::vector<Arcs> arcs{};
    /// Residual capacities to the neighbours' nodes at the same height; empty if steps are free.
    std::vector<std::array<std::int32_t, Columns::directions>> level{};
};

}  // namespace fluidcarve
