#pragma once

#include "carve/base/failure.h"

#include <array>
#include <utility>

namespace fluidcarve {

/// The program's exit codes (pipelines/FORMATS.md).
namespace exit_code {
constexpr int done = 0;
constexpr int node_failed = 1;
constexpr int differs = 1;  ///< of `diff`, as of diff(1) and cmp(1)
constexpr int usage = 2;
constexpr int input = 3;
constexpr int some_frames_failed = 4;
constexpr int interrupted = 130;

/// All of them, with their meanings.
inline constexpr std::array meanings{
    std::pair{done, "done"},
    std::pair{node_failed, "a node failed; or what `diff` compared differs"},
    std::pair{usage, "wrong usage or pipeline"},
    std::pair{input, "an input is missing, unreadable or too large"},
    std::pair{some_frames_failed, "done, but some frames failed"},
    std::pair{interrupted, "interrupted"},
};
/// The exit code of a failure. @param other  if its kind is not `input`
inline int of(const Failure& failure, int other = node_failed) {
    return failure.kind == Failure::Kind::input ? input : other;
}
}  // namespace exit_code

}  // namespace fluidcarve
