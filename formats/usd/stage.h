#pragma once

#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"
#include "formats/usd/fields.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A shot for OpenUSD: volumes, and files of meshes and points, over all frames.
struct UsdStage {
    /// The content of one file, or of one file per frame.
    struct Part {
        std::string name;                 ///< of its prim
        PathPattern file;                 ///< .vdb with `fields`, else .usda
        std::optional<UsdFields> fields;  ///< of a volume
    };
    enum class Up { y, z };

    std::vector<int> frames;  ///< sorted, one or more
    double fps = 24;
    Up up = Up::z;
    double metres_per_unit = 1;
    std::vector<Part> parts;
};

/// Index of the frame whose file tells which attributes all frames have: the middle one, since
/// simulations may begin and end empty.
std::size_t typical_place(std::size_t frames);

/// The text of the stage's .usda file. Volumes follow UsdVol, with a time sample of each field's
/// file for each frame. Meshes and points are references, with the frames' files as value clips.
/// @param path  of the file; other files are named relative to it
std::string stage_text(const UsdStage& stage, const std::string& path);

}  // namespace fluidcarve
