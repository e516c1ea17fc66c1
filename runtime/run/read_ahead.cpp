#include "runtime/run/read_ahead.h"

#include "graph/input_file.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

namespace fluidcarve {
namespace {

/// Tells the system what will be read of a file. A file that can't be opened is left to its reader, who says why.
void tell_of(const std::string& path, InputFile::Use use) {
    try {
        InputFile(path, {"an input"}).advise(use);
    } catch (const Unreadable&) {}
}

}  // namespace

ReadAhead::ReadAhead(std::vector<std::vector<std::string>> files, std::size_t ahead, std::uint64_t memory) : files_(std::move(files)), ahead_(ahead) {
    for (std::size_t frame = 0; frame < files_.size(); ++frame)
        for (const auto& path : files_[frame]) last_[path] = frame;
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
    until_ = std::max(until_, std::min(frame + 1 + ahead_, files_.size()));
    changed_.notify_one();
}

void ReadAhead::end(std::size_t frame) {
    if (!drops_) return;
    const std::lock_guard lock(mutex_);
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
        for (const auto gone : done)
            for (const auto& path : files_[gone])
                if (last_[path] == gone) tell_of(path, InputFile::Use::over);
        if (asks)
            for (const auto& path : files_[frame]) tell_of(path, InputFile::Use::soon);
        lock.lock();
    }
}

std::vector<std::vector<std::string>> files_read(const Store& store, const Wiring& wiring, const std::vector<Schedule::Frame>& scheduled,
                                                 const std::vector<std::size_t>& places) {
    std::vector<std::vector<std::string>> out;
    for (const auto place : places) {
        auto& files = out.emplace_back();
        for (const auto n : wiring.units)
            if (scheduled[place].reads(n)) std::ranges::move(store.inputs(n, place), std::back_inserter(files));
    }
    return out;
}

}  // namespace fluidcarve
