#include "carve/stream/openvdb_types.h"

#include <openvdb/openvdb.h>
#include <openvdb/points/AttributeArray.h>

#include <cstdint>
#include <mutex>

namespace fluidcarve {

void register_openvdb_types() {
    static std::once_flag once;
    std::call_once(once, [] {
        openvdb::initialize();
        // Used by Blender's liquid caches in half precision, but not registered by OpenVDB.
        using HalfInt =
            openvdb::points::TypedAttributeArray<std::int32_t, openvdb::points::TruncateCodec>;
        if (!HalfInt::isRegistered()) HalfInt::registerType();
    });
}

}  // namespace fluidcarve
