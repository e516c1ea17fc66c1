#pragma once

#include <optional>
#include <string>
#include <vector>

namespace fluidcarve {

/// A file's name without its frame numbers: the text before the first and after the last number.
/// Without a number, both are the whole name.
struct NameEnds {
    std::string begin, end;

    /// Whether both names may be equal for some numbers. False is certain, true is not.
    bool fits(const NameEnds& other) const;
};

/// A path with the last number of its file's name, outside of the extension, replaced by a frame
/// token: `a.0051.vdb` as `a.####.vdb`; empty if it has none.
std::string with_frame_token(const std::string& path);

/// A path that may hold frame tokens: `####` (as many digits as hashes), `%04d`, `$F4`, `<frame>`,
/// `<frame04>`.
class PathPattern {
public:
    PathPattern() = default;
    /// @param folder  base of a relative path; empty: the current folder
    explicit PathPattern(std::string text, std::string folder = {});

    /// A path that is the same for every frame, whatever looks like a token in it.
    static PathPattern literal(std::string path);

    const std::string& text() const { return text_; }
    bool per_frame() const { return per_frame_; }
    /// The path of one frame, relative paths joined to the folder. Without a token it is the same
    /// for all frames.
    std::string at(int frame) const;
    /// The text, a relative path joined to the folder.
    std::string in_its_folder() const;
    /// The ends of the names of all frames' files; nothing if the folders differ, too.
    std::optional<NameEnds> name_ends() const;
    /// Whether a file of any frame exists now.
    bool exists() const;
    /// The first part that looks like a frame token but is not one (`<fram>`, `$F99`, `%4d`,
    /// `@@@@`, `$JOB`), or empty.
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
