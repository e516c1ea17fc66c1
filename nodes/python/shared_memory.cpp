#include "nodes/python/shared_memory.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>

namespace fluidcarve {
namespace {

/// It grows in steps, so that frames of nearly one size do not map it again.
constexpr std::uint64_t memory_step = std::uint64_t{4} << 20;

[[noreturn]] void refuse_memory(std::uint64_t bytes) {
    throw Failure(fmt::format("the system gives no {} of shared memory: {}", size_text(bytes),
                              std::strerror(errno)));
}

}  // namespace

SharedMemory::SharedMemory() : file_(memfd_create("fluidcarve", MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    // If the other process made it smaller, this one would crash.
    if (file_ < 0 || fcntl(file_, F_ADD_SEALS, F_SEAL_SHRINK) != 0) refuse_memory(0);
}

SharedMemory::~SharedMemory() {
    if (data_) munmap(data_, size_);
    if (file_ >= 0) close(file_);
}

void SharedMemory::map(std::uint64_t bytes) {
    if (data_) munmap(data_, size_);
    data_ = nullptr;
    size_ = 0;
    auto* const mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    if (mapped == MAP_FAILED) refuse_memory(bytes);
    data_ = static_cast<std::byte*>(mapped);
    size_ = bytes;
}

std::byte* SharedMemory::grown(std::uint64_t bytes) {
    if (bytes <= size_ && data_) return data_;
    bytes = (bytes / memory_step + 1) * memory_step;
    if (ftruncate(file_, static_cast<off_t>(bytes)) != 0) refuse_memory(bytes);
    map(bytes);
    return data_;
}

const std::byte* SharedMemory::seen(std::uint64_t bytes) {
    struct stat now {};
    if (fstat(file_, &now) != 0 || static_cast<std::uint64_t>(now.st_size) < bytes)
        throw Failure("the worker handed over less than it said");
    if (bytes > size_ || !data_) map(static_cast<std::uint64_t>(now.st_size));
    return data_;
}

}  // namespace fluidcarve
