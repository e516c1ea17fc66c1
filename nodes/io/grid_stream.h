#pragma once

#include "nodes/io/binary.h"
#include "nodes/io/origin.h"
#include "nodes/payloads.h"

#include <cstdint>
#include <istream>
#include <map>
#include <ostream>
#include <vector>

namespace fluidcarve {

/// Writes grids as they are in memory, to the last bit, for a program that goes on with them. A .vdb file (vdb_file.h) is for others to
/// read: it rounds the values of a grid that says that it is kept as half floats, and drops the signs of zeros and where a grid came from
/// (origin.h); this keeps them. Metadata that lives in memory only is left out but for the origin.
/// A tree that several grids of one writer share is written once; the grids live as long as their writer.
class GridWriter {
public:
    explicit GridWriter(std::ostream& to);
    void write(const openvdb::GridBase& grid);

private:
    void write(const Origin& origin, const openvdb::TreeBase& tree);
    void write_tree(const openvdb::GridBase& grid);

    std::ostream& to_;
    std::ostream out_;  ///< to the same place: the library leaves marks on a stream
    BinaryWriter binary_;
    std::map<const openvdb::TreeBase*, std::uint64_t> trees_;  ///< those written, by their number
};

/// Reads what a GridWriter wrote, in the same order. Shared trees are shared again.
class GridReader {
public:
    explicit GridReader(std::istream& from);
    /// @throws Failure where no grid was written, or a part of one
    openvdb::GridBase::Ptr read();
    /// The same if it is of this type. @throws Failure also if it is not
    template <class Grid>
    typename Grid::Ptr read() {
        auto out = openvdb::gridPtrCast<Grid>(read());
        BinaryReader::require(out != nullptr);
        return out;
    }

private:
    openvdb::GridBase::Ptr read_grid(int depth);
    Origin read_origin(const openvdb::TreeBase::ConstPtr& tree, int depth);
    void read_tree(openvdb::GridBase& grid);

    std::istream in_;
    BinaryReader binary_;
    std::vector<openvdb::TreeBase::Ptr> trees_;
};

/// But for what lives in memory only.
void write_metadata(const openvdb::MetaMap& metadata, BinaryWriter& out);
openvdb::MetaMap read_metadata(BinaryReader& in);

}  // namespace fluidcarve
