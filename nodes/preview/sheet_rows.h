#pragma once

#include "nodes/preview/sheet_page.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// What a sheet is to show.
struct SheetWish {
    enum class Show { maximum, slice, both };
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
    std::shared_ptr<const FloatGrid> energy;
    std::shared_ptr<const Lattice> lattice;  ///< where there are seams
    std::shared_ptr<const Seams> seams;
};

/// Makes the rows of a sheet, frame by frame: before, after and difference as maximum projections, then as slices, then
/// the seams over the energy, in the slice, since a seam is a surface. Frames are let go as soon as the place of the
/// slice is known; where that is the middle, the grids to be sliced stay until the page is made.
class SheetRows {
public:
    explicit SheetRows(SheetWish wish) : wish_(std::move(wish)) {}

    /// @throws Failure if seams belong to another lattice or do not hold the frame
    void add(SheetFrame frame);
    /// The page of all frames added, at least one; to be called once.
    /// @param total  frames of the whole sequence
    SheetPage page(std::size_t total);

private:
    struct Kind {
        enum class What { before, after, difference, energy };
        What what;
        bool sliced;
    };
    /// A frame, its grids only as long as they are to be sliced.
    struct Shown {
        SheetFrame data;
        openvdb::math::Transform::ConstPtr space;  ///< of `before`
        openvdb::CoordBBox before, after;          ///< active voxels
    };
    void plan(const Shown& frame);
    void slice(std::size_t place, int plane);
    SheetPanel panel(const Kind& kind, const Shown& frame, std::optional<int> plane) const;
    std::string name_of(const Kind& kind) const;
    std::string text_of(const Kind& kind, int plane) const;

    SheetWish wish_;
    std::vector<Kind> kinds_;
    std::vector<Shown> frames_;
    std::vector<std::vector<SheetPanel>> panels_;  ///< `[row][frame]`
    openvdb::CoordBBox active_;                    ///< of `before` in all frames
    bool face_ = false;                            ///< seams face the view
};

}  // namespace fluidcarve
