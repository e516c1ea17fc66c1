#include "runtime/jobs/openjd.h"

#include "carve/base/failure.h"
#include "carve/base/one_line.h"
#include "carve/base/words.h"
#include "formats/file/full_path.h"
#include "graph/text/shell_word.h"
#include "runtime/tell/exit_codes.h"
#include "runtime/tell/terminal.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <set>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Limits of the specification.
constexpr std::size_t most_parameters = 50;
constexpr std::size_t longest_value = 1024;
constexpr std::size_t longest_list = 1024;
constexpr std::size_t longest_identifier = 64;
constexpr std::size_t longest_step_name = 64;
constexpr std::size_t longest_job_name = 128;
constexpr std::size_t longest_description = 2048;
constexpr int notice_seconds = 30;

/// Evenly spaced frames: first, first + step, ..., last.
struct EvenFrames {
    int first = 0, last = 0, step = 1;
};

/// Cuts sorted frames into evenly spaced parts, each as long as possible.
std::vector<EvenFrames> even_parts(const std::vector<int>& frames) {
    std::vector<EvenFrames> parts;
    for (const auto frame : frames) {
        auto* const part = parts.empty() ? nullptr : &parts.back();
        if (part && (part->first == part->last || part->last + part->step == frame)) {
            if (part->first == part->last) part->step = frame - part->first;
            part->last = frame;
        } else {
            parts.push_back({frame, frame, 1});
        }
    }
    return parts;
}

/// A range expression of the specification: `1-9,20,30-90:3`.
std::string range_expression(const std::vector<int>& frames) {
    std::string out;
    for (const auto& run : even_parts(frames)) {
        out += fmt::format("{}{}", out.empty() ? "" : ",", run.first);
        if (run.first != run.last) out += fmt::format("-{}", run.last);
        if (run.step != 1) out += fmt::format(":{}", run.step);
    }
    return out;
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos;
         at += by.size() - what.size() + 1)
        text.replace(at, what.size(), by);
    return text;
}

/// A word as shell code in which no pair of braces begins or ends a reference to a parameter.
std::string code_of(const std::string& word) {
    const auto code = shell_word(word);
    // Empty quotes separate braces, but end a string that `$'` began.
    const bool escapes = code.starts_with("$'");
    return replaced(replaced(code, "{{", escapes ? "{\\x7b" : "{''{"), "}}",
                    escapes ? "}\\x7d" : "}''}");
}

/// Text for a name in which no pair of braces begins a reference to a parameter.
std::string plain_name(const std::string& text, std::size_t longest) {
    return replaced(replaced(one_line(text), "{{", "{ {"), "}}", "} }").substr(0, longest);
}

/// A path as a parameter of the job.
struct PathParameter {
    std::string name;
    FarmPath path;
};

/// Makes the bundle.
class Bundle {
public:
    Bundle(const FarmJob& job, std::string folder, bool chunk_ranges)
        : job_(job), folder_(std::move(folder)), chunk_ranges_(chunk_ranges) {
        add_parameter({"project", job.folder, {}, true, false, false});
        for (const auto& path : job.paths) add_parameter(path);
        if (parameters_.size() > most_parameters)
            throw Failure(
                fmt::format("{} reads and writes {} places, but a template may have {} parameters; "
                            "deliver less at once, by --to",
                            job.pipeline, parameters_.size() - 1, most_parameters));
    }

    std::vector<JobFile> files() const {
        return {{"asset_references.json", text(references())},
                {"parameter_values.json", text(values())},
                {"template.json", text(job_template())}};
    }

private:
    void add_parameter(const FarmPath& path) {
        std::string identifier;
        for (const char c : path.name)
            identifier += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
        if (std::isdigit(static_cast<unsigned char>(identifier[0]))) identifier.insert(0, "_");
        identifier.resize(std::min(identifier.size(), longest_identifier));
        auto name = identifier;
        for (int number = 2; !names_.insert(name).second; ++number) {
            const auto suffix = fmt::format("_{}", number);
            name = identifier.substr(0, longest_identifier - suffix.size()) + suffix;
        }
        if (path.path.size() > longest_value)
            throw Failure(fmt::format(
                "the path of {} is longer than the {} characters that a parameter may have: {}",
                path.name, longest_value, path.path));
        parameters_.push_back({name, path});
    }

    static std::string text(const Json& json) {
        try {
            return json.dump(2) + "\n";
        } catch (const Json::type_error&) {
            throw Failure(
                "a path or an option is no UTF-8 text, which a template must be; rename it");
        }
    }

    static const char* flow_of(const FarmPath& path) {
        return path.in && path.out ? "INOUT" : path.in ? "IN" : path.out ? "OUT" : "NONE";
    }

    Json job_template() const {
        Json definitions = Json::array(), steps = Json::array();
        for (const auto& parameter : parameters_)
            definitions.push_back(
                {{"name", parameter.name},
                 {"type", "PATH"},
                 {"description", about(parameter.path)},
                 {"objectType", parameter.path.folder ? "DIRECTORY" : "FILE"},
                 {"dataFlow", flow_of(parameter.path)},
                 {"default", fs::path(parameter.path.path).lexically_relative(folder_).string()}});
        for (const auto& each : job_.steps) steps.push_back(step(each));
        Json out{{"specificationVersion", "jobtemplate-2023-09"}};
        if (chunk_ranges_ && std::ranges::any_of(job_.steps, &FarmStep::chunked))
            out["extensions"] = {"TASK_CHUNKING"};
        out["name"] = plain_name(job_.name, longest_job_name);
        out["description"] =
            fmt::format("{} openjd wrote it, of {}", job_mark, one_line(job_.pipeline))
                .substr(0, longest_description);
        out["parameterDefinitions"] = std::move(definitions);
        out["steps"] = std::move(steps);
        return out;
    }

    static std::string about(const FarmPath& path) {
        return one_line(path.file.empty() ? path.name
                                          : fmt::format("{}: folder of {}", path.name, path.file))
            .substr(0, longest_description);
    }

    /// The name of a step in the template.
    std::string name_of(const std::string& step) const {
        if (step.size() <= longest_step_name) return step;
        const auto place =
            std::ranges::find(job_.steps, step, &FarmStep::name) - job_.steps.begin();
        const auto suffix = fmt::format("-{}", place + 1);
        return step.substr(0, longest_step_name - suffix.size()) + suffix;
    }

    Json step(const FarmStep& step) const {
        Json out{{"name", name_of(step.name)},
                 {"description", one_line(step.what).substr(0, longest_description)}};
        for (const auto& need : step.needs)
            out["dependencies"].push_back({{"dependsOn", name_of(need)}});
        if (auto amounts = amounts_of(step.resources); !amounts.empty())
            out["hostRequirements"]["amounts"] = std::move(amounts);
        std::string frames;
        if (step.chunked)
            out["parameterSpace"] = chunk_ranges_ ? chunks(step, frames) : pairs(step, frames);
        Json arguments{"{{Task.File.Run}}", frames};
        for (const auto& parameter : parameters_)
            arguments.push_back("{{Param." + parameter.name + "}}");
        out["script"] = {{"actions",
                          {{"onRun",
                            {{"command", "bash"},
                             {"args", std::move(arguments)},
                             {"cancelation",
                              {{"mode", "NOTIFY_THEN_TERMINATE"},
                               {"notifyPeriodInSeconds", notice_seconds}}}}}}},
                         {"embeddedFiles",
                          {{{"name", "Run"},
                            {"filename", "run.sh"},
                            {"type", "TEXT"},
                            {"data", script(step)}}}}};
        return out;
    }

    static Json amounts_of(const RunResources& resources) {
        Json out = Json::array();
        const auto add = [&](const char* name, std::uint64_t least) {
            if (least > 0) out.push_back({{"name", name}, {"min", least}});
        };
        const auto in_units = [](std::uint64_t bytes, int shift) {
            return (bytes + (std::uint64_t{1} << shift) - 1) >> shift;
        };
        add("amount.worker.vcpu", static_cast<std::uint64_t>(std::max(0, resources.cores)));
        add("amount.worker.memory", in_units(resources.memory, 20));
        add("amount.worker.disk.scratch", in_units(resources.disk, 30));
        return out;
    }

    /// @param frames  set to the expression for a task's frames
    static Json chunks(const FarmStep& step, std::string& frames) {
        std::vector<int> all;
        std::size_t most = 1;
        for (const auto& task : step.tasks) {
            all.insert(all.end(), task.frames().begin(), task.frames().end());
            most = std::max(most, task.frames().size());
        }
        std::ranges::sort(all);
        frames = "{{Task.Param.Frames}}";
        return {
            {"taskParameterDefinitions",
             {{{"name", "Frames"},
               {"type", "CHUNK[INT]"},
               {"range", range_expression(all)},
               {"chunks", {{"defaultTaskCount", most}, {"rangeConstraint", "NONCONTIGUOUS"}}}}}}};
    }

    /// @param frames  set to the expression for a task's frames
    static Json pairs(const FarmStep& step, std::string& frames) {
        Json first = Json::array(), last = Json::array(), by = Json::array();
        bool even = true;
        for (const auto& task : step.tasks)
            for (const auto& run : even_parts(task.frames())) {
                first.push_back(run.first);
                last.push_back(run.last);
                by.push_back(run.step);
                even = even && run.step == 1;
            }
        if (first.size() > longest_list)
            throw Failure(
                fmt::format("{} has {} tasks, but a template may list {}; take a larger --chunk, "
                            "or leave --no-chunk-extension out",
                            step.name, first.size(), longest_list));
        frames = "{{Task.Param.First}}-{{Task.Param.Last}}";
        Json out{{"taskParameterDefinitions",
                  {{{"name", "First"}, {"type", "INT"}, {"range", std::move(first)}},
                   {{"name", "Last"}, {"type", "INT"}, {"range", std::move(last)}}}},
                 {"combination", "(First, Last)"}};
        if (even) return out;
        frames += "x{{Task.Param.Step}}";
        out["taskParameterDefinitions"].push_back(
            {{"name", "Step"}, {"type", "INT"}, {"range", std::move(by)}});
        out["combination"] = "(First, Last, Step)";
        return out;
    }

    /// The program's words as shell code. Words for the pipeline and the work folder refer to the
    /// task's parameters.
    std::string command(const FarmStep& step) const {
        std::string out;
        for (const auto& word : command_of(job_, step, {})) {
            const auto code = word == job_.pipeline ? "\"$pipeline\""
                              : word == job_.work   ? "\"$work\""
                                                    : code_of(word);
            out += (out.empty() ? "" : " ") + code;
        }
        return out;
    }

    /// The script of a task. Its arguments are the frames, and the values of all parameters in
    /// their order.
    std::string script(const FarmStep& step) const {
        auto out = fmt::format("# {}: {}\nset -eu\n", step.name,
                               plain_name(step.what, longest_description));
        // The specification writes steps as 1-9:2, the program as 1-9x2.
        out += "frames=${1//:/x}\nshift\n\n";
        out +=
            "# What the scheduler has elsewhere is told to the program: moved FIELD FILE WAS IS\n";
        out += "moves=()\n";
        out += "moved() {\n";
        out += "    [ \"$3\" = \"$4\" ] || moves+=(--set \"$1=$4${2:+/$2}\")\n";
        out += "}\n";
        out += fmt::format("pipeline={}\n", code_of(job_.pipeline));
        for (const auto& [name, path] : parameters_) {
            if (path.name == "project" || path.name == "work") out += path.name + "=$1\n";
            else if (path.name == "pipeline")
                out += fmt::format("[ \"$1\" = {} ] || pipeline=$1\n", code_of(path.path));
            else if (path.name.find('.') != std::string::npos)
                out += fmt::format("moved {} {} {} \"$1\"\n", code_of(path.name),
                                   code_of(path.file), code_of(path.path));
            out += "shift\n";
        }
        out += "\ncd -- \"$project\"\n";
        return out + "exec " + command(step) + " \"${moves[@]}\" ${frames:+\"--frames=$frames\"}\n";
    }

    Json values() const {
        Json out{{"parameterValues", Json::array()}};
        for (const auto& parameter : parameters_)
            out["parameterValues"].push_back(
                {{"name", parameter.name}, {"value", parameter.path.path}});
        return out;
    }

    Json references() const {
        std::set<std::string> folders, files, outputs;
        for (const auto& [name, path] : parameters_) {
            if (path.in) (path.folder ? folders : files).insert(path.path);
            if (path.out)
                outputs.insert(path.folder ? path.path
                                           : fs::path(path.path).parent_path().string());
        }
        return {{"assetReferences",
                 {{"inputs", {{"directories", folders}, {"filenames", files}}},
                  {"outputs", {{"directories", outputs}}},
                  {"referencedPaths", {job_.folder}}}}};
    }

    const FarmJob& job_;
    std::string folder_;
    bool chunk_ranges_;
    std::vector<PathParameter> parameters_;
    std::set<std::string> names_;
};

}  // namespace

std::vector<JobFile> openjd_files(const FarmJob& job, const std::string& folder,
                                  bool chunk_ranges) {
    return Bundle(job, folder, chunk_ranges).files();
}

std::string openjd_refusal(const FarmRequest& request) {
    return request.submit ? "--submit: a bundle is handed over by its scheduler's own command, "
                            "such as `deadline bundle submit FOLDER`; leave --submit out"
                          : "";
}

int farm_openjd(const FarmJob& job, const FarmRequest& request) {
    const auto folder = full_path(request.output.empty() ? job.name : request.output).string();
    write_job_files(folder, openjd_files(job, folder, request.chunk_ranges));
    if (!request.quiet)
        tell(fmt::format("{}: a job bundle of {}", folder, counted(job.steps.size(), "step")));
    return exit_code::done;
}

}  // namespace fluidcarve
