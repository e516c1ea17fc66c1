#include "carve/time/spill_file.h"

#include "carve/base/failure.h"
#include "carve/base/scratch_file.h"

#include <fmt/format.h>

#include <unistd.h>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace fluidcarve {

SpillFile::~SpillFile() {
    if (file_ >= 0) close(file_);
}

SpillFile::Place SpillFile::add(std::string_view bytes) {
    if (file_ < 0) file_ = scratch_file(folder_, "frames", 0);
    for (std::size_t done = 0; done < bytes.size();) {
        const auto wrote = pwrite(file_, bytes.data() + done, bytes.size() - done,
                                  end_ + static_cast<std::int64_t>(done));
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0)
            throw Failure(
                fmt::format("frames exceed the memory budget and can't be stored in the work "
                            "folder '{}': {}; raise --memory or choose another --work",
                            folder_, std::strerror(errno)));
        done += static_cast<std::size_t>(wrote);
    }
    const Place out{end_, bytes.size()};
    end_ += static_cast<std::int64_t>(bytes.size());
    return out;
}

std::string SpillFile::at(const Place& place) const {
    std::string out(place.size, '\0');
    for (std::size_t done = 0; done < out.size();) {
        const auto got = pread(file_, out.data() + done, out.size() - done,
                               place.begin + static_cast<std::int64_t>(done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            throw Failure(
                fmt::format("a frame that was stored in the work folder '{}' can't be read: {}",
                            folder_, std::strerror(errno)));
        done += static_cast<std::size_t>(got);
    }
    return out;
}

}  // namespace fluidcarve
