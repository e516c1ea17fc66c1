#include "carve/time/spill_file.h"

#include "carve/base/failure.h"
#include "carve/base/scratch_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace fluidcarve {

SpillFile::Place SpillFile::add(std::string_view bytes) {
    if (file_.number < 0) file_.number = scratch_file(folder_, "frames", 0);
    const Place out{end_, bytes.size()};
    if (!write_at(file_.number, out.begin, bytes.data(), out.size))
        throw no_room_for_scratch(folder_, "frames", 0, errno);
    end_ += out.size;
    return out;
}

std::string SpillFile::at(const Place& place) const {
    std::string out(place.size, '\0');
    if (!read_at(file_.number, place.begin, out.data(), out.size()))
        throw Failure(
            fmt::format("a frame that was stored in the work folder '{}' can't be read: {}",
                        folder_, std::strerror(errno)));
    return out;
}

}  // namespace fluidcarve
