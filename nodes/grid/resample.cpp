#include "nodes/grid/resample.h"

#include "graph/text/problem.h"
#include "graph/text/words.h"
#include "nodes/field/collocate.h"
#include "nodes/field/voxels_of.h"
#include "nodes/grid/each_grid.h"
#include "nodes/io/stored_form.h"

#include <openvdb/tools/GridTransformer.h>

#include <fmt/format.h>

#include <cmath>
#include <type_traits>

namespace fluidcarve {
namespace {

struct Resample {
    struct Params {
        Auto<double> voxel_size;
    };
    struct Ports {
        Ref<Volume> source;
        Optional<AnyGrid> like;
        Ref<Volume> volume;
    };

    static void check(const Params& params, NodeCheck& check) { check_voxels(params.voxel_size, check); }

    static void run(const Params& params, Ports& io, Context& context) {
        const auto transform = voxels_of(io.like, params.voxel_size);
        io.volume = std::make_shared<Volume>(resampled(*io.source, *transform, context.memory_budget()));
    }
};

/// @throws Failure (input) if the active voxels, as many as their space holds of the new ones, take more than the budget
void require_fits(const openvdb::GridBase& grid, const openvdb::math::Transform& transform, double value_bytes, std::uint64_t budget) {
    const auto centre = grid.evalActiveVoxelBoundingBox().getCenter();
    const auto volume = [](const openvdb::math::Transform& of, const openvdb::Vec3d& at) { return std::abs(of.voxelSize(at).product()); };
    const double share = volume(grid.transform(), centre) / volume(transform, transform.worldToIndex(grid.transform().indexToWorld(centre)));
    const double voxels = share * static_cast<double>(grid.activeVoxelCount()), bytes = voxels * value_bytes;
    if (bytes <= static_cast<double>(budget)) return;
    throw Failure(fmt::format("grid '{}' would have {:.3g} voxels, which take {}, but --memory allows {}: take larger voxels", grid.getName(), voxels,
                              size_text(static_cast<std::uint64_t>(std::min(bytes, 1e18))), size_text(budget)),
                  Failure::Kind::input);
}

/// The same grid, without its tree, on other voxels. What its reader placed is still undone by a writer.
template <class GridT>
typename GridT::Ptr moved_to(const GridT& grid, const openvdb::math::Transform& transform) {
    const auto out = grid.copyWithNewTree();
    if (const auto stored = stored_form_of(grid)) {
        StoredForm form;
        form.placement = stored->placement;
        form.placement.offset = openvdb::Vec3d(0);
        set_stored_form(*out, form);
    }
    out->setTransform(transform.copy());
    return out;
}

/// The grid with its values at the voxels' centres.
template <class GridT>
std::shared_ptr<const GridT> at_centres(const std::shared_ptr<const GridT>& grid) {
    if constexpr (std::is_same_v<GridT, VectorGrid>) return collocated(grid);
    else return grid;
}

/// OpenVDB samples no masks, but states of other grids.
void sample_mask(const MaskGrid& mask, MaskGrid& out) {
    openvdb::BoolGrid from(std::make_shared<openvdb::BoolTree>(mask.tree(), false, true, openvdb::TopologyCopy())), to;
    from.setTransform(mask.transform().copy());
    to.setTransform(out.transform().copy());
    openvdb::tools::resampleToMatch<openvdb::tools::PointSampler>(from, to);
    out.setTree(std::make_shared<openvdb::MaskTree>(to.tree(), false, openvdb::TopologyCopy()));
}

}  // namespace

Volume resampled(const Volume& volume, const openvdb::math::Transform& transform, std::uint64_t budget) {
    return each_grid(volume, [&]<class GridT>(const std::shared_ptr<const GridT>& given) -> openvdb::GridBase::ConstPtr {
        using Value = typename GridT::ValueType;
        using Element = typename openvdb::VecTraits<Value>::ElementType;
        if (given->transform() == transform || given->tree().empty()) return given;
        require_fits(*given, transform, sizeof(Value), budget);
        const auto grid = at_centres(given);
        const auto out = moved_to(*grid, transform);
        if (grid != given) out->setGridClass(openvdb::GRID_UNKNOWN);
        if constexpr (std::is_same_v<GridT, MaskGrid>) sample_mask(*grid, *out);
        else if constexpr (std::is_floating_point_v<Element>) openvdb::tools::resampleToMatch<openvdb::tools::BoxSampler>(*grid, *out);
        else openvdb::tools::resampleToMatch<openvdb::tools::PointSampler>(*grid, *out);
        return out;
    });
}

NodeType grid_resample() {
    return Declare<Resample>("grid.resample",
                             "Puts grids on other voxels: larger or smaller ones, upright cubes in place of turned ones, or those of another grid.")
        .input("source", &Resample::Ports::source, "The grids, or one grid.")
        .input("like", &Resample::Ports::like, "The grids take the voxels of this grid. Only its transform counts.")
        .param("voxel_size", &Resample::Params::voxel_size, Unit::world, between(least_voxel, 1e9),
               "Edge of a voxel, instead of `like`. A voxel centre is at the world's origin, and voxels stand along the world's axes.")
        .output("volume", &Resample::Ports::volume,
                "The same grids. Floats and vectors are read linearly, whole numbers and states from the nearest voxel; level sets keep their narrow band. "
                "Staggered vectors become collocated. Points stay.")
        .names_as("volume", "source");
}

}  // namespace fluidcarve
