#pragma once

#include "runtime/keep/content_hash.h"
#include "runtime/keep/manifest.h"

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace fluidcarve {

/// Sees to it that a run reads one version of each input file: the one that was there when the run
/// first looked at it and, with a manifest, the one that the manifest lists. Thread-safe.
class InputGuard {
public:
    /// @param manifest  null: none
    /// @param paths     files that the run will read, looked at now; others are first looked at
    ///   when they are read
    InputGuard(Manifest* manifest, const std::vector<std::string>& paths);

    /// Calls a body that reads files. What the body throws passes, unless a file changed meanwhile.
    /// @throws Failure (input) if a file is another than before, has appeared or is gone, or is not
    ///   as the manifest lists it
    void read(const std::vector<std::string>& paths, const std::function<void()>& body);

private:
    /// @return the state of the file
    Key require_same(const std::string& path);

    Manifest* const manifest_;
    std::mutex mutex_;
    std::map<Key, Key> states_;  ///< hash of a path to the state of the file when it was first
                                 ///< looked at; zero: there was none
};

}  // namespace fluidcarve
