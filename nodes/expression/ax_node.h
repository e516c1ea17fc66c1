#pragma once

#include "carve/volume/volume.h"
#include "nodes/expression/expression.h"
#include "nodes/expression/program_text.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

class Context;
class NodeCheck;

/// Parameters of `energy.ax` and `field.ax`.
struct AxParams {
    std::map<std::string, ProgramConstant> params;
    ProgramText code;
};

/// Reports all faults of a program, at their places in the file, and warns of inputs and constants
/// that it never reads. Without the module `expressions` it reports nothing, and the run fails.
/// @param output  name of the grid that the program writes, without @
void check_ax(const AxParams& params, const std::string& output, NodeCheck& check);

/// Whether a program may read the moment (`@Frame`, `@Time`, `$F`). False is certain.
bool may_read_moment(const AxParams& params);

/// A node's program. The first frame compiles it for all frames.
class AxProgram {
public:
    /// Runs the program for one frame. @param least  smallest allowed result, or -infinity
    /// @throws Failure as `evaluated`
    FloatGrid::Ptr run(const AxParams& params, const std::string& output, float least,
                       const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                       const Context& context) const;

private:
    mutable std::once_flag once_;
    mutable std::shared_ptr<const CompiledExpression> compiled_;
};

extern const char* const ax_inputs_doc;
extern const char* const ax_params_doc;
/// Doc string of the parameter `code`. @param output  the grid that the program writes: "@energy"
std::string ax_code_doc(const std::string& output);

}  // namespace fluidcarve
