#include "nodes/seam/payload_types.h"

#include "nodes/seam/seams.h"

namespace fluidcarve {

void add_lattice_payloads(Registry& registry) {
    registry.add(payload_type<Lattice>("lattice", "Vertices along a rig: the space that is carved.",
                                       [](const Lattice& lattice) { return lattice.planes.size() * sizeof(Lattice::Plane); }));
    registry.add(payload_type<Seams>("seams", "Seams through a lattice over all frames, in order.", [](const Seams& seams) {
        return (seams.seams.size() + seams.pairs.size()) * seams.columns_per_frame() * seams.frames.size() * sizeof(std::uint16_t);
    }));
}

}  // namespace fluidcarve
