#include "graph/file_claims.h"

#include "formats/file/full_path.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace fluidcarve {
namespace {

namespace fs = std::filesystem;

/// Compares claims by their folders and names first. Only those that could meet are compared frame
/// by frame.
class Claims {
public:
    Claims(const std::vector<FileClaim>& claims, const std::vector<int>& frames)
        : claims_(claims), frames_(frames) {
        for (const auto& claim : claims) {
            names_.push_back(claim.path.name_ends());
            folders_.push_back(names_.back() ? resolved_folder(claim.path.at(frames.front()))
                                             : fs::path());
        }
    }

    std::vector<std::optional<std::size_t>> overwritten() {
        std::vector<std::optional<std::size_t>> out(claims_.size());
        const auto targets = link_targets();
        const auto compared = could_meet(targets);
        std::unordered_map<std::string, std::size_t> first;
        for (std::size_t n = 0; n < claims_.size(); ++n) {
            if (const auto found = targets.find(n); !claims_[n].writes && found != targets.end())
                for (const auto& target : found->second) first.emplace(target.string(), n);
            if (compared[n])
                each_file(n, [&](const fs::path& file) {
                    const auto [found, fresh] =
                        first.emplace((resolved_folder(file) / file.filename()).string(), n);
                    if (!fresh && claims_[n].writes) out[n] = found->second;
                    return !out[n];
                });
        }
        return out;
    }

private:
    using Targets = std::map<std::size_t, std::vector<fs::path>>;

    /// @param visit  returns whether to go on
    template <class Visit>
    void each_file(std::size_t n, const Visit& visit) const {
        for (const auto frame : frames_)
            if (!visit(fs::path(claims_[n].path.at(frame))) || !claims_[n].path.per_frame()) return;
    }

    /// The folder of a file, without links. Most files lie in few folders: the links of each are
    /// resolved once.
    const fs::path& resolved_folder(const fs::path& file) {
        auto [found, fresh] = resolved_.try_emplace(file.parent_path().string());
        std::error_code error;
        // If the folder does not exist, `a/.` would stay `a/`.
        if (fresh)
            found->second =
                (fs::weakly_canonical(fs::absolute(file, error).parent_path(), error) / "")
                    .parent_path();
        return found->second;
    }

    /// The target of a link, without links.
    fs::path followed(fs::path file) {
        std::error_code error;
        for (int n = 0; n < most_symlinks && fs::is_symlink(file, error); ++n)
            file = file.parent_path() / fs::read_symlink(file, error);
        return resolved_folder(file) / file.filename();
    }

    /// Per reading claim: the targets of its files that are links.
    Targets link_targets() {
        Targets out;
        for (std::size_t n = 0; n < claims_.size(); ++n) {
            if (claims_[n].writes) continue;
            // A folder is listed once, instead of one call per frame.
            const bool list = names_[n] && claims_[n].path.per_frame();
            if (list &&
                links_in(fs::path(claims_[n].path.at(frames_.front())).parent_path()).empty())
                continue;
            each_file(n, [&](const fs::path& file) {
                std::error_code error;
                if (list ? links_in(file.parent_path()).contains(file.filename().string())
                         : fs::is_symlink(file, error))
                    out[n].push_back(followed(file));
                return true;
            });
        }
        return out;
    }

    /// Names of the links in a folder.
    const std::unordered_set<std::string>& links_in(const fs::path& folder) {
        const auto [found, fresh] = links_.try_emplace(folder);
        std::error_code error, gone;
        if (fresh)
            for (fs::directory_iterator each(folder.empty() ? "." : folder, error), end;
                 !error && each != end; each.increment(error))
                if (each->is_symlink(gone)) found->second.insert(each->path().filename().string());
        return found->second;
    }

    /// Per claim: whether it writes and could meet another, or could be met by one that writes.
    std::vector<bool> could_meet(const Targets& targets) const {
        std::set<fs::path> folders;
        for (const auto& [reader, files] : targets)
            for (const auto& file : files) folders.insert(file.parent_path());
        std::vector<bool> out(claims_.size(), false);
        for (std::size_t n = 0; n < claims_.size(); ++n) {
            if (!claims_[n].writes) continue;
            out[n] = names_[n] ? folders.contains(folders_[n]) : !folders.empty();
            for (std::size_t other = 0; other < n; ++other)
                if (may_share(n, other)) out[n] = out[other] = true;
        }
        return out;
    }

    bool may_share(std::size_t a, std::size_t b) const {
        return !names_[a] || !names_[b] ||
               (names_[a]->fits(*names_[b]) && folders_[a] == folders_[b]);
    }

    const std::vector<FileClaim>& claims_;
    const std::vector<int>& frames_;
    /// Per claim; nothing: its folders differ from frame to frame.
    std::vector<std::optional<NameEnds>> names_;
    std::vector<fs::path> folders_;                       ///< per claim with a name, without links
    std::unordered_map<std::string, fs::path> resolved_;  ///< by the folder as written
    std::map<fs::path, std::unordered_set<std::string>> links_;
};

}  // namespace

std::vector<std::optional<std::size_t>> overwritten(const std::vector<FileClaim>& claims,
                                                    const std::vector<int>& frames) {
    return Claims(claims, frames).overwritten();
}

}  // namespace fluidcarve
