#pragma once

#include "nodes/preview/canvas.h"
#include "nodes/preview/projection.h"

#include <string>

namespace fluidcarve {

/// What is rendered of one volume. Either grid may be null; both have one transform.
struct Scene {
    FloatGrid::ConstPtr smoke;
    FloatGrid::ConstPtr fire;
    std::string left_out;  ///< name of a grid that would belong to it, but has another transform

    /// The active voxels of both.
    openvdb::CoordBBox box() const;
};

/// A grid named flame, temperature or heat glows; all others are smoke.
bool glows(const std::string& name);

/// The shown grid and the one that belongs to it: `flame` to smoke, `density` to fire, if the volume has it as floats.
/// @param input  the input's name, for messages
/// @param shown  a grid of the volume
/// @throws Failure if the shown grid holds no floats
Scene scene_of(const Volume& volume, const std::string& input, const openvdb::GridBase::ConstPtr& shown);

/// The values that are rendered as the thickest smoke and the brightest fire. Higher values go on in proportion.
struct Exposure {
    float smoke = 0;
    float fire = 0;

    /// Raises both to the highest active values of a scene. Values that are not finite are passed over.
    void meter(const Scene& scene);
};

/// A picture of a part of the plane, with whole pixels to a voxel or whole voxels to a pixel.
struct Render {
    Area area;        ///< in voxels
    Picture picture;  ///< empty: nothing to show
    bool empty() const { return picture.pixels.empty(); }
};

/// What a render shows where nothing is.
constexpr Colour render_background{74, 81, 94};

/// Smoke lit from the upper left in front, with its own shadows, and fire that glows through it. Scenes are rendered in
/// index space, so the picture has the place and orientation of a projection of the same box. The result does not
/// depend on the count of threads. Where fire is exposed for, the light on the smoke is dimmer.
/// @param box       index box that the picture shows, at least one voxel large; what is compared must share it
/// @param exposure  must be shared too; where a value is 0, that medium is not seen
Render render(const Scene& scene, View view, const openvdb::CoordBBox& box, const Exposure& exposure);

}  // namespace fluidcarve
