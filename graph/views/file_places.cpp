#include "graph/views/file_places.h"

#include "carve/base/one_line.h"
#include "formats/file/full_path.h"

#include <fmt/format.h>

#include <filesystem>

namespace fluidcarve {

FilePlaces file_places(const Pipeline& pipeline) {
    FilePlaces out;
    for (const auto& node : pipeline.nodes)
        for (const auto& spec : node.type->params) {
            const bool writes = spec.writes_file();
            if (!writes && !spec.reads_file()) continue;
            const auto& pattern = spec.path(node.params.get());
            if (pattern.text().empty()) continue;
            FilePlace place{node.name,
                            spec.name,
                            full_path(pattern.in_its_folder()).string(),
                            writes,
                            !writes && pattern.exists(),
                            {}};
            if (const auto here = full_path(pattern.text()).string();
                !writes && !place.found && here != place.path)
                place.tried_at = here;
            out.push_back(std::move(place));
        }
    return out;
}

std::string to_text(const FilePlaces& places) {
    std::string out = "files:\n";
    for (const auto& [node, field, path, writes, found, tried_at] : places) {
        const auto how = writes ? "is written to" : found ? "is read at" : "is not found at";
        const auto other = tried_at.empty() ? std::string() : ", nor at " + tried_at;
        out += one_line(fmt::format("  {}.{} {} {}{}", node, field, how, path, other)) + "\n";
    }
    return out;
}

std::string user_of(const Pipeline& pipeline, const std::string& path) {
    namespace fs = std::filesystem;
    const auto wanted = canonical_path(path);
    const auto name = wanted.filename().string();
    const auto is = [&](const std::string& other) {
        return fs::path(other).filename() == name && canonical_path(other) == wanted;
    };
    const auto is_one_of = [&](const PathPattern& pattern) {
        for (const auto frame : pipeline.frames.frames()) {
            if (is(pattern.at(frame))) return true;
            if (!pattern.per_frame()) break;
        }
        return false;
    };
    for (const auto& file : pipeline.files)
        if (is(file)) return "it is the pipeline";
    for (const auto& node : pipeline.nodes)
        for (const auto& spec : node.type->params) {
            const bool reads = spec.reads_file();
            if (!reads && !spec.writes_file()) continue;
            const auto& pattern = spec.path(node.params.get());
            if (const auto ends = pattern.name_ends(); ends && !ends->fits({name, name})) continue;
            if (is_one_of(pattern))
                return fmt::format("'{}' {} it", node.name, reads ? "reads" : "writes");
        }
    return {};
}

}  // namespace fluidcarve
