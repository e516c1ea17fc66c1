#include "carve/time/volume_store.h"

#include "carve/base/failure.h"
#include "carve/base/scratch_file.h"
#include "carve/base/values.h"
#include "carve/stream/volume_stream.h"

#include <fmt/format.h>

#include <unistd.h>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <sstream>

namespace fluidcarve {

VolumeStore::~VolumeStore() {
    if (file_ >= 0) close(file_);
}

void VolumeStore::add(const Ref<Volume>& volume) {
    if (const auto bytes = bytes_of(*volume); held_ + bytes <= budget_) {
        held_ += bytes;
        entries_.push_back({volume, 0, 0});
        return;
    }
    if (file_ < 0) file_ = scratch_file(folder_, "frames", 0);
    std::ostringstream stream;
    write_volume(*volume, stream);
    const auto bytes = std::move(stream).str();
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
    entries_.push_back({nullptr, end_, static_cast<std::int64_t>(bytes.size())});
    end_ += static_cast<std::int64_t>(bytes.size());
}

Ref<Volume> VolumeStore::at(std::size_t n) const {
    const auto& [held, begin, size] = entries_.at(n);
    if (held) return held;
    std::string bytes(static_cast<std::size_t>(size), '\0');
    for (std::size_t done = 0; done < bytes.size();) {
        const auto got = pread(file_, bytes.data() + done, bytes.size() - done,
                               begin + static_cast<std::int64_t>(done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            throw Failure(
                fmt::format("a frame that was stored in the work folder '{}' can't be read: {}",
                            folder_, std::strerror(errno)));
        done += static_cast<std::size_t>(got);
    }
    std::istringstream stream(std::move(bytes));
    return read_volume(stream);
}

}  // namespace fluidcarve
