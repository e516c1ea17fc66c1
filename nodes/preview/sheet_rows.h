#pragma once

#include "nodes/preview/sheet_page.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What a sheet shows.
struct SheetWish {
    enum class Show { maximum, slice, both, render };
    std::string grid;
    View view = View::y;
    Show show = Show::maximum;
    std::optional<int> slice;  ///< index coordinate along the view; nothing: the middle of `before` in all frames shown
    bool difference = true;
    std::uint64_t budget = ~std::uint64_t{0};  ///< memory of what tiles become as voxels, bytes (grid_fits)
};

/// The data of one frame. All grids but `before` may be null, but then in all frames.
struct SheetFrame {
    std::string name;                           ///< "frame 1001"
    int number = 0;                             ///< frame number
    openvdb::GridBase::ConstPtr before, after;  ///< both FloatGrid or both VectorGrid
    Scene before_scene, after_scene;            ///< scenes of `before` and `after`, if they are rendered
    std::shared_ptr<const FloatGrid> energy;
    std::shared_ptr<const Lattice> lattice;  ///< set if there are seams
    std::shared_ptr<const Seams> seams;
};

/// Makes the rows of a sheet, frame by frame: `before`, `after` and their difference as maximum projections, then as slices; or `before`
/// and `after` as renders; then the seams over a slice of the energy. Grids are freed as soon as they are drawn. If the slice is in the
/// middle, grids to slice are held until all frames are known. Grids to render are held too, since all frames share area and exposure.
class SheetRows {
public:
    explicit SheetRows(SheetWish wish) : wish_(std::move(wish)) {}

    /// @throws Failure if seams belong to another lattice or do not hold the frame, or grids are too large to show
    void add(SheetFrame frame);
    /// The page of all added frames. To be called once, after at least one `add`.
    /// @param total     number of frames in the whole sequence
    /// @param progress  called before each render with the finished part of all renders, 0 to 1; may throw to stop
    SheetPage page(std::size_t total, const std::function<void(double)>& progress = {});

private:
    struct Kind {
        enum class What { before, after, difference, energy };
        enum class How { maximum, slice, render };
        What what;
        How how;
    };
    /// An added frame. It holds its grids until they are drawn.
    struct Shown {
        SheetFrame data;
        openvdb::math::Transform::ConstPtr space;  ///< transform of `before`
        openvdb::CoordBBox before, after;          ///< boxes of active voxels
    };
    void plan(const Shown& frame);
    void slice(std::size_t place, int plane);
    void render(const std::function<void(double)>& progress);
    SheetPanel panel(const Kind& kind, const Shown& frame, std::optional<int> plane) const;
    void require_room(const Shown& frame) const;
    std::string name_of(const Kind& kind) const;
    std::string text_of(const Kind& kind, int plane) const;

    SheetWish wish_;
    std::vector<Kind> kinds_;
    std::vector<Shown> frames_;
    std::vector<std::vector<SheetPanel>> panels_;  ///< `[row][frame]`
    openvdb::CoordBBox active_;                    ///< box of the active voxels of `before` in all frames
    openvdb::CoordBBox scenes_;                    ///< box of all scenes in all frames
    Exposure exposure_;                            ///< metered on the scenes of `before`
    bool face_ = false;                            ///< whether seams face the viewer
};

}  // namespace fluidcarve
