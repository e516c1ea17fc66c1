#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace fluidcarve {

/// Reads a data file in a child process with limits (call_confined): for small files a short time, for large ones as long as a slow disk takes.
/// @param read    returns what is in the file
/// @param memory  limit of the memory, bytes
/// @param fault   set to the reason, with the path, if nothing is returned
std::optional<nlohmann::ordered_json> read_confined(const std::string& path, const std::function<nlohmann::ordered_json()>& read, std::uint64_t memory,
                                                    std::string& fault);

}  // namespace fluidcarve
