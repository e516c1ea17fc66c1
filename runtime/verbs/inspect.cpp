#include "runtime/verbs/inspect.h"

#include "graph/text/one_line.h"
#include "runtime/run/run.h"
#include "runtime/verbs/confined.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>

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

/// Time limit for reading a file, in seconds: short for small files, in case the reader loops; for large files as long as a slow disk needs.
double patience(const std::string& path) {
    constexpr double least = 6, bytes_per_second = 2e7;
    std::error_code ignored;
    const auto bytes = std::filesystem::file_size(path, ignored);
    return ignored ? least : least + static_cast<double>(bytes) / bytes_per_second;
}

/// Inspects a file in a child process. @param fault  set to the reason if nothing is returned
std::optional<Json> look(const std::string& path, const FileInspector& inspector, std::uint64_t memory, std::string& fault) {
    const double seconds = patience(path);
    const auto answer = call_confined([&] { return inspector.look(path).dump(-1, ' ', false, Json::error_handler_t::replace); }, memory, seconds);
    switch (answer.end) {
        case Confined::End::returned:
            if (auto facts = Json::parse(answer.text, nullptr, false); !facts.is_discarded()) return facts;
            fault = fmt::format("{} is damaged: its reader gave no sensible answer", path);
            break;
        case Confined::End::threw: fault = answer.text.find(path) == std::string::npos ? fmt::format("{}: {}", path, answer.text) : answer.text; break;
        case Confined::End::crashed: fault = fmt::format("{} is damaged: its reader crashed ({})", path, answer.text); break;
        case Confined::End::too_slow: fault = fmt::format("{} is damaged, or very large: its reader was stopped after {:.0f} s", path, seconds); break;
    }
    return std::nullopt;
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
            if (auto facts = look(path, inspector, memory, fault)) {
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
