#pragma once

#include "tools/draft/request.h"
#include "tools/reading/sequences.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace fluidcarve {

/// The files that a pipeline is drafted for.
struct DraftFiles {
    FileSequence sequence;
    /// Of some frames, from the first to the last (FileInspector::look)
    std::vector<nlohmann::ordered_json> facts;
    std::vector<std::string> notes;  ///< what is wrong between them, for people

    /// "plume" of "sim/plume.####.vdb".
    std::string stem() const;
    /// A request with these files, and all else as it is by default.
    /// @param folder  base of the input's path; empty: the current folder
    DraftRequest request(const std::string& folder) const;
};

/// What is done of a folder with several sequences.
enum class Several {
    chosen,   ///< takes the one with most frames; of equals, the one with the largest files; one
              ///< whose frames do not fit together comes last
    refused,  ///< none
};

/// Looks at up to five files of a sequence. It trusts them, as `run` does.
/// @param argument  a file, a path with frame tokens, or a folder: its volumes; if it has none its
///   meshes, points and curves; else its images
/// @throws Failure (input) if there is no such file, or one that can't be read; Failure if the
///   argument is no such path
DraftFiles look_at_draft_files(const std::string& argument, Several several);

}  // namespace fluidcarve
