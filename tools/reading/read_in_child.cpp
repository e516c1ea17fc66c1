#include "tools/reading/read_in_child.h"

#include "graph/text/json_text.h"
#include "tools/reading/child_call.h"

#include <fmt/format.h>

#include <filesystem>
#include <new>

namespace fluidcarve {
namespace {

using Json = nlohmann::ordered_json;

/// Time limit for reading files, in seconds: short for small files, in case the reader loops; for
/// large files as long as a slow disk needs.
double patience(std::span<const std::string> paths) {
    constexpr double least = 6, bytes_per_second = 2e7;
    double seconds = least;
    for (const auto& path : paths) {
        std::error_code ignored;
        const auto bytes = std::filesystem::file_size(path, ignored);
        if (!ignored) seconds += static_cast<double>(bytes) / bytes_per_second;
    }
    return seconds;
}

/// What the child process says of a file.
Json answer_of(const std::string& path, const ReadFacts& read) {
    auto out = Json::object();
    try {
        out["facts"] = read(path);
    } catch (const std::bad_alloc&) {
        out["threw"] = "it needs more memory than is allowed";
    } catch (const std::exception& error) {
        out["threw"] = error.what();
    }
    return out;
}

ReadFile outcome_of(const std::string& path, const Json& answer) {
    if (answer.contains("facts")) return {std::make_optional<Json>(answer["facts"]), {}};
    const auto fault = answer.value("threw", std::string("its reader gave no sensible answer"));
    return {{}, fault.find(path) == std::string::npos ? fmt::format("{}: {}", path, fault) : fault};
}

/// Why a file that was read in a process of its own gave no facts.
std::string fault_of_child(const ChildResult& answer, const std::string& path, double seconds) {
    switch (answer.end) {
        case ChildResult::End::returned: break;
        case ChildResult::End::threw: return fmt::format("{}: {}", path, answer.text);
        case ChildResult::End::crashed:
            return fmt::format("{} is damaged: its reader crashed ({})", path, answer.text);
        case ChildResult::End::too_slow:
            return fmt::format(
                "{} is damaged, or very large: its reader was stopped after {:.0f} s", path,
                seconds);
    }
    return fmt::format("{} is damaged: its reader gave no sensible answer", path);
}

}  // namespace

std::vector<ReadFile> read_in_child(std::span<const std::string> paths, const ReadFacts& read,
                                    std::uint64_t memory) {
    const double seconds = patience(paths);
    const auto answer = call_in_child(
        [&] {
            auto all = Json::array();
            for (const auto& path : paths) all.push_back(answer_of(path, read));
            return json_text(all);
        },
        memory, seconds);
    std::vector<ReadFile> out;
    const auto all = answer.end == ChildResult::End::returned
                         ? Json::parse(answer.text, nullptr, false)
                         : Json();
    if (all.is_array() && all.size() == paths.size()) {
        for (std::size_t n = 0; n < paths.size(); ++n) out.push_back(outcome_of(paths[n], all[n]));
    } else if (paths.size() > 1) {
        for (const auto& path : paths)
            out.push_back(read_in_child(std::span(&path, 1), read, memory).front());
    } else {
        out.push_back({{}, fault_of_child(answer, paths.front(), seconds)});
    }
    return out;
}

}  // namespace fluidcarve
