#include "carve/base/failure.h"
#include "carve/field/extent.h"
#include "carve/field/same_transform.h"
#include "carve/field/voxel_axes.h"
#include "carve/lattice/build.h"
#include "carve/lattice/lattice.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/lattice.h"
#include "nodes/payload/active_box.h"
#include "nodes/solving/foreseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

namespace fluidcarve {

namespace {

enum class AxisOrder { xyz, xzy, yxz, yzx, zxy, zyx };

}  // namespace

template <>
struct ChoiceNames<AxisOrder> {
    static constexpr std::array names = {
        std::pair{"xyz", AxisOrder::xyz}, std::pair{"xzy", AxisOrder::xzy},
        std::pair{"yxz", AxisOrder::yxz}, std::pair{"yzx", AxisOrder::yzx},
        std::pair{"zxy", AxisOrder::zxy}, std::pair{"zyx", AxisOrder::zyx}};
};

namespace {

using openvdb::Coord;
using openvdb::CoordBBox;
using openvdb::Vec3d;

constexpr int most_steps = most_vertices - 1;

std::array<int, 3> world_axes(AxisOrder order) {
    const auto name = ParamTraits<AxisOrder>::text(order);
    return {name[0] - 'x', name[1] - 'x', name[2] - 'x'};
}

/// Largest distance from a voxel that rounding explains, voxels.
constexpr double rounding = 2e-3;

/// The voxels of a transform in which those of a grid lie.
/// @throws Failure naming the grid and the frame, if they lie too far away
CoordBBox among(const openvdb::math::Transform& first, const CoordBBox& voxels,
                const openvdb::math::Transform& transform, const std::string& name, int frame) {
    if (first == transform) return voxels;
    CoordBBox out;
    for (int n = 0; n < 8; ++n) {
        const auto corner = [&](int axis) -> double {
            return (n >> axis & 1) != 0 ? voxels.max()[axis] : voxels.min()[axis];
        };
        const auto at =
            first.worldToIndex(transform.indexToWorld(Vec3d(corner(0), corner(1), corner(2))));
        if (!voxel_at(at))
            throw Failure(
                fmt::format("grid '{}' has {} in frame {}, too far from the others for one lattice",
                            name, place_text(transform), frame));
        out.expand(Coord::floor(at + Vec3d(rounding)));
        out.expand(Coord::ceil(at - Vec3d(rounding)));
    }
    return out;
}

struct Box {
    struct Params {
        Auto<Vec3> min, max;
        Auto<double> spacing;
        AxisOrder axes = AxisOrder::xyz;
    };
    struct Ports {
        OptionalList<AnyGrid> fit;
        Ref<Lattice> lattice;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (check.stated("fit")) {
            for (const auto* field : {"min", "max", "spacing"})
                if (check.stated(field))
                    check.fault(field, fmt::format("'{}' and 'fit' exclude each other: a fitted "
                                                   "box takes its place and spacing from the grid",
                                                   field));
            return;
        }
        for (const auto* field : {"min", "max", "spacing"})
            if (!check.stated(field))
                return check.fault(field,
                                   "needs either 'fit', or all of 'min', 'max' and 'spacing'");
        if (!params.min || !params.max || !params.spacing) return;
        if (!(*params.spacing > 0)) return check.fault("spacing", "'spacing' must be above 0");
        check_extent(*params.min, *params.max, *params.spacing, check);
    }

    static void check_extent(const Vec3& min, const Vec3& max, double spacing, NodeCheck& check) {
        for (std::size_t n = 0; n < 3; ++n) {
            const double extent = max[n] - min[n], steps = extent / spacing;
            if (extent < 0)
                check.fault("max", fmt::format("'max' is below 'min' in {}: {:.10g} < {:.10g}",
                                               "xyz"[n], max[n], min[n]));
            else if (steps > most_steps)
                check.fault("max", fmt::format("the extent {:.10g} in {} is {:.0f} times the "
                                               "spacing {:.10g}; {} is the most",
                                               extent, "xyz"[n], steps, spacing, most_steps));
            else if (std::abs(steps - std::round(steps)) > 1e-3)
                check.fault(
                    "max",
                    fmt::format("the extent {:.10g} in {} is no whole multiple of the spacing "
                                "{:.10g}; the nearest 'max' that fits is {:.10g}",
                                extent, "xyz"[n], spacing, min[n] + std::round(steps) * spacing));
        }
    }

    static void foresee(const Params& params, Outlook& ahead) {
        if (params.min && params.max) {
            ahead.lies(Region{{Region::Box{*params.min, *params.max}}, {}});
            tell_form({shape_of(params)}, ahead);
        } else if (const auto* const fit = ahead.region("fit")) ahead.lies(*fit);
    }

    static std::shared_ptr<ActiveBox> digest(const Params&, const Ports& io, Context& context) {
        const auto& first = *io.fit.front()->grid;
        ActiveBox out{first.getName(), first.transform().copy(),
                      first.evalActiveVoxelBoundingBox()};
        for (std::size_t n = 1; n < io.fit.size(); ++n) {
            const auto& grid = *io.fit[n]->grid;
            const auto active = grid.evalActiveVoxelBoundingBox();
            if (active.empty()) continue;
            out.voxels.expand(among(first.transform(), active, grid.transform(), grid.getName(),
                                    context.frame()));
        }
        return std::make_shared<ActiveBox>(std::move(out));
    }

    void add(const Params&, const Ref<ActiveBox>& in, Context& context) {
        if (in->voxels.empty()) return;
        if (!in->transform->isLinear())
            throw Failure(fmt::format(
                "grid '{}' has voxels of varying shape ({}) in frame {}; a box fits voxels of one "
                "shape, as grid.resample makes them: or state 'min', 'max' and 'spacing' instead",
                in->name, in->transform->mapType(), context.frame()));
        voxels_.require(fmt::format("grid '{}'", in->name), *in->transform, context.frame());
        name_ = in->name;
        // A container may move from frame to frame.
        box_.expand(
            among(*voxels_.transform(), in->voxels, *in->transform, in->name, context.frame()));
    }

    void finish(const Params& params, Ports& io, Context&) {
        const auto axes = world_axes(params.axes);
        if (params.min) {
            // The spacing is computed from the corners: a spacing typed with few digits would let
            // the vertices drift away from the voxels.
            double spacing = *params.spacing, longest = 0;
            for (std::size_t n = 0; n < 3; ++n)
                if (const double steps = steps_along(params, n); steps > longest)
                    spacing = ((*params.max)[n] - (*params.min)[n]) / (longest = steps);
            io.lattice = std::make_shared<Lattice>(
                make_box(Vec3d((*params.min)[0], (*params.min)[1], (*params.min)[2]),
                         shape_of(params), spacing, axes));
            return;
        }
        if (!voxels_.transform())
            throw Failure(
                "the grid to fit has no active voxels in any frame; state 'min', 'max' and "
                "'spacing' instead");
        const auto& transform = *voxels_.transform();
        const auto counts = extents_of(box_);
        if (*std::max_element(counts.begin(), counts.end()) > most_vertices)
            throw Failure(
                fmt::format("the active voxels of grid '{}' span {}; {} along an axis is the most: "
                            "crop the grid, or state 'min', 'max' and 'spacing' of a part",
                            name_, span_text(box_), most_vertices),
                Failure::Kind::input);
        if (cubes_along_axes(transform)) {
            const std::array<int, 3> shape{static_cast<int>(counts[0]), static_cast<int>(counts[1]),
                                           static_cast<int>(counts[2])};
            io.lattice = std::make_shared<Lattice>(make_box(transform.indexToWorld(box_.min()),
                                                            in_order(axes, shape),
                                                            transform.voxelSize().x(), axes));
            return;
        }
        // Along u, v and w, the voxels' own axes that come nearest to those of the world.
        const VoxelAxes own(transform);
        openvdb::Vec3d first;
        std::array<int, 3> shape;
        std::array<Vec3d, 3> steps;
        for (std::size_t n = 0; n < 3; ++n) {
            const int axis = own.nearest(axes[n]);
            const bool back = own.step(axis)[axes[n]] < 0;
            shape[n] = static_cast<int>(counts[static_cast<std::size_t>(axis)]);
            steps[n] = own.step(axis) * (back ? -1 : 1);
            first[axis] = back ? box_.max()[axis] : box_.min()[axis];
        }
        io.lattice =
            std::make_shared<Lattice>(make_box(transform.indexToWorld(first), shape, steps));
    }

private:
    /// Steps from the first vertex to the last.
    /// @param axis  of the world; `min`, `max` and `spacing` must be stated
    static double steps_along(const Params& params, std::size_t axis) {
        return std::round(((*params.max)[axis] - (*params.min)[axis]) / *params.spacing);
    }
    /// I, J, K by the numbers along the world's axes.
    static std::array<int, 3> in_order(const std::array<int, 3>& axes,
                                       const std::array<int, 3>& counts) {
        std::array<int, 3> out;
        for (std::size_t n = 0; n < 3; ++n) out[n] = counts[static_cast<std::size_t>(axes[n])];
        return out;
    }
    /// I, J, K of a stated box.
    static std::array<int, 3> shape_of(const Params& params) {
        std::array<int, 3> counts;
        for (std::size_t n = 0; n < 3; ++n)
            counts[n] = static_cast<int>(steps_along(params, n)) + 1;
        return in_order(world_axes(params.axes), counts);
    }

    SameVoxels voxels_;
    openvdb::CoordBBox box_;
    std::string name_;
};

}  // namespace

NodeType lattice_box() {
    return Declare<Box>("lattice.box",
                        "A straight lattice, given by its corners or fitted around the active "
                        "voxels of a grid over all frames.")
        .input(
            "fit", &Box::Ports::fit,
            "A grid, or a list. The lattice gets a vertex at each voxel of the first one, in the "
            "box around the active voxels of all, over all frames. Replaces min, max and spacing.")
        .param("min", &Box::Params::min, Unit::world, any_number(), "Position of the first vertex.")
        .param("max", &Box::Params::max, Unit::world, any_number(),
               "Position of the last vertex, a whole number of spacings (0 or more) from `min`.")
        .param("spacing", &Box::Params::spacing, Unit::world, at_least(0),
               "Distance between neighbouring vertices; above 0.")
        .param("axes", &Box::Params::axes,
               "Which world axes are u, v and w; of turned voxels, the axes of the voxels that "
               "come nearest to them.")
        .output("lattice", &Box::Ports::lattice, "The lattice.")
        .digests({"fit"})
        .kept();
}

}  // namespace fluidcarve
