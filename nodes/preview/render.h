#pragma once

#include "nodes/preview/picture_scene.h"
#include "nodes/preview/projection.h"
#include "nodes/preview/rendered.h"

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The grids of a volume that are rendered. Any may be null; all have the same transform.
struct Scene {
    FloatGrid::ConstPtr smoke;
    FloatGrid::ConstPtr fire;
    std::string left_out;  ///< name of a grid that is not rendered because it has another transform
    FloatGrid::ConstPtr water = nullptr;       ///< a level set; the others are then null
    std::optional<PictureScene> picture = {};  ///< the others are then null

    /// The grids that are not null; none of a picture.
    std::vector<FloatGrid::ConstPtr> grids() const;
    /// Index box of the active voxels of all grids.
    openvdb::CoordBBox box() const;
};

/// Whether a grid is rendered as fire, by its name: flame, temperature or heat. All others are
/// smoke.
bool glows(const std::string& name);

/// The shown grid and its counterpart, if the volume has it as a float grid: `flame` for smoke,
/// `density` for fire. A level set is rendered as the surface of water, a channel of a picture as
/// the picture.
/// @param input  the input's name, for messages
/// @param shown  a grid of the volume
/// @throws Failure if the shown grid holds no floats
Scene scene_of(const Volume& volume, const std::string& input,
               const openvdb::GridBase::ConstPtr& shown);

/// How bright a render is: the values that are rendered as the thickest smoke and the brightest
/// fire, and the gain of all light. Higher values are rendered thicker and brighter still.
struct Exposure {
    float smoke = 0;
    float fire = 0;
    /// Factor of the light that smoke scatters and fire gives; the background has none.
    double gain = 1;

    /// Raises both to the highest active values of a scene. Values that are not finite are ignored.
    void meter(const Scene& scene);
};

/// Renders smoke, lit from the front at the upper left, with shadows, and fire that glows through
/// it. Water is lit from the same side at a low angle, without shadows, so that waves show. Scenes
/// are rendered in index space, so that the picture covers the same area as a projection of the
/// same box. The light on the smoke is dimmer if the exposure includes fire. The result does not
/// depend on the number of threads.
/// @param box       index box that the picture shows, not empty; pictures to compare must use the
///   same
/// @param exposure  pictures to compare must use the same; a medium with the value 0 is not
///   rendered
RenderedPicture render(const Scene& scene, View view, const openvdb::CoordBBox& box,
                       const Exposure& exposure);

}  // namespace fluidcarve
