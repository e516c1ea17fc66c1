#include "runtime/keep/entry_header.h"

#include "carve/base/descriptor.h"
#include "formats/file/confinement.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <vector>

namespace fluidcarve {

using Json = nlohmann::ordered_json;

namespace {

/// Where the header of an entry ends; nothing if the prefix or the size is wrong.
/// @param size  bytes of the entry
std::optional<std::uint64_t> header_end(std::span<const char> prefix, std::uint64_t size) {
    if (prefix.size() < entry_prefix || std::string_view(prefix.data(), 16) != entry_magic)
        return std::nullopt;
    const auto header = number_at<std::uint64_t>(prefix.data() + 16),
               body = number_at<std::uint64_t>(prefix.data() + 24);
    if (header > size || body > size || entry_prefix + header + body + entry_seal != size)
        return std::nullopt;
    return entry_prefix + header;
}

}  // namespace

int open_entry(const std::string& path) {
    if (!Confinement::of_program().refusal(path).empty()) return -ENOENT;
    const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat about {};
    if (file < 0) return -errno;
    if (fstat(file, &about) == 0 && S_ISREG(about.st_mode)) return file;
    close(file);
    return -ENOENT;
}

std::optional<Json> entry_header(std::span<const char> bytes, std::uint64_t size) {
    const auto end = header_end(bytes, size);
    if (!end || *end > bytes.size()) return std::nullopt;
    const auto text = bytes.subspan(entry_prefix, *end - entry_prefix);
    if (entry_checksum(text) != number_at<Hash>(bytes.data() + 32)) return std::nullopt;
    auto out = Json::parse(text.begin(), text.end(), nullptr, false);
    return out.is_object() ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<Json> entry_header(int file, std::uint64_t& size) {
    struct stat about {};
    std::vector<char> bytes(entry_prefix);
    if (fstat(file, &about) != 0 || !read_at(file, 0, bytes.data(), entry_prefix))
        return std::nullopt;
    size = static_cast<std::uint64_t>(about.st_size);
    const auto end = header_end(bytes, size);
    if (!end) return std::nullopt;
    bytes.resize(*end);
    if (!read_at(file, entry_prefix, bytes.data() + entry_prefix, *end - entry_prefix))
        return std::nullopt;
    return entry_header(bytes, size);
}

std::optional<Json> entry_header(const std::string& path) {
    const Descriptor file{open_entry(path)};
    std::uint64_t size = 0;
    return file.number < 0 ? std::nullopt : entry_header(file.number, size);
}

}  // namespace fluidcarve
