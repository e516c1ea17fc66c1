#pragma once

#include "carve/base/failure.h"
#include "formats/seam_file/seam_file.h"

#include <openvdb/openvdb.h>
#include <catch2/catch.hpp>

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve::test {

/// A change to the volume of a seam file and to its grids, which are copies.
using SeamEdit = std::function<void(Volume&, std::vector<FloatGrid::Ptr>&)>;

/// Reads a seam file's volume after a change.
/// @return the message of the failure; empty: it was read
inline std::string fault_after(Volume volume, const SeamEdit& edit) {
    std::vector<FloatGrid::Ptr> grids;
    for (const auto& grid : volume.grids)
        grids.push_back(openvdb::GridBase::grid<FloatGrid>(grid->deepCopyGrid()));
    for (std::size_t n = 0; n < grids.size(); ++n) volume.grids[n] = grids[n];
    edit(volume, grids);
    try {
        seams_from_volume(volume);
    } catch (const Failure& failure) {
        CHECK(failure.kind == Failure::Kind::input);
        return failure.what();
    }
    return {};
}

/// States metadata anew. @param value  empty: no such metadata
inline void restate(Volume& volume, const char* name, const std::string& value) {
    volume.metadata.removeMeta(name);
    if (!value.empty()) volume.metadata.insertMeta(name, openvdb::StringMetadata(value));
}

}  // namespace fluidcarve::test
