#include "runtime/verbs/read_confined.h"

#include "runtime/verbs/confined.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace fluidcarve {
namespace {

/// Time limit for reading a file, in seconds: short for small files, in case the reader loops; for large files as long as a slow disk needs.
double patience(const std::string& path) {
    constexpr double least = 6, bytes_per_second = 2e7;
    std::error_code ignored;
    const auto bytes = std::filesystem::file_size(path, ignored);
    return ignored ? least : least + static_cast<double>(bytes) / bytes_per_second;
}

}  // namespace

std::optional<nlohmann::ordered_json> read_confined(const std::string& path, const std::function<nlohmann::ordered_json()>& read, std::uint64_t memory,
                                                    std::string& fault) {
    using Json = nlohmann::ordered_json;
    const double seconds = patience(path);
    const auto answer = call_confined([&] { return read().dump(-1, ' ', false, Json::error_handler_t::replace); }, memory, seconds);
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

}  // namespace fluidcarve
