#pragma once

#include <string>
#include <vector>

namespace fuzz {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// The longest that a call may take, seconds. Sanitizers make the program several times slower.
inline constexpr double patience = sanitized ? 60 : 10;

/// How a call of the program ended.
struct Ended {
    int code = 0;        ///< exit code; of a call that a signal ended, -1
    int signal = 0;      ///< the signal that ended it, or 0
    bool hung = false;   ///< it was ended since it took too long
    double seconds = 0;  ///< how long it took
    std::string errors;  ///< what it wrote to stderr
};

/// Calls a program in a folder, without input, with little memory and no work folder. What it
/// writes to stderr is kept there as `stderr.txt`.
/// @param words  the program's path, then its arguments
/// @param most   after so many seconds the call is ended
Ended call(const std::vector<std::string>& words, const std::string& folder,
           double most = patience);

/// What is wrong with how a call ended; empty: nothing. Codes 0, 2 and 3 are sound, and so is 1
/// where nodes that compute failed: a file that a reader can't read must give 3.
std::string fault_of(const Ended& ended);

}  // namespace fuzz
