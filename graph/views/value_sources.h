#pragma once

#include "graph/document.h"
#include "graph/types/registry.h"
#include "graph/views/file_places.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// A value and its source.
struct ValueSource {
    std::string value;  ///< as YAML, on one line
    std::string from;   ///< "shots/sh010.yaml:4", "--set", "environment variable SHOT", "default"
    /// Names of the params and variables inserted into the text or list.
    std::vector<std::string> with;
};

/// The sources of all values in a pipeline.
struct ValueSources {
    using Fields = std::vector<std::pair<std::string, ValueSource>>;
    ValueSource frames;
    Fields params;
    /// Node name to fields, in the order of the file: type, connected inputs, all parameters, other
    /// stated fields.
    std::vector<std::pair<std::string, Fields>> nodes;
    FilePlaces files;  ///< places of the files; optional
};

/// Finds the sources of all values. @param document  must have no problems
ValueSources value_sources_of(const Document& document, const Registry& registry);

/// One line per value: `count = -18, from shots/sh010.yaml:4`.
std::string to_text(const ValueSources& sources);

/// JSON: `{frames: {value, from, with?}, params: {NAME: {value, from, with?}}, nodes: {NODE:
/// {FIELD: {value, from, with?}}}, files?: {NODE.FIELD: {path, writes, found?}}}`, with each
/// `value` as a YAML text.
nlohmann::ordered_json to_json(const ValueSources& sources);

}  // namespace fluidcarve
