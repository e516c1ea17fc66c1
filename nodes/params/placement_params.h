#pragma once

#include "carve/volume/stored_form.h"
#include "graph/types/param.h"

#include <optional>

namespace fluidcarve {

/// The parameter `scale` of readers, and of writers, which undo it.
inline constexpr auto placed_scale_doc =
    "World units of the shot per unit of the file, applied before `translate`.";
inline constexpr auto undone_scale_doc = "The same for a reader's `scale`.";

/// The placement that a reader's parameters `translate` and `scale` state.
template <class Params>
Placement placement_of(const Params& params) {
    return {openvdb::Vec3d(params.translate.data()), params.scale};
}

/// The placement that a writer's parameters `translate` and `scale` state; nothing: neither is
/// stated.
template <class Params>
std::optional<Placement> stated_placement(const Params& params) {
    if (!params.translate && !params.scale) return std::nullopt;
    return Placement{openvdb::Vec3d(params.translate.value_or(Vec3{}).data()),
                     params.scale.value_or(1)};
}

}  // namespace fluidcarve
