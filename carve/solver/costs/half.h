#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Energies at half size: what `finest: 2` solves (METHOD 9 "Half size").
namespace fluidcarve {

/// Weight of the mean of two entries, against their minimum. A seam takes the cheaper entry where
/// it can, which is mostly possible. Found on real plumes, rings and fires; there 0 and 0.5 led to
/// more expensive seams.
inline constexpr float share_of_mean = 0.15f;

/// Cost of a column's two entries for a seam that can mostly choose between them.
inline float cost_of_pair(float a, float b) {
    return share_of_mean * 0.5f * (a + b) + (1 - share_of_mean) * std::min(a, b);
}

/// Adds cost_of_pair() of each pair of a column's entries to `sums`; an odd last entry is a pair
/// by itself.
/// @param sums  halved(energies.size())
void add_pairs(std::span<const float> energies, std::span<float> sums);

/// How many coarse entries stand for `size` fine ones, two for each.
constexpr int halved(int size) { return (size + 1) / 2; }
constexpr std::size_t halved(std::size_t size) { return (size + 1) / 2; }

/// The size at which a lattice's energies are gathered.
/// @param shape   I, J, K at full size
/// @param finest  1, or 2 for half the size
inline std::array<int, 3> gathered_shape(std::array<int, 3> shape, int finest) {
    if (finest == 2)
        for (auto& size : shape) size = halved(size);
    return shape;
}

/// The mean of some columns, at half their length. Columns are added one by one. Entries that are
/// 0, at either end, need not be given.
class MeanColumn {
public:
    /// @param width  entries of a column
    explicit MeanColumn(std::size_t width) : values_(width), sums_(halved(width)) {}

protected:
    /// Counts a column, and the coarse entries that it adds to.
    /// @param from  its first entry that is given; even
    /// @param size  number of those entries
    void count(std::size_t from, std::size_t size);
    /// Starts over.
    void reset();

    std::vector<float> values_, sums_;
    std::size_t first_ = 0, end_ = 0;  ///< coarse entries that columns were added to
    float columns_ = 0;
};

/// Energies: a coarse entry gets the mean, over its columns, of cost_of_pair(). It is protected if
/// a vertex is protected in it or in the entries next to it along the axis: so a fine seam that is
/// interpolated from a coarse one passes no protected vertex. Else it is attracted if one of its
/// vertices is.
class MeanEnergy : MeanColumn {
public:
    explicit MeanEnergy(std::size_t width) : MeanColumn(width), marks_(halved(width)) {}

    /// Adds a column.
    /// @param codes  from entry `from` on, which is even, up to the column's end or an even entry;
    ///   all others are 0
    void add(std::span<const std::uint16_t> codes, std::size_t from = 0);
    /// Writes the codes of the mean, and starts over.
    void end(std::span<std::uint16_t> out);

private:
    struct Marks {
        bool guarded = false, attracted = false;
    };
    void read_marks(std::span<const std::uint16_t> codes, std::size_t from);

    std::vector<Marks> marks_;
};

/// Fields: a coarse entry gets the mean of its vertices.
class MeanField : MeanColumn {
public:
    using MeanColumn::MeanColumn;
    /// Adds a column.
    /// @param codes  from entry `from` on; all others are 0
    void add(std::span<const std::uint16_t> codes, std::size_t from = 0);
    /// As MeanEnergy::end().
    void end(std::span<std::uint16_t> out);
};

/// Averages the codes of two frames. A mark in one of them stays; protection has precedence.
/// @param out  codes of one frame, become the mean
void average_energy(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out);
/// The same for field codes.
void average_field(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out);

}  // namespace fluidcarve
