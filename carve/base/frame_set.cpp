#include "carve/base/frame_set.h"

#include "carve/base/failure.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace fluidcarve {

namespace {

std::string_view trimmed(std::string_view text) {
    constexpr auto blanks = " \t\r\n";
    const auto first = text.find_first_not_of(blanks);
    return first == std::string_view::npos
               ? std::string_view()
               : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Parses a whole number at the start of `text` and removes it from there.
std::optional<std::int64_t> take_number(std::string_view& text) {
    int out = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    if (error != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(stop - text.data()));
    return out;
}

/// Whether `text` contains a number too large for a frame number.
bool beyond_counting(std::string_view text) {
    while (!text.empty()) {
        int ignored = 0;
        const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), ignored);
        if (error == std::errc::result_out_of_range) return true;
        text.remove_prefix(error == std::errc{} ? static_cast<std::size_t>(stop - text.data()) : 1);
    }
    return false;
}

/// One range of a frame list, between two commas.
struct FrameRange {
    std::int64_t first = 0;
    std::int64_t last = 0;
    std::int64_t step = 1;
    char kind = 'x';

    /// Upper bound on the number of frames.
    std::int64_t most() const { return std::abs(last - first) / (kind == 'x' ? step : 1) + 1; }
    void add_to(std::vector<int>& frames) const {
        // Staggering (`:`) changes only the order of frames.
        const std::int64_t stride = (last < first ? -1 : 1) * (kind == 'x' ? step : 1);
        for (std::int64_t n = 0; n < most(); ++n)
            if (kind != 'y' || n % step != 0)
                frames.push_back(static_cast<int>(first + stride * n));
    }
};

std::optional<FrameRange> parse_range(std::string_view part, std::string& fault) {
    const auto wrong = [&](std::string_view why) {
        return fault = fmt::format("'{}' {}", part.substr(0, 60), why), std::nullopt;
    };
    const auto form = beyond_counting(part)
                          ? "has a number beyond 2147483647, the most that a frame can be"
                          : "is no frame or range; write 1001, 1001-1084 or 1001-1084x2";
    auto rest = part;
    FrameRange out;
    const auto first = take_number(rest);
    if (!first) return wrong(form);
    out.first = out.last = *first;
    if (rest.empty()) return out;
    if (rest.front() != '-') return wrong(form);
    rest.remove_prefix(1);
    const auto last = take_number(rest);
    if (!last) return wrong(form);
    out.last = *last;
    if (rest.empty()) return out;
    out.kind = rest.front();
    if (out.kind != 'x' && out.kind != 'y' && out.kind != ':') return wrong(form);
    rest.remove_prefix(1);
    const auto step = take_number(rest);
    if (!step || !rest.empty()) return wrong(form);
    if (*step == 0) return wrong("has a step of 0; the least is 1");
    // OpenCue writes descending ranges with a negative step.
    if (*step < 0 && out.last >= out.first)
        return wrong("has a negative step, but does not descend");
    out.step = std::abs(*step);
    return out;
}

}  // namespace

FrameSet::FrameSet(std::vector<int> frames) : frames_(std::move(frames)) {
    std::ranges::sort(frames_);
    frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
}

std::optional<FrameSet> FrameSet::parse(std::string_view text, std::string& fault,
                                        std::int64_t most) {
    if (trimmed(text).empty())
        return fault = "no frame is named; write 1001, 1001-1084 or 1001-1084x2", std::nullopt;
    std::vector<int> frames;
    std::int64_t total = 0;
    for (std::size_t begin = 0; begin <= text.size();) {
        const auto end = std::min(text.find(',', begin), text.size());
        const auto range = parse_range(trimmed(text.substr(begin, end - begin)), fault);
        if (!range) return std::nullopt;
        // Repeated frames count too, so that every text is parsed fast.
        total += range->most();
        if (total > most)
            return fault = fmt::format("'{}' names more than {} frames",
                                       trimmed(text).substr(0, 60), most),
                   std::nullopt;
        range->add_to(frames);
        begin = end + 1;
    }
    if (frames.empty())
        return fault = fmt::format("'{}' leaves no frame", trimmed(text).substr(0, 60)),
               std::nullopt;
    return FrameSet(std::move(frames));
}

bool FrameSet::contains(int frame) const { return std::ranges::binary_search(frames_, frame); }

std::optional<std::size_t> FrameSet::place(int frame) const {
    const auto found = std::ranges::lower_bound(frames_, frame);
    if (found == frames_.end() || *found != frame) return std::nullopt;
    return static_cast<std::size_t>(found - frames_.begin());
}

std::string FrameSet::text() const {
    const auto size = frames_.size();
    const auto step_at = [&](std::size_t n) { return std::int64_t{frames_[n + 1]} - frames_[n]; };
    const auto part = [&](std::size_t from, std::size_t length) {
        if (length == 1) return fmt::format("{}", frames_[from]);
        const auto step = step_at(from);
        return fmt::format("{}-{}", frames_[from], frames_[from + length - 1]) +
               (step == 1 ? "" : fmt::format("x{}", step));
    };
    // Dynamic programming from the last frame: the shortest text of each tail. A regular run may
    // leave its last frame to the next run.
    struct Choice {
        std::size_t cost = 0, run = 0, taken = 1;
    };
    std::vector<Choice> tails(size + 1);
    for (std::size_t n = size; n-- > 0;) {
        auto& tail = tails[n];
        tail.run = n + 1 == size                                   ? 1
                   : n + 2 == size || step_at(n) != step_at(n + 1) ? 2
                                                                   : tails[n + 1].run + 1;
        tail.cost = std::numeric_limits<std::size_t>::max();
        for (const auto length : {tail.run, tail.run - 1, std::size_t{1}}) {
            if (length != 1 && length < 3) continue;
            const auto cost = part(n, length).size() + 1 + tails[n + length].cost;
            if (cost < tail.cost) tail.cost = cost, tail.taken = length;
        }
    }
    std::string out;
    for (std::size_t n = 0; n < size; n += tails[n].taken)
        out += (n == 0 ? "" : ",") + part(n, tails[n].taken);
    return out;
}

std::string FrameSet::in_words() const {
    return (frames_.size() == 1 ? "frame " : "frames ") + text();
}

std::string staggered_note(std::string_view frames) {
    if (frames.find(':') == std::string_view::npos) return {};
    auto stepped = std::string(frames);
    std::ranges::replace(stepped, ':', 'x');
    return fmt::format(
        "{} names all of the frames, as on a farm, where a colon only changes their order; every "
        "n-th frame is {}",
        frames, stepped);
}

std::vector<int> even_frames(int first, int step, double count) {
    if (!(count <= static_cast<double>(FrameSet::most_frames)))
        throw Failure(fmt::format("that makes {:.0f} frames; a million are the most", count));
    constexpr double most = std::numeric_limits<int>::max();
    if (const double last = first + step * (count - 1); last > most)
        throw Failure(
            fmt::format("that makes frames up to {:.0f}; {:.0f} is the highest frame "
                        "number",
                        last, most));
    std::vector<int> out;
    for (int n = 0; n < static_cast<int>(count); ++n)
        out.push_back(static_cast<int>(first + std::int64_t{step} * n));
    return out;
}

}  // namespace fluidcarve
