#pragma once

#include "tests/support/program.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace fs = std::filesystem;

/// Settings that send all that a shipped pipeline writes to a folder.
inline std::string into(const Scratch& scratch, const std::string& name = "out.####.vdb") {
    return " --set out=" + (scratch / name) + " --set seams=" + (scratch / "seams.vdb") +
           " --set sheet=" + (scratch / "sheet.png") + " --progress none ";
}

/// Whether two folders' files of a name are the same, but for the identifier that each VDB file has
/// of its own.
inline bool same_but_identifier(const Scratch& one, const Scratch& other, const std::string& name) {
    // 36 characters behind magic, versions and the offsets flag.
    constexpr std::size_t identifier = 8 + 4 + 4 + 4 + 1;
    const auto bytes = [&](const Scratch& scratch) {
        return Scratch::read(scratch / name).erase(identifier, 36);
    };
    return bytes(one) == bytes(other);
}
