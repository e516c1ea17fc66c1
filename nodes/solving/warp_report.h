#pragma once

#include "carve/seam/seams.h"
#include "carve/solver/task/space.h"
#include "carve/warp/find_warp.h"
#include "nodes/params/warp_params.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>

namespace fluidcarve {

/// The greatest share by which a warp squeezes space.
double steepest(const Warp& warp);

/// The least and the greatest amount of all planes and frames of a set, vertices.
std::pair<double, double> amounts_in(const Seams& set, const WarpAmount& amount);

/// The report of a finished warp.
/// @param amount  the amount of the warp; null: none
nlohmann::ordered_json warp_report(const Seams& set, const WarpParams& params,
                                   const WarpAmount* amount);

/// Says where a warp has too little room.
std::string no_room_text(const NoRoom& none, const WarpParams& params, const Seams& set,
                         const CarvedSpace& space);

}  // namespace fluidcarve
