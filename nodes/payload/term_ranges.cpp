#include "nodes/payload/add_payloads.h"

#include "carve/stream/binary.h"
#include "graph/types/registry.h"
#include "nodes/params/term_ranges.h"

namespace fluidcarve {

void add_ranges_payload(Registry& registry) {
    registry.add(payload_type<FrameRanges>(
        "ranges", "The range of each energy in one frame, for `range: auto`.",
        [](const FrameRanges& ranges) { return ranges.each.size() * sizeof(Interval); },
        {1, [](const FrameRanges& ranges, std::ostream& to) { BinaryWriter(to).list(ranges.each); },
         [](std::istream& from) {
             return std::make_shared<FrameRanges>(FrameRanges{BinaryReader(from).list<Interval>()});
         }}));
}

}  // namespace fluidcarve
