#include "formats/geometry_file/provenance_comments.h"

#include "formats/geometry_file/file_text.h"

namespace fluidcarve {
namespace {

/// The entry in a line; two empty texts if it has none.
Provenance::value_type entry_in(std::string_view line) {
    for (const auto begin : {hash_comment, ply_comment})
        if (line.starts_with(begin)) return provenance_of_line(line.substr(begin.size()));
    return {};
}

}  // namespace

std::vector<std::string> provenance_comments(const Provenance& provenance, std::string_view begin) {
    std::vector<std::string> out;
    for (const auto& entry : provenance) out.push_back(std::string(begin) + provenance_line(entry));
    return out;
}

bool is_provenance_comment(std::string_view line) { return !entry_in(line).first.empty(); }

Provenance provenance_of_comments(const InputFile& file) {
    constexpr std::size_t most_head = 1 << 20;
    FileText text(file, most_head);
    Provenance out;
    bool ply = false;
    while (text.next()) {
        auto line = text.line();
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (text.line_number() == 1) ply = line == "ply";
        if (line == "end_header" || (!ply && !line.empty() && !line.starts_with('#'))) break;
        if (auto entry = entry_in(line); !entry.first.empty()) out.push_back(std::move(entry));
    }
    return out;
}

}  // namespace fluidcarve
