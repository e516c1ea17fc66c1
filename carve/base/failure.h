#pragma once

#include <stdexcept>
#include <string>

namespace fluidcarve {

/// A fault in data, files or the system. A run adds node, type and frame.
class Failure : public std::runtime_error {
public:
    enum class Kind {
        data,   ///< the node could not do its work
        input,  ///< an input is missing, unreadable or too large
    };
    explicit Failure(const std::string& message, Kind kind = Kind::data)
        : std::runtime_error(message), kind(kind) {}
    Kind kind;
};

/// Thrown to stop a computation. Only the code that started the computation catches it.
struct Cancelled {};

}  // namespace fluidcarve
