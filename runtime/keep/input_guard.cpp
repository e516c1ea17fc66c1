#include "runtime/keep/input_guard.h"

#include "carve/base/failure.h"
#include "runtime/keep/file_hashes.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <sys/stat.h>
#include <exception>

namespace fluidcarve {
namespace {

/// Hash of a file's device, inode, size and times; zero if there is no file.
Hash state_of(const std::string& path) {
    struct stat file {};
    if (stat(path.c_str(), &file) != 0) return {};
    return Hasher().number(file.st_dev).hash(stamp_of(file)).digest();
}

}  // namespace

InputGuard::InputGuard(Manifest* manifest, const std::vector<std::string>& paths)
    : manifest_(manifest) {
    tbb::parallel_for(std::size_t{0}, paths.size(), [&](std::size_t n) { require_same(paths[n]); });
}

Hash InputGuard::require_same(const std::string& path) {
    const auto now = state_of(path);
    const auto name = Hasher().text(path).digest();
    const std::lock_guard lock(mutex_);
    if (states_.try_emplace(name, now).first->second != now)
        throw Failure(
            fmt::format("{} was changed while the run was on; run again when its writer is done",
                        path),
            Failure::Kind::input);
    return now;
}

void InputGuard::read(const std::vector<std::string>& paths, const std::function<void()>& body) {
    for (const auto& path : paths)
        if (require_same(path) && manifest_) manifest_->require(path);
    const auto require_all = [&] {
        for (const auto& path : paths) require_same(path);
    };
    try {
        body();
    } catch (const std::exception&) {
        // A file that is being replaced often looks damaged.
        require_all();
        throw;
    }
    require_all();
}

}  // namespace fluidcarve
