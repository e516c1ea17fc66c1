#include "carve/stream/mesh_stream.h"

#include "carve/stream/binary.h"

#include <memory>

namespace fluidcarve {
namespace {

void write_stored_form(const Mesh::StoredForm& stored, BinaryWriter& out) {
    out.text(stored.format);
    out.value(stored.binary);
    out.value(stored.big_endian);
    out.value(stored.number);
    out.value(std::uint64_t{stored.lines.size()});
    for (const auto& line : stored.lines) {
        out.value(std::uint64_t{line.face});
        out.text(line.text);
    }
    out.value(std::uint64_t{stored.head});
    out.value(stored.placement);
    out.list(stored.in_file);
}

Mesh::StoredForm read_stored_form(BinaryReader& in) {
    Mesh::StoredForm out;
    out.format = in.text();
    out.binary = in.value<bool>();
    out.big_endian = in.value<bool>();
    out.number = in.value_up_to(Mesh::Attribute::Type::float64);
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
        const auto face = in.value<std::uint64_t>();
        out.lines.push_back({face, in.text()});
    }
    out.head = in.value<std::uint64_t>();
    out.placement = in.value<Placement>();
    out.in_file = in.list<openvdb::Vec3d>();
    return out;
}

}  // namespace

std::uint64_t Stored<Mesh>::bytes(const Mesh& mesh) {
    auto out = mesh.points.size() * sizeof(openvdb::Vec3d) +
               mesh.corners.size() * sizeof(std::uint32_t) + mesh.ends.size() * sizeof(std::size_t);
    for (const auto& attribute : mesh.attributes)
        out +=
            attribute.values.size() * sizeof(double) + attribute.at.size() * sizeof(std::uint32_t);
    return out;
}

void Stored<Mesh>::write(const Mesh& mesh, std::ostream& to) {
    BinaryWriter out(to);
    out.list(mesh.points);
    out.list(mesh.corners);
    out.list(mesh.ends);
    out.value(std::uint64_t{mesh.attributes.size()});
    for (const auto& attribute : mesh.attributes) {
        out.text(attribute.name);
        out.value(attribute.on);
        out.list(attribute.parts);
        out.value(attribute.type);
        out.list(attribute.values);
        out.list(attribute.at);
    }
    out.value(mesh.stored != nullptr);
    if (mesh.stored) write_stored_form(*mesh.stored, out);
}

Ref<Mesh> Stored<Mesh>::read(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Mesh>();
    out->points = in.list<openvdb::Vec3d>();
    out->corners = in.list<std::uint32_t>();
    out->ends = in.list<std::size_t>();
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
        auto& attribute = out->attributes.emplace_back();
        attribute.name = in.text();
        attribute.on = in.value_up_to(Mesh::Attribute::On::corners);
        attribute.parts = in.texts();
        attribute.type = in.value_up_to(Mesh::Attribute::Type::float64);
        attribute.values = in.list<double>();
        attribute.at = in.list<std::uint32_t>();
    }
    if (in.value<bool>()) out->stored = std::make_shared<Mesh::StoredForm>(read_stored_form(in));
    return out;
}

}  // namespace fluidcarve
