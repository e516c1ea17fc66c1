#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Energies at half size: what `finest: 2` solves (METHOD 9 "Half size").
namespace fluidcarve {

/// Weight of the mean of two entries, against their minimum. A seam takes the cheaper entry where it can, which is mostly possible. Found
/// on real plumes, rings and fires; there 0 and 0.5 led to more expensive seams.
inline constexpr float share_of_mean = 0.15f;

/// Cost of a column's two entries for a seam that can mostly choose between them.
inline float cost_of_pair(float a, float b) { return share_of_mean * 0.5f * (a + b) + (1 - share_of_mean) * std::min(a, b); }

/// Adds the costs of the pairs of a column to those of half its length; an odd last entry is one by itself.
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

/// Entries along the axis, columns beside each other, planes.
using ColumnShape = std::array<std::size_t, 3>;

/// The mean of the fields of some columns, at half their length.
class MeanField {
public:
    /// @param width  entries of a column
    explicit MeanField(std::size_t width) : values_(width), sums_(halved(width)) {}

    /// Adds the field codes of a column.
    void add(std::span<const std::uint16_t> codes);
    /// Takes the mean's codes, and begins anew.
    void end(std::span<std::uint16_t> out);

private:
    std::vector<float> values_, sums_;
    float columns_ = 0;
};

/// Restricts energy codes of one frame to half the size along all three dimensions. A coarse entry gets the mean, over its columns, of
/// cost_of_pair(). It is protected if a vertex is protected in it or in the entries next to it along the axis: so a fine seam that is
/// interpolated from a coarse one passes no protected vertex. Else it is attracted if one of its vertices is.
/// @param codes  laid out as by sample_energy()
/// @param out    as many as the halves of `shape` have
void halve_energy(std::span<const std::uint16_t> codes, const ColumnShape& shape, std::span<std::uint16_t> out);

/// The same for field codes: a coarse entry gets the mean of its vertices.
void halve_field(std::span<const std::uint16_t> codes, const ColumnShape& shape, std::span<std::uint16_t> out);

/// Averages the codes of two frames. A mark in one of them stays; protection has precedence.
/// @param out  codes of one frame, become the mean
void average_energy(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out);
/// The same for field codes.
void average_field(std::span<const std::uint16_t> codes, std::span<std::uint16_t> out);

}  // namespace fluidcarve
