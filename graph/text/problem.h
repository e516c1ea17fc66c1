#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// A text that a user wrote: a pipeline file, or one `--set` option.
struct Source {
    std::string name;    ///< as it is shown in front of a problem
    std::string text;    ///< the whole text, for the line above the caret
    std::string folder;  ///< relative input paths that the text states start here; empty: the current folder
};

/// A place in a Source. Lines and columns count from 1; `line` 0 means the source as a whole.
struct Mark {
    std::shared_ptr<const Source> source;
    int line = 0;
    int column = 0;
};

/// The user's text is wrong. Found before any data is opened, reported with all others at once.
struct Problem {
    Mark at;
    std::string message;  ///< thing, fault and, where one is known, the remedy
    Mark also_at;         ///< a second place that matters; unset when `also` is empty
    std::string also;
};

using Problems = std::vector<Problem>;

/// `file:line:column: message`, the line itself and a caret below it; the same again for the second place.
std::string to_text(const Problem& problem);

/// All problems in the order of their places, each once, as shown to the user; of very many, the first hundred.
std::string to_text(const Problems& problems);

/// All problems, in that order: JSON array of `{file, line, column, message, also?: {file, line, column, message}}`.
std::string to_json(const Problems& problems);

/// The candidate nearest to `name` by edit distance, or empty if none is near enough to be a slip of the hand.
std::string nearest(std::string_view name, const std::vector<std::string>& candidates);

/// "; did you mean 'x'?" for the nearest candidate, else "; known: a, b, c".
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

/// A frame's data, or the world outside, is wrong. A node body throws it; the runtime adds node, type and frame.
class Failure : public std::runtime_error {
public:
    enum class Kind {
        data,   ///< the node could not do its work
        input,  ///< an input file is missing or unreadable
    };
    explicit Failure(const std::string& message, Kind kind = Kind::data) : std::runtime_error(message), kind(kind) {}
    Kind kind;
};

/// Thrown by Context::check_cancelled when the run is being stopped; node bodies let it pass.
struct Cancelled {};

}  // namespace fluidcarve
