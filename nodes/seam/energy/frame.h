#pragma once

#include "graph/types/registry.h"
#include "nodes/lattice/lattice.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace fluidcarve {

/// All that a solver needs of one frame.
struct FrameEnergy {
    Ref<Lattice> lattice;
    std::vector<std::uint16_t> energy;                              ///< codes at the lattice's vertices, marked ones included, laid out as sample_energy does
    std::vector<std::uint16_t> field;                               ///< the same of the field; empty: none
    std::optional<std::size_t> protect, attract;                    ///< how many vertices the masks mark; nothing: no mask
    openvdb::math::Transform::ConstPtr transform, field_transform;  ///< of the grids; null: no field
    std::optional<openvdb::BBoxd> active;                           ///< world box of the energy's active voxels; nothing: none
    bool met = false;                                               ///< whether the lattice meets active voxels
};

/// Registers `frame_energy`; `lattice` comes before it.
void add_frame_energy_payload(Registry& registry);

}  // namespace fluidcarve
