#include "nodes/mask.h"

#include "carve/field/active_range.h"
#include "carve/field/missed_range.h"
#include "carve/field/stencil.h"
#include "carve/mask/below_surface.h"
#include "carve/mask/box.h"
#include "carve/mask/combine.h"
#include "carve/mask/dilate.h"
#include "carve/mask/mesh.h"
#include "carve/mask/sphere.h"
#include "carve/mask/threshold.h"
#include "carve/mask/weight.h"
#include "carve/mesh/made_once.h"
#include "carve/mesh/mesh.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"
#include "nodes/params/check_params.h"

#include <fmt/format.h>
#include <openvdb/tools/Count.h>

#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace fluidcarve {

namespace {

using openvdb::Vec3d;

constexpr auto like_doc =
    "The mask takes the voxels of this grid, such as the energy. Only its transform counts.";

struct BelowSurface {
    struct Params {
        Vec3 up{0, 0, 1};
        double depth = 0;
    };
    struct Ports {
        List<FloatGrid> surfaces;
        Ref<MaskGrid> mask;
    };
    static void check(const Params& params, NodeCheck& check) {
        check_direction("up", params.up, check);
    }
    static void run(const Params& params, Ports& io, Context&) {
        io.mask = below_surface_mask(io.surfaces, Vec3d(params.up.data()), params.depth);
    }
};

}  // namespace

NodeType mask_below_surface() {
    using Params = BelowSurface::Params;
    return Declare<BelowSurface>("mask.below_surface",
                                 "The voxels below the surfaces of liquids and their banks, where "
                                 "energy should not count (paper 6.0.2).")
        .input("surfaces", &BelowSurface::Ports::surfaces,
               "Level sets with the same voxels, negative inside: the water and the bank "
               "(sdf.from_points, sdf.from_mesh with `like`).")
        .param("up", &Params::up, Unit::none, any_number(),
               "The up direction, along an axis of the voxels.")
        .param("depth", &Params::depth, Unit::world, at_least(0),
               "Distance from the uppermost surface down to the mask, rounded to voxels.")
        .output("mask", &BelowSurface::Ports::mask,
                "The voxels below the uppermost surface, also beneath overhangs, down to the "
                "lowest active voxel. Give it the weight 0 in mask.weight, `mode: multiply`.")
        .kept();
}

namespace {

struct MaskBox {
    struct Params {
        Vec3 min{}, max{};
    };
    struct Ports {
        Ref<AnyGrid> like;
        Ref<MaskGrid> mask;
    };
    static void check(const Params& params, NodeCheck& check) {
        check_corners(params.min, params.max, check);
    }
    static void run(const Params& params, Ports& io, Context&) {
        io.mask = box_mask(*io.like->grid, Vec3d(params.min.data()), Vec3d(params.max.data()));
    }
};

}  // namespace

NodeType mask_box() {
    return Declare<MaskBox>("mask.box", "The voxels in a box: where seams are wanted, or kept out.")
        .input("like", &MaskBox::Ports::like, like_doc)
        .required("min", &MaskBox::Params::min, Unit::world, any_number(), "The low corner.")
        .required("max", &MaskBox::Params::max, Unit::world, any_number(),
                  "The high corner. Both corners lie in the box.")
        .output("mask", &MaskBox::Ports::mask, "The voxels whose centres lie in the box.")
        .kept()
        .in_place();
}

namespace {

struct MaskCombine {
    struct Params {
        MaskMode mode = MaskMode::any;
    };
    struct Ports {
        List<MaskGrid> masks;
        Ref<MaskGrid> mask;
    };
    static void run(const Params& params, Ports& io, Context&) {
        io.mask = combined_mask(io.masks, params.mode);
    }
};

}  // namespace

NodeType mask_combine() {
    return Declare<MaskCombine>(
               "mask.combine",
               "Combines masks to one: the voxels in any of them, in all, or only in the first.")
        .input("masks", &MaskCombine::Ports::masks, "Masks with the same transform.")
        .param("mode", &MaskCombine::Params::mode,
               "union: voxels in any of the masks. intersection: voxels in all. difference: voxels "
               "in the first and in no other.")
        .output("mask", &MaskCombine::Ports::mask, "The combined mask.")
        .kept()
        .in_place();
}

namespace {

struct MaskDilate {
    struct Params {
        int voxels = 0;
    };
    struct Ports {
        Ref<MaskGrid> mask, dilated;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.mask, state_bytes, context.limits().memory);
        io.dilated = dilated_mask(*io.mask, params.voxels);
    }
};

}  // namespace

NodeType mask_dilate() {
    return Declare<MaskDilate>(
               "mask.dilate",
               "Grows or shrinks a mask: for example a margin around what must be spared.")
        .input("mask", &MaskDilate::Ports::mask, "A mask.")
        .required(
            "voxels", &MaskDilate::Params::voxels, Unit::voxels, between(-256, 256),
            "Distance along each axis and diagonal. Above 0 the mask grows, below 0 it shrinks.")
        .output("mask", &MaskDilate::Ports::dilated, "The mask, grown or shrunk.")
        .kept()
        .in_place();
}

namespace {

enum class Where { inside, near };

}  // namespace

template <>
struct ChoiceNames<Where> {
    static constexpr std::array names = {std::pair{"inside", Where::inside},
                                         std::pair{"near", Where::near}};
};

namespace {

struct MaskMesh {
    struct Params {
        Where where = Where::inside;
        double distance = 0;
    };
    struct Ports {
        Ref<Mesh> mesh;
        Ref<AnyGrid> like;
        Ref<MaskGrid> mask;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.where == Where::inside && check.stated("distance"))
            check.fault("distance", "'distance' is only for `where: near`");
        if (params.where == Where::near && params.distance == 0)
            check.fault("where", "`where: near` needs a 'distance' above 0");
    }

    void run(const Params& params, Ports& io, Context&) const {
        require_cubes(*io.like->grid);
        const auto& transform = io.like->grid->transform();
        io.mask = made_(io.mesh, transform, [&] {
            return params.where == Where::inside ? inside_mask(*io.mesh, transform)
                                                 : near_mask(*io.mesh, transform, params.distance);
        });
    }

private:
    MadeOnce<MaskGrid> made_;
};

}  // namespace

NodeType mask_mesh() {
    using Params = MaskMesh::Params;
    return Declare<MaskMesh>(
               "mask.mesh",
               "The voxels in a mesh, or near its faces: where seams are wanted, or kept out.")
        .input("mesh", &MaskMesh::Ports::mesh, "A closed mesh; with `where: near`, any mesh.")
        .input("like", &MaskMesh::Ports::like, like_doc)
        .param("where", &Params::where,
               "inside: voxels whose centres the mesh encloses. near: voxels at most `distance` "
               "from a face, on either side.")
        .param("distance", &Params::distance, Unit::world, at_least(0),
               "Maximum distance from a face, for `where: near`.")
        .output("mask", &MaskMesh::Ports::mask, "The voxels in the mesh, or near its faces.")
        .kept();
}

namespace {

struct MaskSphere {
    struct Params {
        Vec3 center{};
        double radius = 0;
    };
    struct Ports {
        Ref<AnyGrid> like;
        Ref<MaskGrid> mask;
    };
    static void run(const Params& params, Ports& io, Context&) {
        io.mask = sphere_mask(*io.like->grid, Vec3d(params.center.data()), params.radius);
    }
};

}  // namespace

NodeType mask_sphere() {
    return Declare<MaskSphere>("mask.sphere",
                               "The voxels in a sphere: where seams are wanted, or kept out.")
        .input("like", &MaskSphere::Ports::like, like_doc)
        .required("center", &MaskSphere::Params::center, Unit::world, any_number(),
                  "Centre of the sphere.")
        .required("radius", &MaskSphere::Params::radius, Unit::world, at_least(0),
                  "Radius of the sphere; its border lies in it.")
        .output("mask", &MaskSphere::Ports::mask, "The voxels whose centres lie in the sphere.")
        .kept()
        .in_place();
}

namespace {

struct Threshold {
    struct Params {
        Auto<double> above, below;
    };
    struct Ports {
        Ref<FloatGrid> field;
        Ref<MaskGrid> mask;
    };
    static void check(const Params& params, NodeCheck& check) {
        if (!params.above && !params.below) check.fault("type", "needs 'above', 'below' or both");
        if (params.above && params.below && *params.above > *params.below)
            check.fault(
                "above",
                fmt::format("parameter 'above', {:g}, is higher than 'below', {:g}: no value fits",
                            *params.above, *params.below));
    }
    static void foresee(const Params&, Outlook& ahead) {
        const auto* const field = ahead.region("field");
        if (!field) return;
        if (field->boxes.empty())
            ahead.warn(
                "by their headers, the files that `field` comes from have no active voxels in any "
                "frame: the mask is empty");
        ahead.lies(*field);
    }
    static void run(const Params& params, Ports& io, Context&) {
        constexpr auto unbounded = std::numeric_limits<double>::infinity();
        const Interval wanted{params.above.value_or(-unbounded), params.below.value_or(unbounded)};
        const auto mask = threshold_mask(*io.field, wanted.low, wanted.high);
        if (mask->activeVoxelCount() == 0) {
            const auto values = openvdb::tools::minMax(io.field->tree());
            const bool none = io.field->activeVoxelCount() == 0;
            note_missed_range(*mask,
                              {wanted, none ? empty_range : Interval{values.min(), values.max()}});
        }
        io.mask = mask;
    }
};

}  // namespace

NodeType mask_threshold() {
    return Declare<Threshold>(
               "mask.threshold",
               "The voxels with a value in a range: where the smoke is, or where it is hot.")
        .input("field", &Threshold::Ports::field,
               "Density, temperature, flame or any other field. Only its active voxels can be in "
               "the mask.")
        .param("above", &Threshold::Params::above, Unit::none, any_number(),
               "Lowest value, in the field's unit. Auto: no bound.")
        .param("below", &Threshold::Params::below, Unit::none, any_number(),
               "Highest value, in the field's unit. Auto: no bound.")
        .output("mask", &Threshold::Ports::mask, "The voxels with a value in the range.")
        .kept()
        .in_place();
}

template <>
struct ChoiceNames<WeightMode> {
    static constexpr std::array names = {std::pair{"assign", WeightMode::assign},
                                         std::pair{"multiply", WeightMode::multiply}};
};

namespace {

struct Weight {
    struct Params {
        std::vector<float> weights;
        float outside = 1;
        WeightMode mode = WeightMode::assign;
    };
    struct Ports {
        Ref<FloatGrid> energy;
        List<MaskGrid> masks;
        Ref<FloatGrid> weighted;
    };
    static void check(const Params& params, NodeCheck& check) {
        if (const auto masks = check.connections("masks");
            masks > 0 && params.weights.size() != masks)
            check.fault(
                "weights",
                fmt::format("parameter 'weights' has {} numbers for {} masks; state one for each",
                            params.weights.size(), masks));
    }
    static void run(const Params& params, Ports& io, Context&) {
        std::vector<WeightedRegion> regions;
        for (std::size_t n = 0; n < io.masks.size(); ++n)
            regions.push_back({io.masks[n], params.weights[n]});
        io.weighted = weighted_energy(*io.energy, regions, params.outside, params.mode);
    }
};

}  // namespace

NodeType mask_weight() {
    return Declare<Weight>("mask.weight",
                           "Weights an energy by regions: high weights keep seams away, also from "
                           "empty space; low weights attract them.")
        .input(
            "energy", &Weight::Ports::energy,
            "An energy from 0 to 1, such as that of energy.combine with weights that add up to 1.")
        .input("masks", &Weight::Ports::masks,
               "The regions. Where they overlap, the later one counts.")
        .required("weights", &Weight::Params::weights, Unit::none, at_least(0),
                  "One weight per mask.")
        .param("outside", &Weight::Params::outside, Unit::none, at_least(0),
               "The weight outside of all masks.")
        .param("mode", &Weight::Params::mode,
               "assign: weight * (1 + energy) / 2, so that mainly the region decides. multiply: "
               "weight * energy.")
        .output("energy", &Weight::Ports::weighted, "The weighted energy.")
        .in_place();
}

}  // namespace fluidcarve
