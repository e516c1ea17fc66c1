#pragma once

#include "tests/fuzz/call.h"
#include "tests/fuzz/damage.h"
#include "tests/support/scratch.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace fuzz {

/// Mutants of one kind.
struct Campaign {
    std::string name;
    double share = 1;  ///< its part of the count of mutants
    /// Makes mutant `n` in a folder. @return the program's arguments; paths from the folder
    std::function<std::vector<std::string>(std::size_t n, Random&, const Scratch&)> make;
    /// What is wrong with how the call ended, beyond fault_of(); empty: nothing.
    std::function<std::string(const Ended&, const Scratch&)> judge = {};
};

/// How the mutants of a campaign fared.
struct Score {
    std::string name;
    std::size_t mutants = 0, failed = 0;
    std::map<std::string, std::size_t> ends;  ///< by exit code; "signal", "hung"
    double slowest = 0;                       ///< seconds
};

/// Calls the program with all mutants of a campaign. A mutant that it does not survive is kept in
/// the current folder, and told.
/// @param count  mutants of a campaign whose share is 1; at least one is made
/// @param seed   the same seed makes the same mutants
Score run(const Campaign& campaign, const std::string& program, std::size_t count,
          std::uint64_t seed);

/// The table of all scores.
std::string table(const std::vector<Score>& scores);

}  // namespace fuzz
