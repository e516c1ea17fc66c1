#include "runtime/flow/read_ahead.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

namespace fluidcarve {

void ReadAhead::advise_system(const std::string& path, InputFile::Advice advice) {
    try {
        InputFile(path, {"an input"}).advise(advice);
    } catch (const Unreadable&) {}
}

ReadAhead::ReadAhead(FilesOfPass files, std::size_t ahead, std::uint64_t memory, Advise advise)
    : files_(std::move(files)), ahead_(ahead), advise_(std::move(advise)) {
    for (std::size_t frame = 0; frame < files_.read.size(); ++frame)
        for (const auto& path : files_.read[frame]) last_[path] = frame;
    std::uint64_t all = 0;
    for (const auto& [path, frame] : last_) {
        std::error_code missing;
        const auto size = std::filesystem::file_size(path, missing);
        if (!missing) all += size;
    }
    drops_ = all > memory;
    if (!last_.empty()) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

ReadAhead::~ReadAhead() = default;

void ReadAhead::begin(std::size_t frame) {
    const std::lock_guard lock(mutex_);
    until_ = std::max(until_, std::min(frame + 1 + ahead_, files_.read.size()));
    changed_.notify_one();
}

void ReadAhead::end(std::size_t frame) {
    const std::lock_guard lock(mutex_);
    // Files of finished frames are not requested: that would read dropped files again.
    next_ = std::max(next_, frame + 1);
    if (!drops_) return;
    done_.push_back(frame);
    changed_.notify_one();
}

void ReadAhead::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [&] { return next_ < until_ || !done_.empty(); })) {
        const auto done = std::exchange(done_, {});
        const bool asks = next_ < until_;
        const auto frame = asks ? next_++ : 0;
        lock.unlock();
        for (const auto gone : done) drop(gone);
        if (asks)
            for (const auto& path : files_.read[frame]) advise_(path, InputFile::Advice::soon);
        lock.lock();
    }
}

void ReadAhead::drop(std::size_t done) {
    for (const auto& path : files_.read[done])
        if (last_[path] == done) advise_(path, InputFile::Advice::over);
    // The system drops only data that is on the disk, and begins to write the rest, so it is told
    // again later.
    lately_.push_back(done);
    if (lately_.size() > ahead_ + 2) lately_.pop_front();
    for (const auto frame : lately_)
        for (const auto& path : files_.written[frame]) advise_(path, InputFile::Advice::over);
}

FilesOfPass files_of(const Store& store, const Wiring& wiring,
                     const std::vector<Schedule::Frame>& scheduled,
                     const std::vector<std::size_t>& indices) {
    FilesOfPass out;
    for (const auto t : indices) {
        auto &read = out.read.emplace_back(), &written = out.written.emplace_back();
        for (const auto n : wiring.units) {
            if (!scheduled[t].reads(n)) continue;
            std::ranges::move(store.inputs(n, t), std::back_inserter(read));
            std::ranges::move(store.outputs(n, t), std::back_inserter(written));
        }
    }
    return out;
}

}  // namespace fluidcarve
