#pragma once

#include "graph/types/context.h"
#include "graph/types/param.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

class NodeCheck;
class Survey;

/// What a reader does if a frame has no file.
enum class Missing { error, skip, hold };

template <>
struct ChoiceNames<Missing> {
    static constexpr std::array names = {std::pair{"error", Missing::error},
                                         std::pair{"skip", Missing::skip},
                                         std::pair{"hold", Missing::hold}};
};

/// Doc string of the parameter `missing` of readers.
inline constexpr auto missing_doc =
    "What to do if a frame has no file. error: stop. skip: leave the frame out of the whole run. "
    "hold: use the nearest earlier file, else the next one.";

/// Reports a fault if `missing` is stated for a path without a frame token.
void check_missing(const InputPath& path, Missing missing, NodeCheck& check);

/// The survey of a reader: handles frames without a file as `missing` says, and calls `look` for
/// the frames that the run needs.
/// @param look  called with a frame and the frame whose file it uses; may throw Failure, which
///   counts as a missing file
void survey_files(const InputPath& path, Missing missing, Survey& survey,
                  const std::function<void(int frame, int file)>& look);

/// The survey of a node that needs grids of certain names: calls `check` with the names of the
/// grids that an input will have, in the order of the frames, where readers know them. Stops at the
/// first Failure, which counts as a missing input.
/// @param wants  whether the node takes the frame with this index in the sequence
/// @return whether `check` threw nothing
bool survey_grids(std::string_view input, Survey& survey,
                  const std::function<bool(std::size_t t)>& wants,
                  const std::function<void(const std::vector<std::string>& names)>& check);

/// The survey of a node that needs channels of the image that its input `source` takes.
/// @param channels  nothing: any
void survey_channels(const std::optional<std::vector<std::string>>& channels, Survey& survey);

/// @param input  name of the input whose grids these are
/// @param there  their names
/// @throws Failure if find_name() finds no grid
void require_grid(std::string_view input, const std::string& name,
                  const std::vector<std::string>& there);

/// Path of the file for the context's frame.
std::string file_of(const InputPath& path, Missing missing, const Context& context);

}  // namespace fluidcarve
