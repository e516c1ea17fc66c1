#include "runtime/keep/cache.h"

#include "carve/base/descriptor.h"
#include "carve/base/failure.h"
#include "formats/file/confinement.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "runtime/keep/entry_header.h"
#include "runtime/keep/work_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <istream>
#include <ostream>
#include <span>
#include <streambuf>
#include <tuple>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// An output buffer whose bytes can be used without a copy, unlike those of a string stream. It
/// grows by parts, so that none moves.
class Bytes : public std::streambuf {
public:
    std::size_t size() const {
        return parts_.empty() ? 0 : (parts_.size() - 1) * part_size + parts_.back().size();
    }
    const std::vector<std::vector<char>>& parts() const { return parts_; }

protected:
    int_type overflow(int_type c) override {
        const char one = traits_type::to_char_type(c);
        if (!traits_type::eq_int_type(c, traits_type::eof())) xsputn(&one, 1);
        return traits_type::not_eof(c);
    }
    std::streamsize xsputn(const char* from, std::streamsize count) override {
        for (auto left = static_cast<std::size_t>(count); left > 0;) {
            if (parts_.empty() || parts_.back().size() == part_size)
                parts_.emplace_back().reserve(part_size);
            auto& part = parts_.back();
            const auto some = std::min(left, part_size - part.size());
            part.insert(part.end(), from, from + some);
            from += some;
            left -= some;
        }
        return count;
    }
    pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                     std::ios_base::openmode) override {
        return from == std::ios_base::cur && offset == 0 ? pos_type(static_cast<off_type>(size()))
                                                         : pos_type(off_type(-1));
    }

private:
    static constexpr std::size_t part_size = std::size_t{1} << 20;
    std::vector<std::vector<char>> parts_;
};

/// An input buffer over bytes in memory, without a copy.
class View : public std::streambuf {
public:
    View(char* data, std::size_t size) { setg(data, data, data + size); }

protected:
    pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                     std::ios_base::openmode) override {
        char* const at = (from == std::ios_base::beg   ? eback()
                          : from == std::ios_base::cur ? gptr()
                                                       : egptr()) +
                         offset;
        if (at < eback() || at > egptr()) return pos_type(off_type(-1));
        setg(eback(), at, egptr());
        return pos_type(at - eback());
    }
    pos_type seekpos(pos_type at, std::ios_base::openmode which) override {
        return seekoff(off_type(at), std::ios_base::beg, which);
    }
};

template <class T>
void append(std::vector<char>& to, const T& value) {
    const auto* const bytes = reinterpret_cast<const char*>(&value);
    to.insert(to.end(), bytes, bytes + sizeof value);
}

/// Writes outputs one behind the other, and lists them in the header.
void write_outputs(const Registry& registry, const std::vector<Payload>& outputs, Bytes& body,
                   Json& header) {
    std::ostream out(&body);
    out.exceptions(std::ios::badbit | std::ios::failbit);
    if (!outputs.empty()) header["outputs"] = Json::array();
    for (const auto& output : outputs) {
        if (!output) {
            header["outputs"].push_back(nullptr);
            continue;
        }
        const auto& type = registry.payload(output.type());
        const auto begin = body.size();
        type.write(output, out);
        header["outputs"].push_back(
            {{"type", type.name}, {"version", type.version}, {"bytes", body.size() - begin}});
    }
}

}  // namespace

Cache::Cache(const Registry& registry, std::string folder, std::size_t packed)
    : registry_(registry),
      work_folder_(folder),
      folder_(folder.empty() ? folder : folder + "/cache"),
      packed_(packed),
      packs_(folder_) {}

std::string Cache::path_of(const Hash& key) const { return folder_ + "/" + key.path(); }

void Cache::touch(const Hash& key) const {
    if (on() && key && utimensat(AT_FDCWD, path_of(key).c_str(), nullptr, 0) != 0)
        packs_.touch(key);
}

std::optional<Json> Cache::look(const Hash& key) const {
    if (!on() || !key) return std::nullopt;
    const Descriptor file{open_entry(path_of(key))};
    if (file.number >= 0) {
        std::uint64_t size = 0;
        errno = 0;
        auto header = entry_header(file.number, size);
        if (!header) note(key, errno);
        return header;
    }
    note(key, -file.number);
    const auto packed = packs_.read(key);
    return packed ? entry_header(*packed, packed->size()) : std::nullopt;
}

void Cache::remove_damaged(const Hash& key) {
    ++damaged_;
    packs_.drop(key);
    std::error_code ignored;
    fs::remove(path_of(key), ignored);
}

std::optional<Cache::Read> Cache::read(const Hash& key) {
    if (!on() || !key) return std::nullopt;
    const Descriptor file{open_entry(path_of(key))};
    std::vector<char> bytes;
    if (file.number >= 0) {
        std::uint64_t size = 0;
        if (!entry_header(file.number, size)) return remove_damaged(key), std::nullopt;
        bytes.resize(size);
        if (!read_at(file.number, 0, bytes.data(), size)) return remove_damaged(key), std::nullopt;
    } else if (auto packed = packs_.read(key)) {
        bytes = std::move(*packed);
    } else {
        return std::nullopt;
    }
    auto header = entry_header(bytes, bytes.size());
    if (!header) return remove_damaged(key), std::nullopt;
    const auto sealed = bytes.size() - entry_seal;
    if (entry_checksum({bytes.data(), sealed}) != number_at<Hash>(bytes.data() + sealed))
        return remove_damaged(key), std::nullopt;
    const auto body = entry_prefix + number_at<std::uint64_t>(bytes.data() + 16);
    return Read{std::move(*header), std::move(bytes), body};
}

bool Cache::intact(const Hash& key) { return read(key).has_value(); }

std::optional<Cache::Entry> Cache::load(const Hash& key) {
    auto file = read(key);
    if (!file) return std::nullopt;
    Entry out{std::move(file->header), {}};
    auto at = file->body;
    try {
        for (const auto& output : out.header.value("outputs", Json::array())) {
            if (output.is_null()) {
                out.outputs.emplace_back();
                continue;
            }
            const auto& types = registry_.payloads();
            const auto type = std::ranges::find_if(
                types, [&](const PayloadType& each) { return output.at("type") == each.name; });
            if (type == types.end() || !type->read || type->version != output.at("version"))
                return std::nullopt;
            const auto length = output.at("bytes").get<std::uint64_t>();
            if (length > file->bytes.size() - entry_seal - at)
                return remove_damaged(key), std::nullopt;
            View view(file->bytes.data() + at, length);
            std::istream in(&view);
            in.exceptions(std::ios::badbit);
            out.outputs.push_back(type->read(in));
            at += length;
        }
    } catch (const std::exception&) {
        return remove_damaged(key), std::nullopt;
    }
    touch(key);
    return out;
}

bool Cache::store(const Hash& key, Json header, const std::vector<Payload>& outputs) {
    if (!on() || !key) return true;
    if (!fault().empty()) return false;
    try {
        Bytes body;
        write_outputs(registry_, outputs, body, header);
        const auto text = json_text(header);
        std::vector<char> head(entry_magic.begin(), entry_magic.end()), seal;
        append(head, static_cast<std::uint64_t>(text.size()));
        append(head, static_cast<std::uint64_t>(body.size()));
        append(head, entry_checksum({text.data(), text.size()}));
        head.insert(head.end(), text.begin(), text.end());
        std::vector<std::span<const char>> parts{head};
        parts.insert(parts.end(), body.parts().begin(), body.parts().end());
        Hasher hash;
        for (const auto& part : parts) hash.bytes(part.data(), part.size());
        append(seal, hash.digest());
        parts.emplace_back(seal);
        // An entry that has a file stays in it: a file is found before a record.
        if (head.size() + body.size() + seal.size() <= packed_ &&
            access(path_of(key).c_str(), F_OK) != 0) {
            std::vector<char> record;
            for (const auto& part : parts) record.insert(record.end(), part.begin(), part.end());
            packs_.add(key, record);
            return true;
        }
        OutputFile file(path_of(key));
        std::ofstream stream(file.aside(), std::ios::binary);
        for (const auto& part : parts)
            stream.write(part.data(), static_cast<std::streamsize>(part.size()));
        file.commit(stream);
        return true;
    } catch (const std::exception& error) {
        const std::lock_guard lock(mutex_);
        fault_ = error.what();
        return false;
    }
}

void Cache::finish() {
    try {
        packs_.finish();
    } catch (const Failure& failure) {
        const std::lock_guard lock(mutex_);
        fault_ = failure.what();
    }
}

void Cache::look_again() {
    packs_.look_again();
    const std::lock_guard lock(mutex_);
    read_fault_.clear();
}

void Cache::note(const Hash& key, int error) const {
    const std::lock_guard lock(mutex_);
    note_read_fault(read_fault_, path_of(key), error);
}

std::string Cache::read_fault() const {
    const std::lock_guard lock(mutex_);
    return read_fault_.empty() ? packs_.read_fault() : read_fault_;
}

std::string Cache::fault() const {
    const std::lock_guard lock(mutex_);
    return fault_;
}

Cache::Trimmed Cache::trim(std::uint64_t most_bytes) const {
    Trimmed out;
    if (!on()) return out;
    const WorkFolder folder(work_folder_);
    auto entries = folder.entries();
    for (const auto& entry : entries) out.left += entry.size;
    if (!folder.fault().empty()) return out;
    std::error_code gone;
    for (const auto& file : folder.outdated()) fs::remove(file, gone);
    std::ranges::sort(entries, [](const WorkFolder::Entry& a, const WorkFolder::Entry& b) {
        return std::tie(a.used, a.path) < std::tie(b.used, b.path);
    });
    for (const auto& entry : entries) {
        if (out.left <= most_bytes) break;
        if (!WorkFolder::is_entry(entry.path)) continue;
        fs::remove(entry.path, gone);
        out.left -= entry.size;
        out.bytes += entry.size;
        ++out.files;
    }
    return out;
}

}  // namespace fluidcarve
