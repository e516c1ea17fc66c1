#pragma once

#include "graph/types/context.h"
#include "graph/types/param.h"

#include <functional>
#include <string>

namespace fluidcarve {

class NodeCheck;
class Survey;

/// What a reader does about a frame without a file.
enum class Missing { error, skip, hold };

template <>
struct ChoiceNames<Missing> {
    static constexpr std::array names = {std::pair{"error", Missing::error}, std::pair{"skip", Missing::skip}, std::pair{"hold", Missing::hold}};
};

/// For the parameter `missing` of readers.
inline constexpr auto missing_doc =
    "What to do about a frame without a file: stop; leave the frame out of the whole run; or hold the nearest earlier frame, else the next.";

/// Finds fault with a `missing` that a path without a frame token has no use for.
void check_missing(const InputPath& path, Missing missing, NodeCheck& check);

/// Says which frames' files are missing, or leaves those frames out, and looks at the others that the run needs.
/// @param look  called with a frame and the frame whose file serves it; throws Failure if that can't be read, which is said too
void survey_files(const InputPath& path, Missing missing, Survey& survey, const std::function<void(int frame, int file)>& look);

/// The file that serves the context's frame.
std::string file_of(const InputPath& path, Missing missing, const Context& context);

}  // namespace fluidcarve
