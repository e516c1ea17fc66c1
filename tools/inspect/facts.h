#pragma once

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include <span>
#include <string>

namespace fluidcarve {

// What all file inspectors share: how facts are stored as JSON, and told.

/// `[x, y, z]`.
nlohmann::ordered_json facts_of(const openvdb::Vec3d& at);
/// `[[x, y, z], [x, y, z]]`: the lowest and the highest corner.
nlohmann::ordered_json facts_of(const openvdb::BBoxd& box);
/// The box around points; null if there are none.
nlohmann::ordered_json box_around(std::span<const openvdb::Vec3d> points);

/// A whole number, or "least to greatest" of a sequence.
std::string count_text(const nlohmann::ordered_json& count);
/// Three numbers: "[-1, -1, -1]".
std::string vector_text(const nlohmann::ordered_json& vector);
/// A box in world units: "[-1, -1, -1] to [1, 1, 1]".
std::string world_text(const nlohmann::ordered_json& box);
/// A range of values: "0 to 1".
std::string range_text(const nlohmann::ordered_json& range);

}  // namespace fluidcarve
