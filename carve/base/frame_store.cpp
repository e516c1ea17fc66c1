#include "carve/base/frame_store.h"

#include "carve/base/failure.h"
#include "carve/base/scratch_file.h"
#include "carve/base/words.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace fluidcarve {

namespace {

/// Stores of up to this many bytes come from the allocator, which hands the same memory to one
/// store after the other. Fresh pages of the system would take longer than the work on them.
constexpr std::size_t most_reused = std::size_t{1} << 25;

}  // namespace

template <class Entry>
FrameStoreOf<Entry>::FrameStoreOf(std::size_t count, std::size_t entries, const Limits& limits)
    : count_(count), entries_(entries) {
    std::size_t bytes = 0;
    if (__builtin_mul_overflow(count, entries, &bytes) ||
        __builtin_mul_overflow(bytes, sizeof(Entry), &bytes) || bytes > PTRDIFF_MAX)
        throw Failure(
            fmt::format("{} frames of {} values each are more than any memory holds; use a coarser "
                        "or smaller lattice",
                        count, entries));
    const bool on_disk = bytes > limits.memory;
    if (bytes == 0) return;
    const auto fault = [&](int code) {
        return Failure(
            fmt::format("can't get memory for {} of energies, seams or displacements: {}",
                        size_text(bytes), std::strerror(code)));
    };
    if (!on_disk && bytes <= most_reused) {
        data_ = {static_cast<Entry*>(std::calloc(bytes, 1)), Release{0}};
        if (!data_) throw fault(ENOMEM);
        return;
    }
    const int file =
        on_disk ? scratch_file(limits.folder, "energies, seams or displacements", bytes) : -1;
    void* const at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                          on_disk ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS, file, 0);
    const int code = errno;
    if (file >= 0) close(file);
    if (at == MAP_FAILED) throw fault(code);
    if (!on_disk) madvise(at, bytes, MADV_HUGEPAGE);
    data_ = {static_cast<Entry*>(at), Release{bytes}};
}

template <class Entry>
void FrameStoreOf<Entry>::Release::operator()(Entry* data) const {
    if (mapped > 0) munmap(data, mapped);
    else std::free(data);
}

template class FrameStoreOf<std::uint16_t>;
template class FrameStoreOf<float>;

}  // namespace fluidcarve
