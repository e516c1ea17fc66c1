#include "formats/vdb/conventions.h"

#include "carve/base/find_or_null.h"
#include "carve/volume/triplet.h"

#include <algorithm>
#include <span>

namespace fluidcarve {
namespace {

bool has_or_triplet(const VdbHeader& header, const std::string& name) {
    const auto parts = triplet_names(name);
    return header.find(name) || std::ranges::all_of(parts, [&](const auto& part) {
               return header.find(part).has_value();
           });
}

/// Whether a file has grid names or metadata that only this application writes.
bool bears_marks(const VdbHeader& header, std::string_view profile) {
    const auto creator =
        header.metadata["creator"] ? header.metadata["creator"]->str() : std::string();
    const auto any = [&](std::initializer_list<const char*> names) {
        return std::ranges::any_of(names,
                                   [&](const char* name) { return has_or_triplet(header, name); });
    };
    if (profile == "blender") return any({"shadow", "particles"}) && any({"velocity", "density"});
    const bool embergen = creator.find("EmberGen") != std::string::npos || any({"flames"});
    if (profile == "embergen") return embergen;
    if (profile == "houdini")
        return !embergen && (creator.find("Houdini") != std::string::npos || any({"vel", "heat"}));
    return any({"voxel_fog_density", "voxel_velocity", "voxel_signed_distance"});
}

/// The conventions of Blender, Houdini, EmberGen and Bifrost.
std::span<const Conventions> all_conventions() {
    static const std::vector<Conventions> all{
        {"blender",
         "Blender",
         {{"density", {"density"}},
          {"temperature", {"temperature"}},
          {"flame", {"flame"}},
          {"velocity", {"velocity"}}},
         true,
         "tenths of a voxel per frame, roughly",
         true},
        {"houdini",
         "Houdini",
         {{"density", {"density"}},
          {"temperature", {"temperature", "heat"}},
          {"flame", {"flame"}},
          {"velocity", {"vel"}},
          {"surface", {"surface"}}},
         false,
         "world units per second"},
        {"embergen",
         "EmberGen",
         {{"density", {"density"}},
          {"temperature", {"temperature"}},
          {"flame", {"flames", "flame"}},
          {"velocity", {"velocity", "vel"}}},
         false,
         "world units per second"},
        {"bifrost",
         "Bifrost",
         {{"density", {"voxel_fog_density"}},
          {"temperature", {"voxel_temperature"}},
          {"velocity", {"voxel_velocity"}},
          {"surface", {"voxel_signed_distance"}}},
         false,
         "world units per second"},
    };
    return all;
}

}  // namespace

const Conventions* conventions_of(std::string_view name) {
    return find_or_null(all_conventions(), name, &Conventions::name);
}

const Conventions* detected_conventions(const VdbHeader& header) {
    const Conventions* out = nullptr;
    for (const auto& each : all_conventions()) {
        if (!bears_marks(header, each.name)) continue;
        if (out) return nullptr;
        out = &each;
    }
    return out;
}

std::string name_in_file(const VdbHeader& header, const Conventions* conventions,
                         const std::string& name) {
    if (!conventions || has_or_triplet(header, name)) return name;
    for (const auto& alias : conventions->grids)
        if (alias.common == name)
            for (const auto inside : alias.inside)
                if (has_or_triplet(header, std::string(inside))) return std::string(inside);
    return name;
}

}  // namespace fluidcarve
