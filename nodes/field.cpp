#include "nodes/field.h"

#include "carve/field/collocate.h"
#include "carve/field/curl.h"
#include "carve/field/curvature.h"
#include "carve/field/filter.h"
#include "carve/field/gradient.h"
#include "carve/field/jacobian.h"
#include "carve/field/laplacian.h"
#include "carve/field/magnitude.h"
#include "carve/field/stencil.h"
#include "carve/volume/volume.h"
#include "graph/types/node_type.h"

namespace fluidcarve {

namespace {

/// A node that computes a field by a stencil.
/// @tparam compute  makes it of a `Ref<From>`
template <class From, class To, auto compute>
struct FieldOf {
    struct Params {};
    struct Ports {
        Ref<From> field;
        Ref<To> result;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_stencil_fits(*io.field, sizeof(typename To::ValueType), context.limits().memory);
        io.result = compute(io.field);
    }
};
using FieldCurl = FieldOf<VectorGrid, VectorGrid, curl_field>;
using FieldCurvature =
    FieldOf<FloatGrid, FloatGrid, [](const auto& field) { return curvature_field(*field); }>;
using FieldGradient =
    FieldOf<FloatGrid, VectorGrid, [](const auto& field) { return gradient_field(*field); }>;
using FieldLaplacian =
    FieldOf<FloatGrid, FloatGrid, [](const auto& field) { return laplacian_field(*field); }>;

struct FieldCollocate {
    struct Params {};
    struct Ports {
        Ref<VectorGrid> velocity, collocated;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_collocation_fits(*io.velocity, context.limits().memory);
        io.collocated = collocated(io.velocity);
    }
};

}  // namespace

NodeType field_collocate() {
    return Declare<FieldCollocate>(
               "field.collocate",
               "Moves a staggered velocity from the voxels' faces to their centres.")
        .input("velocity", &FieldCollocate::Ports::velocity,
               "Velocity, any unit. A grid that is not staggered passes unchanged.")
        .output("velocity", &FieldCollocate::Ports::collocated,
                "The mean of each voxel's two faces along each axis, on the active voxels of "
                "`velocity`.")
        .kept();
}

NodeType field_curl() {
    return Declare<FieldCurl>(
               "field.curl",
               "The curl of a velocity: the axis of the flow's rotation, and twice its rate.")
        .input("velocity", &FieldCurl::Ports::field,
               "Velocity, world units per second; staggered grids are collocated.")
        .output("curl", &FieldCurl::Ports::result,
                "curl velocity, 1/s, on the active voxels of `velocity`.")
        .kept();
}

NodeType field_curvature() {
    return Declare<FieldCurvature>("field.curvature",
                                   "Curvature of a field's level surfaces: the sum of the two "
                                   "principal curvatures, div (grad field / |grad field|).")
        .input("field", &FieldCurvature::Ports::field,
               "A level set, or any field: its level surfaces count.")
        .output("curvature", &FieldCurvature::Ports::result,
                "1 per world unit, on the field's active voxels: 2 / radius on a ball, above 0 "
                "where a level set bulges outward. It is 0 where a neighbour is inactive, and "
                "limited to that of a ball with a radius of one voxel.")
        .kept()
        .in_place();
}

namespace {

struct FieldFilter {
    struct Params {
        FilterMode mode = FilterMode::mean;
        int width = 1;
        int iterations = 1;
    };
    struct Ports {
        Ref<FloatGrid> field, filtered;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        require_stencil_fits(*io.field, sizeof(float), context.limits().memory);
        io.filtered = filtered_field(*io.field, params.mode, params.width, params.iterations);
    }
};

}  // namespace

NodeType field_filter() {
    return Declare<FieldFilter>(
               "field.filter",
               "Smooths a field, so that an energy made of it follows its large shapes.")
        .input("field", &FieldFilter::Ports::field, "Density, an energy or any other field.")
        .param("mode", &FieldFilter::Params::mode,
               "mean: of a cube of voxels. median: of that cube; removes specks, keeps edges. "
               "gaussian: four means in a row, within 5 % of a true Gaussian.")
        .param(
            "width", &FieldFilter::Params::width, Unit::voxels, between(1, 64),
            "Distance from the middle of the cube to its sides: 1 is a cube of 3 x 3 x 3 voxels.")
        .param("iterations", &FieldFilter::Params::iterations, Unit::none, between(1, 100),
               "How often the filter is applied.")
        .output("filtered", &FieldFilter::Ports::filtered,
                "The smoothed field, in its unit, on its active voxels. Inactive voxels count with "
                "their stored value, and keep it.")
        .kept()
        .in_place();
}

NodeType field_gradient() {
    return Declare<FieldGradient>(
               "field.gradient",
               "The gradient of a field: the direction and steepness of its rise.")
        .input("field", &FieldGradient::Ports::field, "Density, temperature or any other field.")
        .output("gradient", &FieldGradient::Ports::result,
                "grad field, units of `field` per world unit, on its active voxels.")
        .kept()
        .in_place();
}

NodeType field_laplacian() {
    return Declare<FieldLaplacian>(
               "field.laplacian",
               "The Laplacian of a field, div grad: below 0 on peaks, above 0 in pits.")
        .input("field", &FieldLaplacian::Ports::field, "Density, temperature or any other field.")
        .output("laplacian", &FieldLaplacian::Ports::result,
                "Units of `field` per square world unit, on its active voxels.")
        .kept()
        .in_place();
}

namespace {

struct FieldMagnitude {
    struct Params {};
    struct Ports {
        Ref<VectorGrid> vectors;
        Ref<FloatGrid> magnitude;
    };
    static void run(const Params&, Ports& io, Context& context) {
        require_collocation_fits(*io.vectors, context.limits().memory);
        io.magnitude = magnitude_field(io.vectors);
    }
};

}  // namespace

NodeType field_magnitude() {
    return Declare<FieldMagnitude>("field.magnitude",
                                   "The length of each vector: speed from velocity.")
        .input("vectors", &FieldMagnitude::Ports::vectors,
               "Velocity or any other vectors; staggered grids are collocated.")
        .output("magnitude", &FieldMagnitude::Ports::magnitude,
                "Length, in the unit of `vectors`, on their active voxels.")
        .in_place();
}

}  // namespace fluidcarve
