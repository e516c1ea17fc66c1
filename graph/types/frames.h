#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fluidcarve {

/// A sorted set of frame numbers. Parsed from `1001-1084`, `1-10,20-30`, `1-100x2` (every second frame), `1-10y3` (the frames that
/// `1-10x3` leaves out), `1-10:3` (staggered, as in OpenCue and fileseq: the same set as `1-10`).
class FrameSet {
public:
    FrameSet() = default;
    explicit FrameSet(std::vector<int> frames);

    /// @param fault  set to the reason if the text is wrong and nothing is returned
    /// @param most   number of frames that the text may name, repeated ones and those left out included
    static std::optional<FrameSet> parse(std::string_view text, std::string& fault, std::int64_t most = most_frames);
    static constexpr std::int64_t most_frames = 1'000'000;

    const std::vector<int>& frames() const { return frames_; }
    bool contains(int frame) const;
    std::optional<std::size_t> place(int frame) const;  ///< index in `frames()`
    std::string text() const;                           ///< shortest text that parse reads back

private:
    std::vector<int> frames_;
};

/// A file's name without its frame numbers: the text before the first and after the last. A name without one is both.
struct NameEnds {
    std::string begin, end;

    /// Whether both names could be one, by whatever numbers. False is certain.
    bool fits(const NameEnds& other) const;
};

/// A path with the last number of its file's name, outside of the extension, as a frame token: `a.0051.vdb` as `a.####.vdb`; empty if it
/// has none.
std::string with_frame_token(const std::string& path);

/// A path that may hold frame tokens: `####` (as many digits as hashes), `%04d`, `$F4`, `<frame>`, `<frame04>`.
class PathPattern {
public:
    PathPattern() = default;
    /// @param folder  base of a relative path; empty: the current folder
    explicit PathPattern(std::string text, std::string folder = {});

    /// A path that is the same for every frame, whatever looks like a token in it.
    static PathPattern literal(std::string path);

    const std::string& text() const { return text_; }
    bool per_frame() const { return per_frame_; }
    /// The path of one frame, relative paths joined to the folder. Without a token it is the same for all frames.
    std::string at(int frame) const;
    /// The text, a relative path joined to the folder.
    std::string in_its_folder() const;
    /// The name of every frame's file; nothing if their folders differ, too.
    std::optional<NameEnds> name_ends() const;
    /// Whether a file of any frame exists now.
    bool exists() const;
    /// The first part that looks like a frame token but is not one (`<fram>`, `$F99`, `%4d`, `@@@@`, `$JOB`), or empty.
    const std::string& bad_token() const { return bad_token_; }

private:
    struct Part {
        std::string text;  ///< literal text; empty for a frame number
        int digits = 0;
    };
    std::string text_;
    std::string folder_;
    std::string bad_token_;
    std::vector<Part> parts_;
    bool per_frame_ = false;
};

}  // namespace fluidcarve
