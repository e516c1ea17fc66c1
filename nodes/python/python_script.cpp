#include "nodes/python/python_script.h"

#include "carve/base/words.h"
#include "formats/file/confinement.h"
#include "graph/types/context.h"
#include "graph/types/node_check.h"
#include "nodes/python/workers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <mutex>
#include <utility>

namespace fluidcarve {
namespace {

using Json = nlohmann::json;

/// Libraries take some memory before a script asks for any.
constexpr std::uint64_t least_worker_memory = std::uint64_t{1} << 30;

std::string interpreter_of(const PythonParams& params) {
    if (params.python) return *params.python;
    const char* const named = std::getenv("FLUIDCARVE_PYTHON");
    return named && *named ? named : "python3";
}

std::string path_of_script(const PythonParams& params) {
    return std::filesystem::absolute(params.script.at(0)).lexically_normal().string();
}

/// What a script depends on, by interpreter and path: as its first worker told.
struct Known {
    std::mutex mutex;
    struct Facts {
        Further further;
        bool gathers = false;
    };
    std::map<std::pair<std::string, std::string>, Facts> scripts;
};

Known& known() {
    static Known out;
    return out;
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
                  const std::vector<std::string>& inputs, NodeCheck& check) {
    // Of a path that leads out, the check of the whole pipeline tells.
    if (!Confinement::of_program().refusal(params.script.at(0)).empty()) return;
    if (params.script.per_frame())
        return check.fault("script", "parameter 'script' must be one file for all frames");
    const auto path = path_of_script(params);
    if (!std::filesystem::is_regular_file(path))
        return check.fault("script", fmt::format("parameter 'script': there is no file {}", path));
    auto given = Json::array();
    for (const auto& [name, value] : params.params) given.push_back(name);
    try {
        Workers::of_program().with_one(
            {interpreter_of(params), path}, params.timeout, {}, [&](Worker& worker) {
                const auto answer =
                    worker.call({{"look", function}, {"inputs", inputs}, {"params", given}},
                                params.timeout, {});
                for (const auto& fault : answer.at("faults"))
                    check.fault(fault.at("field").get<std::string>(),
                                fault.at("message").get<std::string>());
                const std::lock_guard lock(known().mutex);
                known().scripts[{interpreter_of(params), path}] = {
                    {answer.at("files").get<std::vector<std::string>>(),
                     answer.at("version").get<std::string>()},
                    answer.at("gathers").get<bool>()};
            });
    } catch (const Failure& failure) {
        check.fault("script", fmt::format("parameter 'script': {}", failure.what()));
    }
}

Further script_depends(const PythonParams& params) {
    const std::lock_guard lock(known().mutex);
    const auto found = known().scripts.find({interpreter_of(params), path_of_script(params)});
    return found == known().scripts.end() ? Further{} : found->second.further;
}

bool script_gathers(const PythonParams& params) {
    const std::lock_guard lock(known().mutex);
    const auto found = known().scripts.find({interpreter_of(params), path_of_script(params)});
    return found != known().scripts.end() && found->second.gathers;
}

std::unique_ptr<Worker> new_worker(const PythonParams& params, Context& context) {
    return std::make_unique<Worker>(interpreter_of(params), path_of_script(params), params.timeout,
                                    host_of(context));
}

void call_script(Worker& worker, const PythonParams& params, const std::string& function,
                 Context& context, const std::function<Json(Worker&)>& give,
                 const std::function<void(Worker&, const Json& answer)>& take) {
    Json request = give(worker);
    request["call"] = function;
    request["memory"] = std::max(
        least_worker_memory,
        std::min<std::uint64_t>(context.memory_budget(), std::numeric_limits<std::int64_t>::max()));
    for (const auto& [name, value] : params.params) request["params"][name] = value.json();
    request["at"] = {
        {"frame", context.frame()}, {"time", context.place()}, {"work", context.work_folder()}};
    if (worker.frames != context.frames())
        request["at"]["frames"] = worker.frames = context.frames();
    take(worker, worker.call(std::move(request), params.timeout, host_of(context)));
}

void call_script(const PythonParams& params, const std::string& function, Context& context,
                 const std::function<Json(Worker&)>& give,
                 const std::function<void(Worker&, const Json& answer)>& take) {
    Workers::of_program().with_one(
        {interpreter_of(params), path_of_script(params)}, params.timeout, host_of(context),
        [&](Worker& worker) { call_script(worker, params, function, context, give, take); });
}

Json with_found(Worker& worker, const std::string& found, Json request) {
    if (worker.found != found) request["found"] = worker.found = found;
    return request;
}

}  // namespace fluidcarve
