#pragma once

#include "graph/text/value.h"

#include <string>
#include <vector>

namespace fluidcarve {

/// A `${name}` that stands inside a text or a list. Of one that is a whole value, that value has the place of what it stands for.
struct Insertion {
    Mark in;  ///< the text, or the list
    std::string name;
};

/// A pipeline's text after everything that stands above types: `extends` merged, `--set` applied, `${name}` replaced.
struct Document {
    std::string name;           ///< the file, as given
    Mark mark;                  ///< of the file
    std::vector<Mark> sources;  ///< the file and those that it extends
    Value params;               ///< a map: what each param stands for
    Value frames;               ///< null: one frame, 1
    Value nodes;                ///< a map of maps
    Value plugins;              ///< null, or a list of files, those of extended files first
    std::vector<Insertion> insertions;
};

/// Reads a pipeline file. Later layers win: declaration defaults < extended file < file < environment < `settings`.
/// @param settings  the command line's `--set` texts: `node.field=value`, `param=value`, or `frames=value`
/// @param problems  everything that is wrong is added, all at once
Document read_document(const std::string& path, const std::vector<std::string>& settings, Problems& problems);

}  // namespace fluidcarve
