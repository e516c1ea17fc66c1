#pragma once

#include "formats/file/content_hash.h"
#include "runtime/keep/manifest.h"

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace fluidcarve {

/// Ensures that a run reads one version of each input file: the version at the run's first look
/// and, with a manifest, the version that the manifest lists. Thread-safe.
class InputGuard {
public:
    /// @param manifest  null: none
    /// @param paths     files that the run will read, looked at now; others are first looked at
    ///   when they are read
    InputGuard(Manifest* manifest, const std::vector<std::string>& paths);

    /// Calls a body that reads files. Exceptions of the body pass, unless a file changed
    /// meanwhile.
    /// @throws Failure (input) if a file has changed, appeared or vanished since the first look,
    ///   or differs from the manifest
    void read(const std::vector<std::string>& paths, const std::function<void()>& body);

private:
    /// @return the state of the file
    Hash require_same(const std::string& path);

    Manifest* const manifest_;
    std::mutex mutex_;
    std::map<Hash, Hash> states_;  ///< hash of a path to the state of the file at the first look;
                                   ///< zero: there was no file
};

}  // namespace fluidcarve
