#pragma once

#include "carve/volume/volume.h"
#include "formats/vdb/conventions.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Entries of metadata that are listed.
constexpr std::size_t most_metadata = 1000;

/// Notes for the author of a pipeline, each with the grids, channels or files that it applies to;
/// without one it applies to all.
class Oddities {
public:
    void add(const std::string& text, const std::string& name = {});
    std::vector<std::string> lines() const;

private:
    std::vector<std::pair<std::string, std::vector<std::string>>> all_;
};

/// Notes what is odd about a volume file.
/// @param grids        the facts of its grids, in their order
/// @param conventions  of the program that wrote it; null: unknown
void note_volume(const Volume& volume, const VdbHeader& header, const nlohmann::ordered_json& grids,
                 const Conventions* conventions, Oddities& out);

}  // namespace fluidcarve
