#pragma once

#include "runtime/keep/store.h"
#include "runtime/plan/frame_run.h"
#include "runtime/plan/schedule.h"

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace fluidcarve {

/// Paths of the files that frames read and write, `[frame]`, in the order in which frames begin.
struct FilesOfPass {
    std::vector<std::vector<std::string>> read, written;
};

/// Has the system read the files of the next frames while earlier ones are worked on. It asks in a
/// thread of its own, since a slow disk may keep who asks waiting. If all files that are read are
/// together larger than memory, it also gives back the memory of those that no later frame reads,
/// and of those that frames have written.
class ReadAhead {
public:
    /// @param ahead   number of frames to read ahead
    /// @param memory  bytes
    ReadAhead(FilesOfPass files, std::size_t ahead, std::uint64_t memory);
    ~ReadAhead();
    ReadAhead(const ReadAhead&) = delete;
    ReadAhead& operator=(const ReadAhead&) = delete;

    /// Tells that the work on a frame begins, or is done. For any thread.
    void begin(std::size_t frame);
    void end(std::size_t frame);

private:
    void work(const std::stop_token& stop);
    /// Has the files of a frame dropped. @param done  the frame
    void drop(std::size_t done);

    const FilesOfPass files_;
    const std::size_t ahead_;
    std::map<std::string, std::size_t> last_;  ///< file to the last frame that reads it
    bool drops_ = false;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::size_t next_ = 0, until_ = 0;  ///< frames that are asked for next
    std::vector<std::size_t> done_;     ///< frames whose files may be dropped
    /// Frames that were done last: not all that they wrote may be on the disk.
    std::deque<std::size_t> lately_;
    std::jthread thread_;
};

/// Finds the files that nodes read and write in the frames of a pass.
/// @param scheduled  the pass's frames, by place
/// @param places     of the frames, in the order in which they begin
FilesOfPass files_of(const Store& store, const Wiring& wiring,
                     const std::vector<Schedule::Frame>& scheduled,
                     const std::vector<std::size_t>& places);

}  // namespace fluidcarve
