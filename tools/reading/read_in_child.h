#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fluidcarve {

/// What is known of a file: its facts, or why there are none, with its path.
struct ReadFile {
    std::optional<nlohmann::ordered_json> facts;
    std::string fault;
};

/// Returns what is in a file. @throws std::exception
using ReadFacts = std::function<nlohmann::ordered_json(const std::string& path)>;

/// Reads data files in one child process with limits (call_in_child), and each in one of its own if
/// that fails. Small files have a short time, large ones as long as a slow disk takes.
/// @param memory  limit of the memory, bytes
/// @return one entry per path
std::vector<ReadFile> read_in_child(std::span<const std::string> paths, const ReadFacts& read,
                                    std::uint64_t memory);

}  // namespace fluidcarve
