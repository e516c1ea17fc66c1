#include "nodes/python/python_script.h"

#include "carve/base/limits.h"
#include "formats/file/confinement.h"
#include "formats/file/full_path.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/python/workers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <utility>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;

std::string interpreter_of(const PythonParams& params) {
    if (params.python) return *params.python;
    const char* const named = std::getenv("FLUIDCARVE_PYTHON");
    return named && *named ? named : "python3";
}

std::string path_of_script(const PythonParams& params) {
    return full_path(params.script.at(0)).string();
}

/// Facts about a script, by interpreter and path, as its first worker reported.
struct KnownScripts {
    std::mutex mutex;
    struct Facts {
        FurtherDependencies further;
        bool gathers = false;
        std::vector<std::string> takes;  ///< offered arguments that the function takes
    };
    std::map<std::pair<std::string, std::string>, Facts> scripts;

    Facts of(const PythonParams& params) {
        const std::lock_guard lock(mutex);
        const auto found = scripts.find({interpreter_of(params), path_of_script(params)});
        return found == scripts.end() ? Facts{} : found->second;
    }
};

KnownScripts& known() {
    static KnownScripts out;
    return out;
}

WorkerLimits limits_of(const PythonParams& params, const Context& context) {
    return {params.timeout, context.limits().memory};
}

WorkerHost host_of(Context& context) {
    return {[&] { return context.cancelled(); },
            [&](const std::string& text) { context.warn(text); },
            [&](double fraction) {
                if (!context.per_frame()) context.progress(std::clamp(fraction, 0.0, 1.0));
            }};
}

}  // namespace

void check_script(const PythonParams& params, const std::string& function,
                  const std::vector<std::string>& inputs, NodeCheck& check,
                  const std::vector<std::string>& offered) {
    // The check of the whole pipeline reports paths outside of --confine.
    if (!Confinement::of_program().refusal(params.script.at(0)).empty()) return;
    if (params.script.per_frame())
        return check.fault("script", "parameter 'script' must be one file for all frames");
    const auto path = path_of_script(params);
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
        return check.fault("script", fmt::format("parameter 'script': there is no file {}", path));
    auto given = Json::array();
    for (const auto& [name, value] : params.params) given.push_back(name);
    // The run's limit is not known here; its default is used.
    const WorkerLimits limits{params.timeout, half_of_memory()};
    const Workers::Kind kind{interpreter_of(params), path};
    const auto look = [&](Worker& worker) {
        const auto answer = worker.call(
            {{"look", function}, {"inputs", inputs}, {"params", given}, {"offered", offered}},
            limits, {});
        for (const auto& fault : answer.at("faults"))
            check.fault(fault.at("field").get<std::string>(),
                        fault.at("message").get<std::string>());
        const std::lock_guard lock(known().mutex);
        known().scripts[kind] = {{answer.at("files").get<std::vector<std::string>>(),
                                  answer.at("version").get<std::string>()},
                                 answer.at("gathers").get<bool>(),
                                 answer.at("takes").get<std::vector<std::string>>()};
    };
    try {
        Workers::of_program().with_one(kind, limits, {}, look);
    } catch (const Failure& failure) {
        check.fault("script", fmt::format("parameter 'script': {}", failure.what()));
    }
}

NodeTraits script_traits(const PythonParams& params) {
    return {.depends = [&params] { return known().of(params).further; }};
}

bool script_gathers(const PythonParams& params) { return known().of(params).gathers; }

bool script_takes(const PythonParams& params, const std::string& offered) {
    const auto takes = known().of(params).takes;
    return std::ranges::find(takes, offered) != takes.end();
}

std::unique_ptr<Worker> new_worker(const PythonParams& params, Context& context) {
    return std::make_unique<Worker>(interpreter_of(params), path_of_script(params),
                                    limits_of(params, context), host_of(context));
}

void call_script(Worker& worker, const PythonParams& params, const std::string& function,
                 Context& context, const std::function<Json(Worker&)>& give,
                 const std::function<void(Worker&, const Json& answer)>& take) {
    Json request = give(worker);
    request["call"] = function;
    for (const auto& [name, value] : params.params) request["params"][name] = value.json();
    request["at"] = {
        {"frame", context.frame()}, {"time", context.t()}, {"work", context.limits().folder}};
    if (worker.frames != context.frames())
        request["at"]["frames"] = worker.frames = context.frames();
    take(worker, worker.call(std::move(request), limits_of(params, context), host_of(context)));
}

void call_script(const PythonParams& params, const std::string& function, Context& context,
                 const std::function<Json(Worker&)>& give,
                 const std::function<void(Worker&, const Json& answer)>& take) {
    Workers::of_program().with_one(
        {interpreter_of(params), path_of_script(params)}, limits_of(params, context),
        host_of(context),
        [&](Worker& worker) { call_script(worker, params, function, context, give, take); });
}

Json with_found(Worker& worker, const std::string& found, Json request) {
    if (worker.found != found) request["found"] = worker.found = found;
    return request;
}

}  // namespace fluidcarve
