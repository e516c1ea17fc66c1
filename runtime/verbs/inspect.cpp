#include "runtime/verbs/inspect.h"

#include "graph/text/one_line.h"
#include "runtime/run/run.h"
#include "runtime/verbs/read_confined.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// Not fmt::print: it throws if the output is a file on a full disk.
void tell(std::FILE* where, const std::string& text) { std::fwrite(text.data(), 1, text.size(), where); }

const FileInspector* inspector_of(const std::string& path, const Registry& registry) {
    const auto& all = registry.inspectors();
    const auto found = std::find_if(all.begin(), all.end(), [&](const auto& each) { return path.ends_with(each.ending); });
    return found == all.end() ? nullptr : &*found;
}

}  // namespace

int inspect_files(const std::vector<std::string>& paths, bool json, std::uint64_t memory, const Registry& registry) {
    std::vector<std::string> endings;
    for (const auto& inspector : registry.inspectors()) endings.push_back(inspector.ending);
    for (const auto& path : paths)
        if (!inspector_of(path, registry)) {
            tell(stderr, fmt::format("inspect reads files that end in {}, not {}\n", fmt::join(endings, ", "), path));
            return exit_code::usage;
        }

    int code = exit_code::done;
    auto all = Json{{"files", Json::array()}, {"notes", Json::array()}};
    for (const auto& inspector : registry.inspectors()) {
        std::vector<Json> seen;
        for (const auto& path : paths) {
            if (inspector_of(path, registry) != &inspector) continue;
            std::string fault;
            if (auto facts = read_confined(
                    path, [&] { return inspector.look(path); }, memory, fault)) {
                if (!json) tell(stdout, inspector.text(*facts));
                seen.push_back(*facts);
                all["files"].push_back(std::move(*facts));
            } else {
                std::fflush(stdout);
                if (!json) tell(stderr, fmt::format("failed: {}\n", one_line(fault)));
                all["files"].push_back({{"file", path}, {"error", fault}});
                code = exit_code::input;
            }
        }
        for (const auto& note : inspector.compare(seen)) {
            if (!json) tell(stdout, fmt::format("note: {}\n", note));
            all["notes"].push_back(note);
        }
    }
    if (json) tell(stdout, all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    return code;
}

}  // namespace fluidcarve
