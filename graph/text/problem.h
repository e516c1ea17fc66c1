#pragma once

#include "carve/base/failure.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

/// A text that a user wrote: a pipeline file, or one `--set` option.
struct Source {
    std::string name;    ///< shown in front of a problem
    std::string text;    ///< the whole text; problems quote a line of it
    std::string folder;  ///< base of relative input paths in the text; empty: the current folder
};

/// A place in a Source. Lines and columns count from 1; line 0 is the source as a whole.
struct Mark {
    std::shared_ptr<const Source> source;
    int line = 0;
    int column = 0;

    auto operator<=>(const Mark&) const = default;
};

/// Something wrong in the user's text. All problems are found before any data is opened, and
/// reported together.
struct Problem {
    Mark at;
    std::string message;  ///< what is wrong and, if known, the remedy
    Mark also_at;         ///< a second relevant place; unset if `also` is empty
    std::string also;     ///< message for the second place
};

using Problems = std::vector<Problem>;

inline void add(Problems& problems, const Mark& at, std::string message, Mark also_at = {},
                std::string also = {}) {
    problems.push_back({at, std::move(message), std::move(also_at), std::move(also)});
}

/// `file:line:column: message`, the line itself and a caret below it; the same again for the second
/// place.
std::string to_text(const Problem& problem);

/// All problems for the user, sorted by place, without duplicates; at most the first hundred.
std::string to_text(const Problems& problems);

/// All problems in the same order, as a JSON array of `{file, line, column, message, also?: {file,
/// line, column, message}}`.
nlohmann::ordered_json to_json(const Problems& problems);

}  // namespace fluidcarve
