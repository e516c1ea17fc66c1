#pragma once

#include <nlohmann/json_fwd.hpp>

#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Inspects one kind of file for `fluidcarve inspect`. The files may be damaged.
struct FileInspector {
    std::vector<std::string> endings;  ///< file extensions: ".vdb"
    /// Those of the endings whose files hold nothing to carve.
    std::vector<std::string> not_carved;
    std::string parts;  ///< field of `look`'s result with the list of what is in the file, each
                        ///< with a `name`: "grids"
    /// Reads a file and describes its content. Called in a child process, since damaged files may
    /// crash it.
    /// @throws Failure
    std::function<nlohmann::ordered_json(const std::string& path)> look;
    /// Compares the results of `look` for several files, in order. One line per finding.
    std::function<std::vector<std::string>(const std::vector<nlohmann::ordered_json>&)> compare;
    /// The result of `look` as text for people. Of a sequence, numbers that change are lists of the
    /// least and the greatest.
    std::function<std::string(const nlohmann::ordered_json&)> text;
};

}  // namespace fluidcarve
