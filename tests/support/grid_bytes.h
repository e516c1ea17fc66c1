#pragma once

#include <openvdb/io/Compression.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <map>
#include <sstream>
#include <string>

namespace fluidcarve::test {

/// All of a tree as bytes: values (inactive ones too), active states, tiles, structure, point
/// attributes.
/// Two trees with equal bytes are equal bit for bit.
inline std::string bytes(const openvdb::TreeBase& tree) {
    std::ostringstream out;
    auto tags = std::make_shared<openvdb::io::StreamMetadata>();
    openvdb::io::setStreamMetadataPtr(out, tags, false);
    openvdb::io::setDataCompression(out, openvdb::io::COMPRESS_NONE);
    tree.writeTopology(out, false);
    // Points are written in several passes, of which the first only counts them; other trees are
    // whole after that one.
    tags->setCountingPasses(true);
    tree.writeBuffers(out, false);
    tags->setCountingPasses(false);
    const auto passes = tags->pass();
    for (std::uint32_t pass = 0; pass < passes; ++pass) {
        tags->setPass(passes << 16 | pass);
        tree.writeBuffers(out, false);
    }
    return out.str();
}

inline std::string bytes(const openvdb::math::Transform& transform) {
    std::ostringstream out;
    transform.write(out);
    return out.str();
}

/// Metadata as type and bytes by name, but for the writer's own statistics.
inline std::map<std::string, std::string> kept_metadata(const openvdb::MetaMap& map) {
    std::map<std::string, std::string> out;
    for (auto each = map.beginMeta(); each != map.endMeta(); ++each) {
        if (each->first.starts_with("file_") && each->first != "file_voxel_size" &&
            each->first != "file_base_resolution")
            continue;
        std::ostringstream text;
        each->second->write(text);
        out[each->first] = each->second->typeName() + ' ' + text.str();
    }
    return out;
}

/// What differs between two grids, in words; empty if nothing does.
inline std::string difference(const openvdb::GridBase& a, const openvdb::GridBase& b) {
    if (a.getName() != b.getName()) return "name: " + a.getName() + " and " + b.getName();
    if (a.type() != b.type()) return "type: " + a.type() + " and " + b.type();
    if (a.getGridClass() != b.getGridClass()) return "class of " + a.getName();
    if (a.getVectorType() != b.getVectorType()) return "vector type of " + a.getName();
    if (a.saveFloatAsHalf() != b.saveFloatAsHalf()) return "half flag of " + a.getName();
    if (bytes(a.transform()) != bytes(b.transform())) return "transform of " + a.getName();
    if (kept_metadata(a) != kept_metadata(b)) return "metadata of " + a.getName();
    if (bytes(a.constBaseTree()) != bytes(b.constBaseTree())) return "tree of " + a.getName();
    return {};
}

}  // namespace fluidcarve::test
