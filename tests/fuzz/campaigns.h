#pragma once

#include "tests/fuzz/campaign.h"
#include "tests/fuzz/sources.h"

#include <vector>

namespace fuzz {

/// All campaigns. @param sources  must outlive them
std::vector<Campaign> campaigns(const Sources& sources);

}  // namespace fuzz
