#pragma once

#include "formats/file/input_file.h"
#include "runtime/keep/store.h"
#include "runtime/plan/frame_run.h"
#include "runtime/plan/schedule.h"

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
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

/// Makes the system read the files of the next frames while earlier frames are processed. It asks
/// in a thread of its own, since a slow disk may block the caller. If all files to read are
/// together larger than memory, it also drops files from the system's cache that no later frame
/// reads, or that frames have written.
class ReadAhead {
public:
    /// Gives the system advice about a file.
    using Advise = std::function<void(const std::string& path, InputFile::Advice)>;

    /// @param ahead   number of frames to read ahead
    /// @param memory  bytes
    ReadAhead(FilesOfPass files, std::size_t ahead, std::uint64_t memory,
              Advise advise = advise_system);
    ~ReadAhead();
    ReadAhead(const ReadAhead&) = delete;
    ReadAhead& operator=(const ReadAhead&) = delete;

    /// Tells that the work on a frame begins, or is done. For any thread.
    void begin(std::size_t frame);
    void end(std::size_t frame);

    /// Leaves out a file that can't be opened, since its reader reports that.
    static void advise_system(const std::string& path, InputFile::Advice advice);

private:
    void work(const std::stop_token& stop);
    /// Drops the files of a frame. @param done  the frame
    void drop(std::size_t done);

    const FilesOfPass files_;
    const std::size_t ahead_;
    const Advise advise_;
    std::map<std::string, std::size_t> last_;  ///< file to the last frame that reads it
    bool drops_ = false;
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::size_t next_ = 0, until_ = 0;  ///< the next frames to read ahead
    std::vector<std::size_t> done_;     ///< frames whose files may be dropped
    /// Frames finished last: their files may not be on the disk yet.
    std::deque<std::size_t> lately_;
    std::jthread thread_;
};

/// Finds the files that nodes read and write in the frames of a pass.
/// @param scheduled  the pass's frames, `[t]`
/// @param indices    of the frames, in the order in which they begin
FilesOfPass files_of(const Store& store, const Wiring& wiring,
                     const std::vector<Schedule::Frame>& scheduled,
                     const std::vector<std::size_t>& indices);

}  // namespace fluidcarve
