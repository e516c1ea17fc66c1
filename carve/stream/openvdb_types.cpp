#include "carve/stream/openvdb_types.h"

#include <openvdb/openvdb.h>
#include <openvdb/points/AttributeArray.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <sstream>

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

openvdb::Metadata::Ptr metadata_of(const std::string& type, std::string_view value) {
    const auto out = openvdb::Metadata::isRegisteredType(type)
                         ? openvdb::Metadata::createMetadata(type)
                         : std::make_shared<openvdb::UnknownMetadata>(type);
    const auto size = static_cast<std::uint32_t>(value.size());
    std::istringstream bytes(
        std::string(reinterpret_cast<const char*>(&size), sizeof size).append(value));
    // Some types of OpenVDB read a number of bytes of their own, whatever number is stated.
    out->read(bytes);
    return out->size() == size ? out : nullptr;
}

}  // namespace fluidcarve
