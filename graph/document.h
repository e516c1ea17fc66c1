#pragma once

#include "graph/insertion.h"
#include "graph/text/value.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A pipeline's text before node types are looked up: `extends` merged, `--set` applied, `${name}`
/// replaced.
struct Document {
    std::string name;           ///< the file, as given
    Mark mark;                  ///< the file as a whole
    std::vector<Mark> sources;  ///< the file and the files that it extends
    Value params;               ///< map: param name to value
    Value frames;               ///< null: one frame, number 1
    Value nodes;                ///< map of maps
    Value provenance;           ///< null: written files state what made them
    Value plugins;              ///< null, or a list of paths; plugins of extended files come first
    std::vector<Insertion> insertions;
    /// Name and value of each variable that `env` lists and that is set.
    std::vector<std::pair<std::string, std::string>> environment;
    /// The words of the command line that stands for the document; empty: `run NAME`
    std::vector<std::string> command;
};

/// Reads a pipeline file. Later layers win: declaration defaults < extended file < file <
/// environment < `settings`.
/// @param settings  the command line's `--set` texts: `node.field=value`, `param=value`, or
///   `frames=value`
/// @param problems  receives all faults of the text
/// @param open      whether params may have no value, as in a template that shots extend; values
///   that use such params are not checked
Document read_document(const std::string& path, const std::vector<std::string>& settings,
                       Problems& problems, bool open = false);
/// The same for a text that is not a file. The document has the text's name.
Document read_document(const std::shared_ptr<const Source>& text,
                       const std::vector<std::string>& settings, Problems& problems);

}  // namespace fluidcarve
