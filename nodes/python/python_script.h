#pragma once

#include "graph/types/node_traits.h"
#include "graph/types/param.h"
#include "nodes/python/python_value.h"
#include "nodes/python/worker.h"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fluidcarve {

class Context;
class NodeCheck;

/// Parameters of all nodes in Python.
struct PythonParams {
    InputPath script;
    std::map<std::string, PythonValue> params;
    Auto<std::string> python;
    float timeout = 600;
};

/// Imports the script in a worker and reports its faults, and those of its function's arguments.
/// @param function  called by the node; its arguments are the node's inputs, `params` and `at`
/// @param inputs    names of the arguments that are inputs
/// @param offered   names of those that it may leave out
void check_script(const PythonParams& params, const std::string& function,
                  const std::vector<std::string>& inputs, NodeCheck& check,
                  const std::vector<std::string>& offered = {});

/// The results depend on the modules that the script imports from its own folder, and its VERSION.
/// Of a script that can't be imported: on nothing.
NodeTraits script_traits(const PythonParams& params);

/// Whether the script has a function `add`, which sees all frames, as its check found.
bool script_gathers(const PythonParams& params);
/// Whether the function takes an argument that was offered, as its check found.
bool script_takes(const PythonParams& params, const std::string& offered);

/// A worker of the script that nobody else calls. @throws as Worker
std::unique_ptr<Worker> new_worker(const PythonParams& params, Context& context);

/// Calls a function of the script.
/// @param give  writes inputs into the worker's memory, and returns their description for the
///   request
/// @param take  reads the answer
/// @throws Failure that names the place in the script @throws Cancelled
void call_script(const PythonParams& params, const std::string& function, Context& context,
                 const std::function<nlohmann::json(Worker&)>& give,
                 const std::function<void(Worker&, const nlohmann::json& answer)>& take);
/// The same in a given worker.
void call_script(Worker& worker, const PythonParams& params, const std::string& function,
                 Context& context, const std::function<nlohmann::json(Worker&)>& give,
                 const std::function<void(Worker&, const nlohmann::json& answer)>& take);

/// Adds the result of the script's `finish` to a request, unless the worker has it.
/// @param found  empty: nothing
nlohmann::json with_found(Worker& worker, const std::string& found, nlohmann::json request);

/// Adds the parameters of all nodes in Python to a declaration.
template <class Declaration>
Declaration& declare_python(Declaration& node) {
    node.required("script", &PythonParams::script,
                  "The script, a file such as `glow.py`. It may import modules of its folder; if "
                  "one of them changes, so does the result. What else it depends on, "
                  "such as a file of weights, it states as `VERSION = ...`.")
        .param("params", &PythonParams::params,
               "Further arguments by name: `{gain: 3}`. Numbers, true, false, texts and lists of "
               "them.")
        .param("python", &PythonParams::python,
               "The interpreter, Python 3.9 or newer with numpy: a path, or a name on PATH. Auto: "
               "that of the environment variable FLUIDCARVE_PYTHON, else `python3`.")
        .param(
            "timeout", &PythonParams::timeout, Unit::none, at_least(0.1),
            "Seconds that a call may take. After that the script is stopped, and the frame fails.")
        .runs_code();
    return node;
}

}  // namespace fluidcarve
