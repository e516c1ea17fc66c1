#pragma once

#include "carve/base/values.h"
#include "nodes/preview/sheet_page.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// The wanted content of a sheet.
struct SheetRequest {
    enum class Show { maximum, slice, render };
    std::string grid;
    View view = View::y;
    std::vector<Show> shows{Show::maximum};  ///< in the order of the rows, each once
    double exposure = 0;                     ///< of renders, stops
    bool lattice = false;                    ///< whether the lattice is drawn over all pictures
    bool rig = false;                        ///< the same for the rig
    bool seams = true;                       ///< whether seams are drawn over the energy
    std::optional<int> slice;  ///< index coordinate along the view; nothing: the middle of `before`
                               ///< in all frames shown
    bool difference = true;
    /// Memory for tiles that become voxels, bytes (grid_fits)
    std::uint64_t budget = ~std::uint64_t{0};
};

/// The data of one frame. All grids but `before` may be null, but then in all frames.
struct SheetFrame {
    std::string name;                           ///< "frame 1001"
    int number = 0;                             ///< frame number
    openvdb::GridBase::ConstPtr before, after;  ///< both FloatGrid or both VectorGrid
    Scene before_scene, after_scene;  ///< scenes of `before` and `after`, if they are rendered
    std::shared_ptr<const FloatGrid> energy;
    std::shared_ptr<const Lattice> lattice;  ///< set if there are seams, or it is drawn
    std::shared_ptr<const Rig> rig;          ///< set if it is drawn
    Ref<Seams> seams;
};

/// Makes the rows of a sheet, frame by frame: for each way to show them `before`, `after` and,
/// unless they are rendered, their difference; then the seams over a slice of the energy. Grids are
/// freed as soon as they are drawn. If the slice is in the middle, grids to slice are held until
/// all frames are known. Grids to render are held too, since all frames share area and exposure.
class SheetRows {
public:
    explicit SheetRows(SheetRequest request) : request_(std::move(request)) {}

    /// @throws Failure if seams belong to another lattice or do not hold the frame, or grids are
    ///   too large to show
    void add(SheetFrame frame);
    /// The page of all added frames. To be called once, after at least one `add`.
    /// @param total     number of frames in the whole sequence
    /// @param progress  called before each render with the finished part of all renders, 0 to 1;
    ///   may throw to stop
    SheetPage page(std::size_t total, const std::function<void(double)>& progress = {});

private:
    struct Kind {
        enum class What { before, after, difference, energy };
        What what;
        SheetRequest::Show how;
    };
    /// An added frame. It holds its grids until they are drawn.
    struct Shown {
        SheetFrame data;
        openvdb::math::Transform::ConstPtr space;  ///< transform of `before`
        openvdb::CoordBBox before, after;          ///< boxes of active voxels
        std::vector<PictureLine> lattice, rig;     ///< lines over all pictures
    };
    void plan(const Shown& frame);
    bool shows(SheetRequest::Show how) const;
    void slice(std::size_t t, int plane);
    void render(const std::function<void(double)>& progress);
    SheetPanel panel(const Kind& kind, const Shown& frame, std::optional<int> plane) const;
    void require_room(const Shown& frame) const;
    std::string name_of(const Kind& kind) const;
    std::string caption(const Kind& kind, int plane) const;

    SheetRequest request_;
    std::vector<Kind> kinds_;
    std::vector<Shown> frames_;
    std::vector<std::vector<SheetPanel>> panels_;  ///< `[row][frame]`
    openvdb::CoordBBox active_;            ///< box of the active voxels of `before` in all frames
    openvdb::CoordBBox scenes_;            ///< box of all scenes in all frames
    Exposure exposure_;                    ///< metered on the scenes of `before`
    std::array<SeenDirection, 3> axes_{};  ///< the world's axes in the first frame
    bool picture_ = false;                 ///< whether the scenes are pictures
    bool face_ = false;                    ///< whether seams face the viewer
};

}  // namespace fluidcarve
