#include "runtime/jobs/job_files.h"

#include "carve/base/failure.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"

#include <fmt/format.h>

#include <filesystem>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

bool bears_mark(const fs::path& path) {
    return text_of_own_file(path).find(job_mark) != std::string::npos;
}

}  // namespace

void write_job_files(const std::string& folder, const std::vector<JobFile>& files) {
    std::error_code error;
    const fs::path base(folder);
    if (!bears_mark(base / files.back().name))
        for (const auto& file : files)
            if (fs::exists(base / file.name, error))
                throw Failure(fmt::format(
                    "{} is there already, and `farm` did not write it; choose another --output",
                    (base / file.name).string()));
    for (const auto& file : files) OutputFile::require_writable((base / file.name).string());
    for (const auto& file : files) {
        const auto path = base / file.name;
        OutputFile::write(path.string(), file.text);
        if (!file.runs) continue;
        fs::permissions(path,
                        fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                        fs::perm_options::add, error);
        if (error)
            throw Failure(
                fmt::format("cannot make {} a program: {}", path.string(), error.message()));
    }
}

}  // namespace fluidcarve
