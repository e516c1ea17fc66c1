#include "nodes/payload/add_payloads.h"

#include "carve/lattice/lattice.h"
#include "carve/stream/binary.h"
#include "nodes/payload/active_box.h"

namespace fluidcarve {
namespace {

void write_lattice(const Lattice& lattice, std::ostream& to) {
    BinaryWriter out(to);
    out.value(lattice.shape);
    out.value(lattice.spacing);
    out.value(lattice.closed);
    out.value(lattice.around);
    out.value(lattice.closed_form);
    out.list(lattice.planes);
    out.text(lattice.description);
    out.text(lattice.hash);
}

Ref<Lattice> read_lattice(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Lattice>();
    out->shape = in.value<std::array<int, 3>>();
    out->spacing = in.value<double>();
    out->closed = in.value<bool>();
    out->around = in.value<bool>();
    out->closed_form = in.value<bool>();
    out->planes = in.list<Lattice::Plane>();
    for (const int size : out->shape) in.require(size >= 1 && size <= most_vertices);
    in.require(out->planes.size() == static_cast<std::size_t>(out->shape[2]));
    out->description = in.text();
    out->hash = in.text();
    return out;
}

}  // namespace

void add_lattice_payloads(Registry& registry) {
    registry.add(payload_type<Lattice>(
        "lattice", "Vertices along a rig: the space that is carved.",
        [](const Lattice& lattice) { return lattice.planes.size() * sizeof(Lattice::Plane); },
        {3, &write_lattice, &read_lattice}));
    registry.add(active_box_type());
}

}  // namespace fluidcarve
