#include "nodes/payload/add_payloads.h"

#include "carve/points/points.h"
#include "carve/stream/points_stream.h"
#include "carve/volume/volume.h"

namespace fluidcarve {

void add_points_payload(Registry& registry) {
    registry.add(payload_type<Points>(
        "points", "Points with attributes, in the order of their file.", &Stored<Points>::bytes,
        {1, &Stored<Points>::write, &Stored<Points>::read}));
    registry.add(conversion<Points, Volume>([](const Ref<Points>& points) {
        auto out = std::make_shared<Volume>();
        out->grids.push_back(in_grid(*points));
        out->metadata = points->metadata;
        out->codec = points->codec;
        return out;
    }));
}

}  // namespace fluidcarve
