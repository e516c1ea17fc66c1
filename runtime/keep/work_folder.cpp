#include "runtime/keep/work_folder.h"

#include "carve/base/failure.h"
#include "formats/file/confinement.h"
#include "formats/file/input_file.h"
#include "formats/file/output_file.h"
#include "graph/text/json_text.h"
#include "runtime/keep/entry_header.h"
#include "runtime/keep/packs.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <sstream>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::array parts{"cache", "files", "history", "jobs", "runs"};
constexpr auto mark_name = "CACHEDIR.TAG";
// The signature is that of the Cache Directory Tagging Specification: backups leave such folders
// out.
constexpr auto mark_text =
    "Signature: 8a477f597d28d172789f06886806bc55\n# A work folder of fluidcarve: results that it "
    "can compute again.\n# `fluidcarve clean` removes them.\n";
constexpr std::string_view mark_line = "# A work folder of fluidcarve";
constexpr auto unasked = std::chrono::hours(24 * 30);
/// Age at which a temporary file counts as left by a killed run.
constexpr auto forgotten = std::chrono::hours(24);

bool is_hex(std::string_view text, std::size_t length) {
    return text.size() == length && std::ranges::all_of(text, [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

/// Regular files below a folder, links not followed. @param depth  folders between it and the files
std::vector<fs::path> plain_files(const fs::path& folder, int depth) {
    std::vector<fs::path> out;
    std::error_code error;
    if (fs::symlink_status(folder, error).type() != fs::file_type::directory) return out;
    for (fs::directory_iterator each(folder, error), end; !error && each != end;
         each.increment(error)) {
        const auto type = each->symlink_status(error).type();
        if (depth > 0 && type == fs::file_type::directory &&
            is_hex(each->path().filename().string(), 2))
            for (auto& file : plain_files(each->path(), depth - 1)) out.push_back(std::move(file));
        if (depth == 0 && type == fs::file_type::regular) out.push_back(each->path());
    }
    return out;
}

/// Files named by a key (Hash::path); temporary files are not.
std::vector<fs::path> hashed_files(const fs::path& folder) {
    auto out = plain_files(folder, 1);
    std::erase_if(out, [](const fs::path& file) { return !is_hex(file.filename().string(), 30); });
    return out;
}

/// Files with the name of a pack.
std::vector<fs::path> pack_files(const fs::path& folder) {
    auto out = plain_files(folder, 0);
    std::erase_if(out,
                  [](const fs::path& file) { return !Packs::is_name(file.filename().string()); });
    return out;
}

std::vector<fs::path> temporary_files(const fs::path& folder) {
    auto out = plain_files(folder, 1);
    for (auto& file : plain_files(folder, 0)) out.push_back(std::move(file));
    std::erase_if(
        out, [](const fs::path& file) { return !OutputFile::is_aside(file.filename().string()); });
    return out;
}

/// Whether a file is of the form of StatusFile.
bool is_status(const fs::path& file) {
    if (file.extension() != ".json") return false;
    const auto status = json_of_own_file(file);
    return status.is_object() && status.contains("pid") && status.contains("host") &&
           status.contains("pipeline") && status.contains("nodes");
}

/// Whether a file is of the form of History.
bool is_history(const fs::path& file) {
    if (file.extension() != ".json") return false;
    const auto nodes = json_of_own_file(file);
    return nodes.is_object() && std::ranges::all_of(nodes, [](const auto& node) {
               return node.is_object() && node.contains("type") && node.contains("version");
           });
}

/// Files that fluidcarve wrote into the folder of a farm's job: records of its tasks, logs of the
/// local engine, which begin with a command, and the job, which comes last.
std::vector<fs::path> files_of_job(const fs::path& folder) {
    std::vector<fs::path> out;
    for (const auto& file : plain_files(folder / "tasks", 0))
        if (is_status(file) || OutputFile::is_aside(file.filename().string())) out.push_back(file);
    for (const auto& file : plain_files(folder / "logs", 0))
        if (file.extension() == ".log" && begins_with(file, "$ ")) out.push_back(file);
    const auto job = json_of_own_file(folder / "job.json");
    if (job.is_object() && job.contains("pipeline") && job.contains("engine") &&
        job.contains("steps"))
        out.push_back(folder / "job.json");
    return out;
}

/// The shot of the run that made a file of a work folder; empty: it serves several.
std::string made_for(const fs::path& file, const fs::path& root) {
    const auto inside = file.lexically_relative(root);
    const auto part = inside.begin()->string();
    const auto pipeline_in = [](const fs::path& path) {
        const auto record = json_of_own_file(path);
        return has(record, "pipeline", &Json::is_string)
                   ? shot_of(record["pipeline"].get<std::string>())
                   : std::string();
    };
    if (part == "history") return file.stem().string();
    if (part == "runs") return pipeline_in(file);
    if (part == "jobs") return pipeline_in(root / part / *std::next(inside.begin()) / "job.json");
    if (part != "cache") return {};
    const auto header = entry_header(file.string());
    return header && has(*header, "shot", &Json::is_string) ? (*header)["shot"].get<std::string>()
                                                            : std::string();
}

bool older(const fs::path& file, std::chrono::seconds age) {
    std::error_code gone;
    const auto used = fs::last_write_time(file, gone);
    return !gone && fs::file_time_type::clock::now() - used > age;
}

}  // namespace

std::string shot_of(const std::string& pipeline) { return fs::path(pipeline).stem().string(); }

void WorkFolder::make() const {
    std::error_code error;
    fs::create_directories(path_, error);
    if (error && !fs::is_directory(path_))
        throw Failure(fmt::format("cannot make the work folder {}: {}", path_, error.message()));
    // A run that was killed here has left the mark's temporary file.
    for (fs::directory_iterator each(path_, error), end; !error && each != end;
         each.increment(error))
        if (!OutputFile::is_aside(each->path().filename().string())) return;
    if (!error) OutputFile::write(path_ + "/" + mark_name, mark_text);
}

bool WorkFolder::marked() const {
    std::istringstream in(text_of_own_file(path_ + "/" + mark_name));
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(mark_line)) return true;
    return false;
}

std::string WorkFolder::read_fault() const {
    auto folders = std::vector{fs::path(path_)};
    for (const auto* const part : parts) folders.push_back(fs::path(path_) / part);
    for (const auto& folder : folders) {
        std::error_code error;
        const fs::directory_iterator opened(folder, error);
        if (error && error != std::errc::no_such_file_or_directory &&
            error != std::errc::not_a_directory)
            return fmt::format("cannot look through {}: {}", folder.string(), error.message());
    }
    return {};
}

std::string WorkFolder::link_fault() const {
    std::error_code none;
    for (const auto* const part : parts)
        if (const auto inside = fs::path(path_) / part; fs::is_symlink(inside, none))
            return fmt::format(
                "'{}' is a link: what it leads to may belong to others; make it a folder, or name "
                "another with --work",
                inside.string());
    return {};
}

std::string WorkFolder::fault() const {
    std::error_code error;
    if (!fs::exists(path_, error) || (fs::is_directory(path_, error) && fs::is_empty(path_, error)))
        return {};
    if (!marked())
        return fmt::format(
            "'{}' is not a work folder of fluidcarve: it has no {} written by fluidcarve, so "
            "nothing in it may be removed; name another with --work",
            path_, mark_name);
    return link_fault();
}

std::string WorkFolder::refusal() const {
    const auto& confinement = Confinement::of_program();
    auto out = confinement.refusal(path_);
    for (const auto* const part : parts)
        if (out.empty()) out = confinement.refusal(path_ + "/" + part);
    return out;
}

bool WorkFolder::is_entry(const fs::path& file) {
    return begins_with(file, entry_magic) || Packs::is_pack(file);
}

std::vector<WorkFolder::Entry> WorkFolder::entries() const {
    std::vector<Entry> out;
    const auto folder = fs::path(path_) / "cache";
    auto files = hashed_files(folder);
    for (auto& file : pack_files(folder)) files.push_back(std::move(file));
    for (const auto& file : files) {
        std::error_code gone;  // another process may remove files too
        Entry entry{file, fs::last_write_time(file, gone), fs::file_size(file, gone)};
        if (!gone) out.push_back(std::move(entry));
    }
    return out;
}

std::vector<fs::path> WorkFolder::outdated() const {
    std::vector<fs::path> out;
    for (const auto& file : pack_files(fs::path(path_) / "files"))
        if (older(file, unasked) && Packs::is_pack(file)) out.push_back(file);
    for (const auto* const part : parts)
        for (const auto& file : temporary_files(fs::path(path_) / part))
            if (older(file, forgotten)) out.push_back(file);
    return out;
}

std::vector<fs::path> WorkFolder::own_files() const {
    const fs::path root = path_;
    std::vector<fs::path> ours;
    for (const auto& [file, used, size] : entries())
        if (is_entry(file)) ours.push_back(file);
    for (const auto& file : pack_files(root / "files"))
        if (Packs::is_pack(file)) ours.push_back(file);
    for (const auto& file : plain_files(root / "history", 0))
        if (is_history(file)) ours.push_back(file);
    for (const auto& file : plain_files(root / "runs", 0))
        if (is_status(file)) ours.push_back(file);
    std::error_code none;
    if (fs::symlink_status(root / "jobs", none).type() == fs::file_type::directory)
        for (const auto& job : fs::directory_iterator(root / "jobs", none))
            if (!job.is_symlink(none))
                for (auto& file : files_of_job(job.path())) ours.push_back(std::move(file));
    for (const auto* const part : parts)
        for (const auto& file : temporary_files(root / part)) ours.push_back(file);
    std::ranges::sort(ours);
    ours.erase(std::unique(ours.begin(), ours.end()), ours.end());
    return ours;
}

std::size_t WorkFolder::count_files() const {
    const fs::path root = path_;
    std::error_code error, ignored;
    std::size_t out = 0;
    for (fs::recursive_directory_iterator each(root, error), end; !error && each != end;
         each.increment(error))
        out += !each->is_directory(ignored) && each->path() != root / mark_name ? 1 : 0;
    if (error && error != std::errc::no_such_file_or_directory)
        throw Failure(fmt::format("cannot look through {}: {}", path_, error.message()));
    return out;
}

WorkFolder::Cleaned WorkFolder::clean(const Cleaning& cleaning) const {
    const fs::path root = path_;
    const auto ours = own_files();
    // Before anything is removed: else the mark would go, though there may be more files.
    const auto all = count_files();
    Cleaned out;
    std::error_code error, ignored;
    for (const auto& file : ours) {
        if (cleaning.shot && made_for(file, root) != *cleaning.shot) {
            ++out.apart;
            continue;
        }
        if (cleaning.older && !older(file, *cleaning.older)) {
            ++out.kept;
            continue;
        }
        const auto bytes = fs::file_size(file, ignored);
        if (!cleaning.dry_run && !fs::remove(file, error)) {
            if (error)
                throw Failure(fmt::format("cannot remove {}: {}", file.string(), error.message()));
            continue;  // another process removed it
        }
        ++out.removed;
        out.bytes += bytes == static_cast<std::uintmax_t>(-1) ? 0 : bytes;
        if (!cleaning.dry_run) fs::remove(file.parent_path(), ignored);  // if it is empty
    }
    out.left = all - std::min(all, ours.size());
    if (cleaning.dry_run) return out;
    for (const auto* const part : parts)
        if (!fs::is_symlink(root / part, ignored)) fs::remove(root / part, ignored);
    if (out.left + out.kept + out.apart == 0) {
        fs::remove(root / mark_name, ignored);
        fs::remove(root, ignored);
    }
    return out;
}

}  // namespace fluidcarve
