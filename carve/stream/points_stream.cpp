#include "carve/stream/points_stream.h"

#include "carve/stream/grid_stream.h"

#include <memory>

namespace fluidcarve {
namespace {

void write_ply_points(const PointTable& points, BinaryWriter& out) {
    out.value(points.encoding);
    out.list(points.comments);
    out.list(points.empty_elements);
    out.value(std::uint64_t{points.columns.size()});
    for (const auto& column : points.columns) {
        out.text(column.name);
        out.text(column.type_name);
        out.value(column.type);
        out.list(column.values);
    }
    out.value(std::uint64_t{points.size});
}

PointTable read_ply_points(BinaryReader& in) {
    PointTable out;
    out.encoding = in.value_up_to(NumberForm::big);
    out.comments = in.texts();
    out.empty_elements = in.texts();
    for (auto left = in.value<std::uint64_t>(); left > 0; --left) {
        auto& column = out.columns.emplace_back();
        column.name = in.text();
        column.type_name = in.text();
        column.type = in.value_up_to(NumberType::float64);
        column.values = in.list<char>();
    }
    out.size = in.value<std::uint64_t>();
    in.require(out.size == 0 || !out.columns.empty());
    for (const auto& column : out.columns) {
        const auto bytes = bytes_of(column.type);
        in.require(column.values.size() % bytes == 0 && column.values.size() / bytes == out.size);
    }
    return out;
}

}  // namespace

std::uint64_t Stored<Points>::bytes(const Points& points) { return points.bytes(); }

void Stored<Points>::write(const Points& points, std::ostream& to) {
    BinaryWriter out(to);
    out.value(points.grid != nullptr);
    if (points.grid) GridWriter(to).write(*points.grid);
    write_metadata(points.metadata, out);
    out.text(points.codec);
    out.value(points.ply != nullptr);
    if (points.ply) write_ply_points(*points.ply, out);
    out.value(points.placement);
}

Ref<Points> Stored<Points>::read(std::istream& from) {
    BinaryReader in(from);
    const auto out = std::make_shared<Points>();
    if (in.value<bool>()) out->grid = GridReader(from).read();
    out->metadata = read_metadata(in);
    out->codec = in.text();
    if (in.value<bool>()) out->ply = std::make_shared<PointTable>(read_ply_points(in));
    out->placement = in.value<Placement>();
    return out;
}

}  // namespace fluidcarve
