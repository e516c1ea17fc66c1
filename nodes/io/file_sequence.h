#pragma once

#include "graph/types/context.h"
#include "graph/types/param.h"

#include <functional>
#include <string>

namespace fluidcarve {

class NodeCheck;
class Survey;

/// What a reader does if a frame has no file.
enum class Missing { error, skip, hold };

template <>
struct ChoiceNames<Missing> {
    static constexpr std::array names = {std::pair{"error", Missing::error}, std::pair{"skip", Missing::skip}, std::pair{"hold", Missing::hold}};
};

/// Doc string of the parameter `missing` of readers.
inline constexpr auto missing_doc =
    "What to do if a frame has no file. error: stop. skip: leave the frame out of the whole run. hold: use the nearest earlier file, else the next one.";

/// Reports a fault if `missing` is stated for a path without a frame token.
void check_missing(const InputPath& path, Missing missing, NodeCheck& check);

/// The survey of a reader: handles frames without a file as `missing` says, and calls `look` for the frames that the run needs.
/// @param look  called with a frame and the frame whose file it uses; may throw Failure, which counts as a missing file
void survey_files(const InputPath& path, Missing missing, Survey& survey, const std::function<void(int frame, int file)>& look);

/// Path of the file for the context's frame.
std::string file_of(const InputPath& path, Missing missing, const Context& context);

}  // namespace fluidcarve
