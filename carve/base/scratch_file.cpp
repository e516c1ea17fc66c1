#include "carve/base/scratch_file.h"

#include "carve/base/failure.h"
#include "carve/base/words.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace fluidcarve {
namespace {

/// Six of these at the end of a name: mkostemp replaces them.
const std::string unique_part(6, 'X');

}  // namespace

Failure no_room_for_scratch(const std::string& folder, const std::string& what, std::size_t bytes,
                            int code) {
    return Failure(fmt::format(
        "{}{} exceed the memory budget and can't be stored in the work folder '{}': {}; raise "
        "--memory or choose another --work",
        bytes > 0 ? size_text(bytes) + " of " : "", what, folder, std::strerror(code)));
}

int scratch_file(const std::string& folder, const std::string& what, std::size_t bytes) {
    const auto fault = [&](int code) { return no_room_for_scratch(folder, what, bytes, code); };
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    auto path = folder + "/frames." + unique_part;
    const int file = mkostemp(path.data(), O_CLOEXEC);
    if (file < 0) throw fault(errno);
    unlink(path.c_str());
    if (const int code = bytes > 0 ? posix_fallocate(file, 0, static_cast<off_t>(bytes)) : 0;
        code != 0) {
        close(file);
        throw fault(code);
    }
    return file;
}

}  // namespace fluidcarve
