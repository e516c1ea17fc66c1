#pragma once

#include "carve/base/frame_set.h"
#include "formats/file/path_pattern.h"
#include "formats/usd/fields.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A shot as OpenUSD sees it: volumes, and files of meshes and points, through the frames.
struct UsdStage {
    /// What stands in one file, or in one for each frame.
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

/// The frame whose file stands for those of all frames where one must: for which attributes there
/// are. The middle one, since simulations begin and end with nothing.
std::size_t typical_place(std::size_t frames);

/// The text of the stage's .usda file. Volumes are UsdVol's, with a time sample of each field's
/// file for each frame. Meshes and points are references, with the files of the frames as value
/// clips.
/// @param path  of the file; others are named as they lie from there
std::string stage_text(const UsdStage& stage, const std::string& path);

}  // namespace fluidcarve
