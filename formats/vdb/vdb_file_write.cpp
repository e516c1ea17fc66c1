#include "carve/base/failure.h"
#include "carve/stream/openvdb_types.h"
#include "carve/stream/raw_grid.h"
#include "carve/volume/triplet.h"
#include "formats/file/output_file.h"
#include "formats/vdb/vdb_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/Compression.h>

#include <algorithm>
#include <fstream>

namespace fluidcarve {
namespace {

std::uint32_t flags(const std::string& codec) {
    using namespace openvdb::io;
    if (codec == "none") return COMPRESS_ACTIVE_MASK;
    if (codec == "zip") return COMPRESS_ACTIVE_MASK | COMPRESS_ZIP;
    return COMPRESS_ACTIVE_MASK | COMPRESS_BLOSC;
}

/// The compression flags that OpenVDB uses for a grid in a file with these flags.
std::uint32_t flags_of_grid(std::uint32_t flags, const openvdb::GridBase& grid) {
    const bool unzipped = grid.getGridClass() == openvdb::GRID_LEVEL_SET ||
                          grid.getGridClass() == openvdb::GRID_FOG_VOLUME;
    return unzipped ? flags & ~static_cast<std::uint32_t>(openvdb::io::COMPRESS_ZIP) : flags;
}

/// Writes as openvdb::io::File, but into a stream of the caller: File does not notice errors of
/// the system.
struct Writer : openvdb::io::Archive {
    using Archive::write;
};

std::string name(Codec codec, const Volume& volume) {
    switch (codec) {
        case Codec::as_read: break;
        case Codec::blosc: return "blosc";
        case Codec::zip: return "zip";
        case Codec::none: return "none";
    }
    return volume.codec.empty() ? "blosc" : volume.codec;
}

/// How the file compresses its grids. Those of unknown types stay as they were.
std::uint32_t flags_for(const std::vector<openvdb::GridBase::ConstPtr>& grids, Codec codec,
                        const Volume& volume, const std::string& path) {
    auto out = flags(name(codec, volume));
    for (const auto& grid : grids) {
        const auto* const raw = RawGrid::of(*grid);
        if (!raw) continue;
        if (codec == Codec::as_read) out = raw->compression();
        if (raw->compression() != flags_of_grid(out, *grid))
            throw Failure(
                fmt::format("cannot write {}: grid '{}' is of type {}, which OpenVDB does not "
                            "know, and can't be compressed again; set 'compression: as_read', or "
                            "leave it out",
                            path, grid->getName(), grid->type()));
    }
    return out;
}

}  // namespace

VdbHeader write_vdb(const std::string& path, const Volume& volume, Codec codec,
                    const Placement* placement) {
    register_openvdb_types();
    std::vector<openvdb::GridBase::ConstPtr> grids;
    for (const auto& grid : volume.grids)
        for (const auto& part : split(grid)) grids.push_back(unplaced(part, placement));
    OutputFile output(path);
    const auto file_flags = flags_for(grids, codec, volume, path);
    try {
        Writer writer;
        writer.setCompression(file_flags);
        std::ofstream out(output.aside(), std::ios::binary);
        writer.write(out, grids, /*seekable=*/true, volume.metadata);
        output.close(out);
    } catch (const openvdb::Exception& error) {
        throw Failure(fmt::format("cannot write {}: {}", path, error.what()));
    }
    VdbHeader header;
    try {
        header = read_vdb_header(output.aside());
    } catch (const Failure&) {
        throw output.not_whole();
    }
    const auto same = [](const VdbHeader::Entry& written, const openvdb::GridBase::ConstPtr& grid) {
        return written.name == grid->getName() && written.type == grid->type();
    };
    if (!std::ranges::equal(header.grids, grids, same))
        throw Failure(fmt::format("cannot write {}: it holds {} instead of {}", path,
                                  fmt::join(header.names(), ", "), volume.names()));
    output.commit();
    header.path = path;
    return header;
}

}  // namespace fluidcarve
