#pragma once

#include "carve/lattice/lattice.h"
#include "carve/seam/window.h"

#include <openvdb/openvdb.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>

namespace fluidcarve {

/// How much a vertex counts.
enum class Measure {
    vertex,  ///< as much as any other
    volume,  ///< as much as the volume nearest to it, in cubes of the lattice's spacing
};

/// Samples columns of a grid at the vertices of a lattice, as codes. One thread uses it at a time.
class ColumnSampler {
public:
    virtual ~ColumnSampler() = default;

    struct Sampled {
        Window content;     ///< entries outside of which all codes are 0; empty: 0 to -1
        bool valid = true;  ///< whether all values have a code
    };
    /// Samples the column `(lateral, k)`.
    /// @param codes  one for each entry
    virtual Sampled operator()(int lateral, int k, std::span<std::uint16_t> codes) = 0;
    /// Reports a column in which a value has no code.
    /// @throws Failure naming the place of the first such value
    virtual void report(int lateral, int k) = 0;
};
using MakeSampler = std::function<std::unique_ptr<ColumnSampler>()>;

/// Samples one frame's energy at the vertices of a lattice (METHOD 1, `E(i,j,k)`), as energy codes.
/// A vertex on a voxel centre (within 1e-5 voxels) takes the voxel's value; elsewhere the grid is
/// sampled trilinearly. Inactive voxels count as well. By volume, energies are multiplied by |det
/// Dg| / spacing^3 (METHOD 7 "Measure"), which is 1 in straight boxes. Where this factor exceeds 1,
/// the energy is the mean of that many samples across the planes. Negative, infinite, too large and
/// undefined energies have no code.
/// @return makes a sampler for a thread; grid and lattice must outlive it
MakeSampler energy_sampler(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis,
                           Measure measure);
/// The same for a field, as field codes, with Measure::vertex.
MakeSampler field_sampler(const openvdb::FloatGrid& field, const Lattice& lattice, Axis axis);

/// Samples all columns of a lattice. Each is contiguous along the carved axis; column `(lateral,
/// k)` has the index `lateral + laterals * k`.
/// @param codes  one for each vertex
/// @throws Failure naming the place of the first value that has no code
void sample_columns(const MakeSampler& make, const Lattice& lattice, Axis axis,
                    std::span<std::uint16_t> codes);
inline void sample_energy(const openvdb::FloatGrid& energy, const Lattice& lattice, Axis axis,
                          std::span<std::uint16_t> codes, Measure measure = Measure::vertex) {
    sample_columns(energy_sampler(energy, lattice, axis, measure), lattice, axis, codes);
}

/// Finds the first column of a lattice in which a value has no code, for any order of threads.
class FirstInvalid {
public:
    void meet(std::size_t column) {
        auto first = first_.load(std::memory_order_relaxed);
        while (column < first && !first_.compare_exchange_weak(first, column)) {}
    }
    /// @param laterals  of the lattice
    /// @throws Failure naming the place of its first such value, if one was met
    void require_none(const MakeSampler& make, int laterals) const;

private:
    static constexpr auto none = std::numeric_limits<std::size_t>::max();
    std::atomic<std::size_t> first_ = none;
};

}  // namespace fluidcarve
