#pragma once

#include "formats/file/provenance.h"

#include <openvdb/openvdb.h>

namespace fluidcarve {

/// Puts provenance into the metadata of a VDB file, in place of what is there.
void set_provenance(openvdb::MetaMap& metadata, const Provenance& provenance);

/// The provenance in the metadata of a VDB file.
Provenance provenance_in(const openvdb::MetaMap& metadata);

}  // namespace fluidcarve
