#include "nodes/points/payload_type.h"

#include "nodes/payloads.h"
#include "nodes/points/file.h"

namespace fluidcarve {

void add_points_payload(Registry& registry) {
    registry.add(payload_type<Points>("points", "Points with attributes, in the order of their file.", [](const Points& points) { return points.bytes(); }));
    registry.add(conversion<Points, Volume>([](const Ref<Points>& points) {
        auto out = std::make_shared<Volume>();
        out->grids.push_back(in_grid(*points));
        out->metadata = points->metadata;
        out->codec = points->codec;
        return out;
    }));
}

}  // namespace fluidcarve
