#include "runtime/farm/job_files.h"

#include "graph/output_file.h"
#include "graph/text/problem.h"

#include <fmt/format.h>

#include <filesystem>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

}  // namespace

void write_job_files(const std::string& folder, const std::vector<JobFile>& files) {
    std::error_code error;
    const fs::path base(folder);
    if (fs::exists(base, error) && !fs::is_directory(base, error)) throw Failure(fmt::format("{} is no folder; choose another --output", folder));
    if (fs::is_directory(base, error) && !fs::is_empty(base, error) && !fs::exists(base / files.back().name, error))
        throw Failure(fmt::format("{} holds files of others; choose another --output, or an empty folder", folder));
    for (const auto& file : files) OutputFile::require_writable((base / file.name).string());
    for (const auto& file : files) {
        const auto path = base / file.name;
        OutputFile::write(path.string(), file.text);
        if (!file.runs) continue;
        fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec, fs::perm_options::add, error);
        if (error) throw Failure(fmt::format("cannot make {} a program: {}", path.string(), error.message()));
    }
}

}  // namespace fluidcarve
