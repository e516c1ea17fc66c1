#pragma once

#include "formats/vdb/vdb_file.h"

#include <string>

namespace fluidcarve {

/// Reads one grid of a file. @param name  as in VdbHeader::place
inline openvdb::GridBase::Ptr read_vdb_grid(const std::string& path, const std::string& name) {
    VdbFile file(path);
    return file.read(file.header().place(name));
}

}  // namespace fluidcarve
