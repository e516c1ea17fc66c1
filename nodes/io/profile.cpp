#include "nodes/io/profile.h"

#include "nodes/io/triplet.h"

#include <algorithm>

namespace fluidcarve {
namespace {

bool has_or_triplet(const VdbHeader& header, const std::string& name) {
    const auto parts = triplet_names(name);
    return header.find(name) || std::all_of(parts.begin(), parts.end(), [&](const auto& part) { return header.find(part).has_value(); });
}

/// Whether a file has grid names or metadata that only this application writes.
bool bears_marks(const VdbHeader& header, std::string_view profile) {
    const auto creator = header.metadata["creator"] ? header.metadata["creator"]->str() : std::string();
    const auto any = [&](std::initializer_list<const char*> names) {
        return std::any_of(names.begin(), names.end(), [&](const char* name) { return has_or_triplet(header, name); });
    };
    if (profile == "blender") return any({"shadow", "particles"}) && any({"velocity", "density"});
    const bool embergen = creator.find("EmberGen") != std::string::npos || any({"flames"});
    if (profile == "embergen") return embergen;
    if (profile == "houdini") return !embergen && (creator.find("Houdini") != std::string::npos || any({"vel", "heat"}));
    return any({"voxel_fog_density", "voxel_velocity", "voxel_signed_distance"});
}

}  // namespace

std::span<const Profile> profiles() {
    static const std::vector<Profile> all{
        {"blender",
         "Blender",
         {{"density", {"density"}}, {"temperature", {"temperature"}}, {"flame", {"flame"}}, {"velocity", {"velocity"}}},
         true,
         "tenths of a voxel per frame, roughly",
         true},
        {"houdini",
         "Houdini",
         {{"density", {"density"}}, {"temperature", {"temperature", "heat"}}, {"flame", {"flame"}}, {"velocity", {"vel"}}, {"surface", {"surface"}}},
         false,
         "world units per second"},
        {"embergen",
         "EmberGen",
         {{"density", {"density"}}, {"temperature", {"temperature"}}, {"flame", {"flames", "flame"}}, {"velocity", {"velocity", "vel"}}},
         false,
         "world units per second"},
        {"bifrost",
         "Bifrost",
         {{"density", {"voxel_fog_density"}}, {"temperature", {"voxel_temperature"}}, {"velocity", {"voxel_velocity"}}, {"surface", {"voxel_signed_distance"}}},
         false,
         "world units per second"},
    };
    return all;
}

const Profile* profile(std::string_view name) {
    const auto all = profiles();
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == name; });
    return found == all.end() ? nullptr : &*found;
}

const Profile* detected_profile(const VdbHeader& header) {
    const Profile* out = nullptr;
    for (const auto& each : profiles()) {
        if (!bears_marks(header, each.name)) continue;
        if (out) return nullptr;
        out = &each;
    }
    return out;
}

std::string name_in_file(const VdbHeader& header, const Profile* profile, const std::string& name) {
    if (!profile || has_or_triplet(header, name)) return name;
    for (const auto& alias : profile->grids)
        if (alias.common == name)
            for (const auto inside : alias.inside)
                if (has_or_triplet(header, std::string(inside))) return std::string(inside);
    return name;
}

}  // namespace fluidcarve
