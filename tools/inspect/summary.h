#pragma once

#include "tools/inspect/inspector.h"

#include <nlohmann/json.hpp>

#include <vector>

namespace fluidcarve {

/// A file of a sequence, as FileInspector::look describes it.
struct LookedAt {
    int frame = 0;
    nlohmann::ordered_json facts;
};

/// What a sequence holds, in the form of one file's: numbers that change become `[least,
/// greatest]`, boxes and ranges those of all frames. Metadata stays where it is the same in all
/// frames. Besides, `frames` of parts that not every file has, `changes`, one line for each, and in
/// `oddities` the frames of those that not all files share.
/// @param files  at least one, sorted by frame
nlohmann::ordered_json summary_of(const std::vector<LookedAt>& files,
                                  const FileInspector& inspector);

}  // namespace fluidcarve
