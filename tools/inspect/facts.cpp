#include "tools/inspect/facts.h"

#include <fmt/format.h>

#include <cstdint>

namespace fluidcarve {

namespace {
using Json = nlohmann::ordered_json;
}  // namespace

Json facts_of(const openvdb::Vec3d& at) { return {at.x(), at.y(), at.z()}; }

Json facts_of(const openvdb::BBoxd& box) { return {facts_of(box.min()), facts_of(box.max())}; }

Json box_around(std::span<const openvdb::Vec3d> points) {
    if (points.empty()) return nullptr;
    openvdb::BBoxd box;
    for (const auto& point : points) box.expand(point);
    return facts_of(box);
}

std::string count_text(const Json& count) {
    if (!count.is_array()) return fmt::format("{}", count.get<std::uint64_t>());
    return fmt::format("{} to {}", count[0].get<std::uint64_t>(), count[1].get<std::uint64_t>());
}

std::string vector_text(const Json& vector) {
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", vector[0].get<double>(), vector[1].get<double>(),
                       vector[2].get<double>());
}

std::string world_text(const Json& box) {
    return fmt::format("{} to {}", vector_text(box[0]), vector_text(box[1]));
}

std::string range_text(const Json& range) {
    if (range[0].is_number_integer())
        return fmt::format("{} to {}", range[0].get<std::int64_t>(), range[1].get<std::int64_t>());
    return fmt::format("{:g} to {:g}", range[0].get<double>(), range[1].get<double>());
}

}  // namespace fluidcarve
