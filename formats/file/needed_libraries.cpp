#include "formats/file/needed_libraries.h"

#include <elf.h>
#include <link.h>
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <span>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

/// Reads the tables of a shared library.
class Library {
public:
    explicit Library(const std::string& path) : file_(path, std::ios::binary) {}

    /// The names in its dynamic section that it needs.
    std::vector<std::string> needs() {
        ElfW(Ehdr) head{};
        constexpr auto bits = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
        if (!read(0, std::span(&head, 1)) || std::memcmp(head.e_ident, ELFMAG, SELFMAG) != 0 ||
            head.e_ident[EI_CLASS] != bits)
            return {};
        segments_.resize(head.e_phnum);
        if (!read(head.e_phoff, std::span(segments_))) return {};
        const auto dynamic = std::ranges::find_if(
            segments_, [](const auto& each) { return each.p_type == PT_DYNAMIC; });
        constexpr std::size_t most_bytes = std::size_t{1} << 20;
        if (dynamic == segments_.end() || dynamic->p_filesz > most_bytes) return {};
        std::vector<ElfW(Dyn)> entries(dynamic->p_filesz / sizeof(ElfW(Dyn)));
        if (!read(dynamic->p_offset, std::span(entries))) return {};
        const auto names =
            std::ranges::find_if(entries, [](const auto& each) { return each.d_tag == DT_STRTAB; });
        std::vector<std::string> out;
        for (const auto& entry : entries) {
            if (entry.d_tag != DT_NEEDED || names == entries.end()) continue;
            file_.seekg(
                static_cast<std::streamoff>(offset_of(names->d_un.d_ptr) + entry.d_un.d_val));
            std::getline(file_, out.emplace_back(), '\0');
        }
        return out;
    }

private:
    template <class T>
    bool read(std::uint64_t at, std::span<T> into) {
        file_.seekg(static_cast<std::streamoff>(at));
        return static_cast<bool>(file_.read(reinterpret_cast<char*>(into.data()),
                                            static_cast<std::streamsize>(into.size_bytes())));
    }
    /// Where in the file the byte of an address is.
    std::uint64_t offset_of(ElfW(Addr) address) const {
        for (const auto& each : segments_)
            if (each.p_type == PT_LOAD && address >= each.p_vaddr &&
                address - each.p_vaddr < each.p_filesz)
                return address - each.p_vaddr + each.p_offset;
        return 0;
    }

    std::ifstream file_;
    std::vector<ElfW(Phdr)> segments_;
};

/// The libraries of this process.
struct Open {
    std::set<std::string> names;
    std::set<fs::path> folders;
};

Open open_libraries() {
    Open out;
    dl_iterate_phdr(
        [](dl_phdr_info* each, std::size_t, void* to) {
            const fs::path path(each->dlpi_name);
            if (!path.has_parent_path()) return 0;
            auto& open = *static_cast<Open*>(to);
            open.names.insert(path.filename());
            open.folders.insert(path.parent_path());
            return 0;
        },
        &out);
    return out;
}

}  // namespace

std::vector<std::string> needed_libraries(const std::string& path) {
    const auto open = open_libraries();
    auto visited = open.names;
    std::vector<std::string> out;
    const std::function<void(const std::string&)> visit = [&](const std::string& library) {
        for (const auto& name : Library(library).needs()) {
            if (!visited.insert(name).second) continue;
            for (const auto& folder : open.folders) {
                const auto needed = (folder / name).string();
                if (!fs::exists(needed)) continue;
                visit(needed);
                out.push_back(needed);
                break;
            }
        }
    };
    visit(path);
    return out;
}

}  // namespace fluidcarve
