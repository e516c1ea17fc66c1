#include "carve/base/descriptor.h"

#include <unistd.h>
#include <cerrno>

namespace fluidcarve {

namespace {

/// Calls `step(done)`, which moves bytes from there and returns how many, until `size` are done.
template <class Step>
bool move_all(std::size_t size, const Step& step) {
    for (std::size_t done = 0; done < size;) {
        const auto moved = step(done);
        if (moved < 0 && errno == EINTR) continue;
        if (moved <= 0) return false;
        done += static_cast<std::size_t>(moved);
    }
    return true;
}

}  // namespace

Descriptor::~Descriptor() {
    if (number >= 0) close(number);
}

bool read_at(int file, std::uint64_t offset, void* into, std::size_t size) {
    return move_all(size, [&](std::size_t done) {
        return pread(file, static_cast<char*>(into) + done, size - done,
                     static_cast<off_t>(offset + done));
    });
}

bool write_at(int file, std::uint64_t offset, const void* from, std::size_t size) {
    return move_all(size, [&](std::size_t done) {
        return pwrite(file, static_cast<const char*>(from) + done, size - done,
                      static_cast<off_t>(offset + done));
    });
}

}  // namespace fluidcarve
