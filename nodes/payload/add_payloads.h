#pragma once

#include "graph/types/registry.h"

namespace fluidcarve {

// Registration of the payload types that go from node to node.

/// `float`, `vector`, `mask`, `grid` and `volume`, and their conversions: each grid type to `grid`
/// and to a volume with one grid.
void add_grid_payloads(Registry& registry);
/// `points`, and its conversion to a volume with one point grid.
void add_points_payload(Registry& registry);
/// `mesh`.
void add_mesh_payload(Registry& registry);
/// `rig`.
void add_rig_payload(Registry& registry);
/// `lattice` and `active_box`. A fitted lattice keeps one active box per frame.
void add_lattice_payloads(Registry& registry);
/// `frame_energy`. Register `lattice` before.
void add_frame_energy_payload(Registry& registry);
/// `seams`.
void add_seams_payload(Registry& registry);
/// `ranges`.
void add_ranges_payload(Registry& registry);

}  // namespace fluidcarve
