#include "nodes/seams/frame_store.h"

#include "graph/confinement.h"
#include "graph/text/problem.h"
#include "graph/text/words.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace fluidcarve {

namespace {

/// Six of these at the end of a name: mkostemp replaces them.
const std::string unique_part(6, 'X');

// Allocates the space at once: otherwise a full disk would kill the process later, without a message.
int scratch_file(const std::string& folder, std::size_t bytes) {
    const auto fault = [&](int code) {
        return Failure(fmt::format(
            "{} of energies or seams exceed the memory budget and can't be stored in the work folder '{}': {}; raise --memory or choose another --work",
            size_text(bytes), folder, std::strerror(code)));
    };
    if (const auto refusal = Confinement::of_program().refusal(folder); !refusal.empty())
        throw Failure(fmt::format("the work folder '{}' {}", folder, refusal));
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    auto path = folder + "/frames." + unique_part;
    const int file = mkostemp(path.data(), O_CLOEXEC);
    if (file < 0) throw fault(errno);
    unlink(path.c_str());
    if (const int code = posix_fallocate(file, 0, static_cast<off_t>(bytes)); code != 0) {
        close(file);
        throw fault(code);
    }
    return file;
}

}  // namespace

FrameStore::FrameStore(std::size_t count, std::size_t entries, std::uint64_t memory_budget, const std::string& folder) : count_(count), entries_(entries) {
    std::size_t bytes = 0;
    if (__builtin_mul_overflow(count, entries, &bytes) || __builtin_mul_overflow(bytes, sizeof(std::uint16_t), &bytes) || bytes > PTRDIFF_MAX)
        throw Failure(fmt::format("{} frames of {} energies each are more than any memory holds; use a coarser or smaller lattice", count, entries));
    on_disk_ = bytes > memory_budget;
    if (bytes == 0) return;
    const int file = on_disk_ ? scratch_file(folder, bytes) : -1;
    void* const at = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, on_disk_ ? MAP_SHARED : MAP_PRIVATE | MAP_ANONYMOUS, file, 0);
    const int code = errno;
    if (file >= 0) close(file);
    if (at == MAP_FAILED) throw Failure(fmt::format("can't get memory for {} of energies or seams: {}", size_text(bytes), std::strerror(code)));
    if (!on_disk_) madvise(at, bytes, MADV_HUGEPAGE);
    data_ = {static_cast<std::uint16_t*>(at), Unmap{bytes}};
}

void FrameStore::Unmap::operator()(std::uint16_t* data) const { munmap(data, bytes); }

}  // namespace fluidcarve
