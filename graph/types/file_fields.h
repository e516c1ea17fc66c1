#pragma once

#include "graph/types/param.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// A field that a pipeline file may state, and what it is for.
struct FileField {
    std::string_view name, doc;
};

/// Fields of the file itself.
inline constexpr std::array top_fields{
    FileField{"fluidcarve", "Format version; a file that extends another need not state it."},
    FileField{"plugins",
              "Files with node types of their own, loaded by --allow-plugins; `fluidcarve schema "
              "--plugin FILE` knows these types too."},
    FileField{"params", "What a shot may change, by --set NAME=VALUE; used as ${name}."},
    FileField{"env", "Environment variables that ${NAME} may name."},
    FileField{"extends",
              "A pipeline file that this one changes, by name: params, nodes and their fields."},
    FileField{"provenance", "false: written files do not state what made them."},
    FileField{"frames",
              "The sequence: 1001-1084, 1-10,20-30, 1-100x2; auto: the frames that all inputs "
              "have. Without it there is one frame, 1."},
    FileField{"nodes", "name: {type: ..., <port or parameter>: ...}"}};

/// Fields of a param.
inline constexpr std::array param_fields{
    FileField{
        "type",
        "What values the param takes; count is a whole number or a percentage of the carved axis."},
    FileField{"default", "The value, unless the environment or --set gives another."},
    FileField{"min", "The least value."}, FileField{"max", "The greatest value."},
    FileField{"doc", "What the param is for."}};

/// Fields of every node besides its inputs and parameters.
inline constexpr std::array common_fields{
    FileField{"type", "What the node does; `fluidcarve nodes` lists all types."},
    FileField{"cache",
              "Whether results are kept in the work folder; for a writer, whether files that are "
              "up to date stay as they are. Left out: results are kept where that saves time."},
    FileField{"doc", "A note for readers."}};

/// The field of this name, or null.
const FileField* find_field(std::span<const FileField> fields, std::string_view name);
std::vector<std::string> names_of(std::span<const FileField> fields);

/// A type that a param may have.
struct ParamType {
    std::string name;  ///< "float"
    Shape shape;       ///< form of its values
    bool (*takes)(const Value& value,
                  ValueReader& reader);  ///< whether a value is of the type and within the reader's
                                         ///< range; else adds a problem
};

/// All types of params, in the order in which messages list them.
const std::vector<ParamType>& param_types();
std::vector<std::string> names_of(const std::vector<ParamType>& types);

}  // namespace fluidcarve
