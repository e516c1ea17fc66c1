#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// Frames in the order of time, each once. Parsed from `1001-1084`, `1-10,20-30`, `1-100x2` (every second),
/// `1-10y3` (those that x3 leaves out), `1-10:3` (staggered as in OpenCue and fileseq: as a set, all of them).
class FrameSet {
public:
    FrameSet() = default;
    explicit FrameSet(std::vector<int> frames);

    /// @param fault  set to what is wrong, in words, when nothing is returned
    static std::optional<FrameSet> parse(std::string_view text, std::string& fault);

    const std::vector<int>& frames() const { return frames_; }
    bool contains(int frame) const;
    std::optional<std::size_t> place(int frame) const;  ///< position in the sequence
    std::string text() const;                           ///< shortest form that parse reads back

private:
    std::vector<int> frames_;
};

/// A path that may hold frame tokens: `####` (as many digits as hashes), `%04d`, `$F4`, `<frame>`, `<frame04>`.
class PathPattern {
public:
    PathPattern() = default;
    /// @param folder  where a relative path starts; empty: the current folder
    explicit PathPattern(std::string text, std::string folder = {});

    const std::string& text() const { return text_; }
    bool per_frame() const { return per_frame_; }
    /// The path for one frame, below the folder if relative. Without a token: the path itself.
    std::string at(int frame) const;
    /// Whether any file fits the pattern now, whatever its frame.
    bool exists() const;
    /// The first thing that looks like a token but is none (`<fram>`, `$F99`, `%4d`, `@@@@`, `$JOB`), or empty.
    const std::string& bad_token() const { return bad_token_; }

private:
    struct Part {
        std::string text;  ///< literal, or empty for a frame number
        int digits = 0;
    };
    std::string text_;
    std::string folder_;
    std::string bad_token_;
    std::vector<Part> parts_;
    bool per_frame_ = false;
};

}  // namespace fluidcarve
