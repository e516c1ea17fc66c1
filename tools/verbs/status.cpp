#include "tools/verbs/verbs.h"

#include "runtime/flow/options.h"
#include "runtime/jobs/job_status.h"
#include "runtime/keep/work_folder.h"
#include "runtime/tell/exit_codes.h"
#include "tools/verbs/arguments.h"

#include <CLI/CLI.hpp>

#include <memory>
#include <string>

namespace fluidcarve {
namespace {

/// Says how far the runs in a work folder have come.
int status(const std::string& folder, bool json) {
    if (const auto fault = WorkFolder(folder).read_fault(); !fault.empty())
        return end_with("failed: " + fault, exit_code::input);
    return print(job_status_text(folder, json)), exit_code::done;
}

}  // namespace

Verb::Work status_verb(CLI::App& verb, Program&) {
    const auto folder = std::make_shared<std::string>(RunOptions().work_folder);
    const auto json = std::make_shared<bool>(false);
    declare_work_folder(verb, *folder);
    verb.add_flag("--json", *json, "Print as JSON");
    return [=] { return status(*folder, *json); };
}

}  // namespace fluidcarve
