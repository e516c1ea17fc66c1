#pragma once

#include "carve/stream/binary.h"
#include "carve/volume/stored_form.h"
#include "carve/volume/volume.h"

#include <cstdint>
#include <istream>
#include <map>
#include <ostream>
#include <vector>

namespace fluidcarve {

/// Writes grids bit for bit as in memory, for the cache. Unlike a .vdb file (vdb_file.h) it does
/// not round grids that are marked as half floats, and keeps signs of zeros and the stored form of
/// grids (stored_form.h). Other metadata that exists only in memory is left out. A tree shared by
/// several grids is written once. The grids must outlive the writer.
class GridWriter {
public:
    explicit GridWriter(std::ostream& to);
    void write(const openvdb::GridBase& grid);

private:
    void write(const StoredForm& stored, const openvdb::TreeBase& tree);
    void write_tree(const openvdb::GridBase& grid);

    std::ostream& to_;
    std::ostream out_;  ///< same buffer as `to_`: OpenVDB attaches its own data to this stream
    BinaryWriter binary_;
    std::map<const openvdb::TreeBase*, std::uint64_t> trees_;  ///< written trees and their numbers
};

/// Reads what a GridWriter wrote, in the same order, from a stream that can seek. Shared trees are
/// shared again.
class GridReader {
public:
    explicit GridReader(std::istream& from);
    /// @throws Failure if the stream holds no whole grid
    openvdb::GridBase::Ptr read();
    /// The same for a grid of this type. @throws Failure also if it has another type
    template <class Grid>
    typename Grid::Ptr read() {
        auto out = openvdb::gridPtrCast<Grid>(read());
        BinaryReader::require(out != nullptr);
        return out;
    }

private:
    openvdb::GridBase::Ptr read_grid(int depth);
    StoredForm read_stored_form(const openvdb::TreeBase::ConstPtr& tree, int depth);
    void read_tree(openvdb::GridBase& grid);

    std::istream in_;
    BinaryReader binary_;
    std::vector<openvdb::TreeBase::Ptr> trees_;
};

/// Writes all metadata except what exists only in memory.
void write_metadata(const openvdb::MetaMap& metadata, BinaryWriter& out);
openvdb::MetaMap read_metadata(BinaryReader& in);

}  // namespace fluidcarve
