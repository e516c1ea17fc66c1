#pragma once

#include "carve/base/values.h"
#include "carve/lattice/lattice.h"
#include "carve/rig/rig.h"
#include "carve/seam/seams.h"
#include "carve/seam/smooth_displacement.h"
#include "carve/volume/volume.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Content of a page that is the same in all frames.
struct PageRequest {
    std::string title;
    std::string grid;       ///< name of the grid shown
    std::string setting;    ///< what `--set` sets to choose the count: "count"
    int voxels = 96;        ///< most page voxels along an axis
    int flat_voxels = 640;  ///< the same for pictures, which are one voxel thick
    std::size_t count = 0;  ///< seams carved at first, of the last set
    Softness softness;      ///< of the carve, as remap.grids takes it
    double rim_fade = 0;    ///< vertices; 0: none (CarveMap::fade_rims)
};

/// The data of one frame.
struct PageFrame {
    int number = 0;
    openvdb::GridBase::ConstPtr before;
    FloatGrid::ConstPtr energy;              ///< null, or set in all frames
    std::shared_ptr<const Lattice> lattice;  ///< null, or set in all frames; set if there are seams
    std::shared_ptr<const Rig> rig;          ///< null, or set in all frames
    std::vector<std::pair<std::string, openvdb::GridBase::ConstPtr>> masks;  ///< by name
    std::vector<Ref<Seams>> seams;  ///< in the order of carving
};

/// The data of a page, which its script reads (nodes/page/scene.js). Volumes have 8 bits a voxel,
/// with one scale for all frames. Lattices and rigs are in page voxels. Entries of seams are
/// original indices; with those of neighbouring frames, if the carve is soft in time.
/// @param frames  at least one, rising
/// @throws Failure if a grid can't be shown, or seams do not fit the lattice or the frame
nlohmann::ordered_json page_scene(const PageRequest& request, const std::vector<PageFrame>& frames);

}  // namespace fluidcarve
