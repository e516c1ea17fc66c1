#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// A sorted set of frame numbers. Parsed from `1001-1084`, `1-10,20-30`, `1-100x2` (every second
/// frame), `1-10y3` (the frames that `1-10x3` leaves out), `1-10:3` (staggered, as in OpenCue and
/// fileseq: the same set as `1-10`).
class FrameSet {
public:
    FrameSet() = default;
    explicit FrameSet(std::vector<int> frames);

    /// @param fault  set to the reason if the text is wrong and nothing is returned
    /// @param most   largest number of frames that the text may name; repeated and left-out frames
    ///   count
    static std::optional<FrameSet> parse(std::string_view text, std::string& fault,
                                         std::int64_t most = most_frames);
    static constexpr std::int64_t most_frames = 1'000'000;

    const std::vector<int>& frames() const { return frames_; }
    bool contains(int frame) const;
    std::optional<std::size_t> place(int frame) const;  ///< index in `frames()`, if contained
    std::string text() const;                           ///< shortest text that parse reads back
    std::string in_words() const;                       ///< "frame 7", "frames 7-9"

private:
    std::vector<int> frames_;
};

/// Explains a frame set with a colon to users who take it for a step: "1-10:2 names all of the
/// frames, ..."; empty if it has no colon.
std::string staggered_note(std::string_view frames);

/// Frame numbers in even steps.
/// @param count  whole, perhaps too many
/// @throws Failure if there are more than FrameSet::most_frames, or numbers beyond int
std::vector<int> even_frames(int first, int step, double count);

}  // namespace fluidcarve
