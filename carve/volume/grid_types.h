#pragma once

#include <openvdb/openvdb.h>

/// The grid types that can be carved: OpenVDB's standard types, without points.
#define FLUIDCARVE_EACH_GRID_TYPE(visit)                                            \
    visit(openvdb::FloatGrid) visit(openvdb::DoubleGrid) visit(openvdb::Int32Grid)  \
        visit(openvdb::Int64Grid) visit(openvdb::BoolGrid) visit(openvdb::MaskGrid) \
            visit(openvdb::Vec3SGrid) visit(openvdb::Vec3DGrid) visit(openvdb::Vec3IGrid)
