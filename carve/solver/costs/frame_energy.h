#pragma once

#include "carve/base/values.h"
#include "carve/field/missed_range.h"
#include "carve/lattice/lattice.h"
#include "carve/solver/costs/content.h"
#include "carve/solver/costs/sample.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fluidcarve {

/// Everything that a solver needs of one frame.
struct FrameEnergy {
    Ref<Lattice> lattice;
    int finest = 1;                     ///< 2: energy and field are at half size (MeanEnergy)
    std::vector<std::uint16_t> energy;  ///< energy codes at the lattice's vertices, marks included;
                                        ///< laid out as by sample_columns()
    std::vector<std::uint16_t> field;   ///< field codes, laid out the same way; empty: no field
    /// Number of vertices that each mask marks; nothing: no mask.
    std::optional<std::size_t> protect, attract;
    /// Why a mask is empty, if known.
    std::optional<MissedRange> protect_missed, attract_missed;
    openvdb::math::Transform::ConstPtr transform;        ///< of the energy's grid
    openvdb::math::Transform::ConstPtr field_transform;  ///< of the field's; null: no field
    /// World box of the energy's active voxels; nothing: none.
    std::optional<openvdb::BBoxd> active;
    Content content;  ///< of the energy: how much of it lies in the lattice
    /// width_in() of the content to which percentages refer; nothing: they refer to the lattice's
    /// vertices.
    std::optional<int> width;
};

/// The grids of one frame from which a solver's energy is made; null: not connected.
struct FrameGrids {
    const openvdb::FloatGrid& energy;
    const openvdb::FloatGrid* field = nullptr;
    const openvdb::GridBase *protect = nullptr, *attract = nullptr;
};

/// Checks that the codes of one frame fit in memory, before they are allocated.
/// @param budget  as in grid_fits
/// @param finest  1 or 2
/// @throws Failure naming the vertices, their memory, the voxels of the energy and a spacing that
///   fits
void require_frame_fits(const FrameGrids& grids, const Lattice& lattice, std::uint64_t budget,
                        int finest = 1);

/// Samples grids at the vertices of a lattice, in columns along sampled_axis().
/// @param finest  1, or 2 for half the size: then only single columns are held at full size
/// @throws Failure as sample_columns() and MaskColumns
FrameEnergy sample_frame(const FrameGrids& grids, const Ref<Lattice>& lattice, Axis axis,
                         Measure measure, int finest = 1);

}  // namespace fluidcarve
