#include "carve/stream/transform_bytes.h"

#include "carve/stream/openvdb_types.h"

#include <openvdb/io/io.h>
#include <openvdb/math/Maps.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <sstream>
#include <string_view>

namespace fluidcarve {
namespace {

/// Checks the lengths of map names, which OpenVDB trusts.
void require_names_fit(std::string_view bytes) {
    const auto name_at = [&](std::size_t at) {
        std::uint32_t length = 0;
        BinaryReader::require(bytes.size() >= at + sizeof length);
        std::memcpy(&length, bytes.data() + at, sizeof length);
        BinaryReader::require(length <= bytes.size() - at - sizeof length);
        return bytes.substr(at + sizeof length, length);
    };
    const auto frustum = openvdb::math::NonlinearFrustumMap::mapType();
    constexpr auto taper_and_depth = 2 * sizeof(double);
    if (const auto name = name_at(0); name == frustum)
        BinaryReader::require(name_at(sizeof(std::uint32_t) + name.size() + sizeof(openvdb::BBoxd) +
                                      taper_and_depth) != frustum);
}

}  // namespace

void write_transform(const openvdb::math::Transform& transform, BinaryWriter& to) {
    std::ostringstream bytes;
    transform.write(bytes);
    to.text(bytes.str());
}

openvdb::math::Transform::Ptr read_transform(BinaryReader& from) {
    register_openvdb_types();
    const auto text = from.text();
    require_names_fit(text);
    std::istringstream bytes(text);
    bytes.exceptions(std::ios_base::failbit | std::ios_base::badbit | std::ios_base::eofbit);
    // The bytes have no header with the version that OpenVDB needs.
    openvdb::io::setCurrentVersion(bytes);
    const auto out = std::make_shared<openvdb::math::Transform>();
    try {
        out->read(bytes);
    } catch (const std::exception&) {
        BinaryReader::require(false);
    }
    return out;
}

}  // namespace fluidcarve
