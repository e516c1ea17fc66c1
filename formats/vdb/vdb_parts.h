#pragma once

#include "carve/stream/raw_grid.h"
#include "formats/file/input_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/math/Maps.h>

namespace fluidcarve {

/// Requires that OpenVDB's own metadata of a grid has the types that OpenVDB expects: otherwise it
/// fails at the next change of the grid.
/// @throws std::runtime_error
void check_own_metadata(const openvdb::GridBase& grid);

/// A stream buffer over a part of a file in memory. Positions are those in the file.
class PartBuffer : public std::streambuf {
public:
    /// @param at  position of the part in the file
    PartBuffer(std::string& part, std::int64_t at) : at_(at) {
        setg(part.data(), part.data(), part.data() + part.size());
    }

protected:
    pos_type seekoff(off_type by, std::ios_base::seekdir from,
                     std::ios_base::openmode mode) override {
        const auto base =
            from == std::ios_base::beg
                ? off_type{0}
                : at_ + (from == std::ios_base::cur ? gptr() - eback() : egptr() - eback());
        off_type to = 0;
        return __builtin_add_overflow(base, by, &to) ? pos_type(off_type(-1)) : seekpos(to, mode);
    }
    pos_type seekpos(pos_type to, std::ios_base::openmode) override {
        if (to < pos_type(at_) || to > pos_type(at_ + (egptr() - eback())))
            return pos_type(off_type(-1));
        setg(eback(), eback() + (off_type(to) - at_), egptr());
        return to;
    }

private:
    std::int64_t at_;
};

/// Whether the numbers of a linear map are consistent: files store its scale, voxel size and
/// inverse redundantly, and OpenVDB trusts each.
bool agrees_with_itself(const openvdb::math::Transform& transform);

}  // namespace fluidcarve
