#pragma once

#include "nodes/preview/sheet_page.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What a sheet is to show.
struct SheetWish {
    enum class Show { maximum, slice, both, render };
    std::string grid;
    View view = View::y;
    Show show = Show::maximum;
    std::optional<int> slice;  ///< index coordinate along the view; nothing: the middle of `before` over all frames shown
    bool difference = true;
};

/// One frame's data; all but `before` may be null, in all frames alike.
struct SheetFrame {
    std::string name;  ///< "frame 1001"
    int number = 0;
    openvdb::GridBase::ConstPtr before, after;  ///< FloatGrid or VectorGrid, both the same
    Scene before_scene, after_scene;            ///< of them, where they are to be rendered
    std::shared_ptr<const FloatGrid> energy;
    std::shared_ptr<const Lattice> lattice;  ///< where there are seams
    std::shared_ptr<const Seams> seams;
};

/// Makes the rows of a sheet, frame by frame: before, after and difference as maximum projections, then as slices, or
/// before and after as renders; then the seams over the energy, in the slice, since a seam is a surface. Frames are let
/// go as soon as the place of the slice is known; where that is the middle, the grids to be sliced stay until the page is
/// made. So do those to be rendered, as all frames share one window and one exposure.
class SheetRows {
public:
    explicit SheetRows(SheetWish wish) : wish_(std::move(wish)) {}

    /// @throws Failure if seams belong to another lattice or do not hold the frame
    void add(SheetFrame frame);
    /// The page of all frames added, at least one; to be called once.
    /// @param total     frames of the whole sequence
    /// @param progress  is told before each render how far the renders have come, 0 to 1; may throw to stop them
    SheetPage page(std::size_t total, const std::function<void(double)>& progress = {});

private:
    struct Kind {
        enum class What { before, after, difference, energy };
        enum class How { maximum, slice, render };
        What what;
        How how;
    };
    /// A frame, its grids only as long as they are to be sliced.
    struct Shown {
        SheetFrame data;
        openvdb::math::Transform::ConstPtr space;  ///< of `before`
        openvdb::CoordBBox before, after;          ///< active voxels
    };
    void plan(const Shown& frame);
    void slice(std::size_t place, int plane);
    void render(const std::function<void(double)>& progress);
    SheetPanel panel(const Kind& kind, const Shown& frame, std::optional<int> plane) const;
    std::string name_of(const Kind& kind) const;
    std::string text_of(const Kind& kind, int plane) const;

    SheetWish wish_;
    std::vector<Kind> kinds_;
    std::vector<Shown> frames_;
    std::vector<std::vector<SheetPanel>> panels_;  ///< `[row][frame]`
    openvdb::CoordBBox active_;                    ///< of `before` in all frames
    openvdb::CoordBBox scenes_;                    ///< all that is rendered in all frames
    Exposure exposure_;                            ///< for the scenes of `before`
    bool face_ = false;                            ///< seams face the view
};

}  // namespace fluidcarve
