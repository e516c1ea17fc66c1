#pragma once

#include "tools/compare/file_comparer.h"

#include <cstdint>
#include <optional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fluidcarve {

/// What `diff` is asked for.
struct DiffRequest {
    std::string a, b;                   ///< files, paths with frame tokens, or folders
    std::optional<std::string> frames;  ///< `-f`: compare only these; nothing: all that are there
    Tolerance tolerance;
    double fail_percent = 0;  ///< share of a part's values in a frame that may differ by more than
                              ///< the tolerance, percent
    std::string picture;      ///< PNG of the greatest difference; empty: none
    int threads = 1;
    std::uint64_t memory = 0;  ///< bytes that a grid may take
    bool json = false;
};

/// Arguments of the verb `diff`.
struct DiffArguments {
    std::string frames;
    DiffRequest request;
    const CLI::Option* frames_option = nullptr;

    void declare(CLI::App& verb);

    DiffRequest read(bool json);
};

/// The verb `diff`: compares two sequences frame by frame, several frames at once, each part of
/// their files by its name. Prints what differs to stdout, and errors to stderr. The output does
/// not depend on the number of threads.
/// @return an exit code: exit_code::done, exit_code::differs, or that of an error
int diff_files(const DiffRequest& request);

}  // namespace fluidcarve
