#pragma once

#include "nodes/expression/expression.h"
#include "nodes/expression/script.h"
#include "nodes/payloads.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

class Context;
class NodeCheck;

/// What `energy.ax` and `field.ax` share: all but the name of what the program writes, and what it may be.
struct AxParams {
    std::map<std::string, ScriptConstant> params;
    Script code;
};

/// Faults all that is wrong with the program, at its place in the file. Without the module `expressions` nothing can be said; the
/// run then asks for it.
void check_ax(const AxParams& params, const std::string& output, NodeCheck& check);

/// A node's program, compiled by the first frame for all.
class AxProgram {
public:
    /// @param least  the smallest value that is allowed, or -infinity
    /// @throws Failure as `evaluated`
    Ref<FloatGrid> run(const AxParams& params, const std::string& output, float least, const std::vector<std::pair<std::string, Ref<AnyGrid>>>& inputs,
                       const Context& context) const;

private:
    mutable std::once_flag once_;
    mutable std::shared_ptr<const CompiledExpression> compiled_;
};

extern const char* const ax_inputs_doc;
extern const char* const ax_params_doc;
/// @param output  what the program writes: "@energy"
std::string ax_code_doc(const std::string& output);

}  // namespace fluidcarve
