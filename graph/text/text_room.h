#pragma once

#include <cstddef>
#include <string>

namespace fluidcarve {

/// Room for the text of a pipeline, with all that aliases, `${name}` and extended files add:
/// without a limit, a small file could fill all memory.
class TextRoom {
public:
    static constexpr std::size_t most_mib = 16;

    /// Takes room for a text. @return false if there is not enough left, now and from now on
    bool take(std::size_t bytes) {
        full_ = full_ || bytes > left_;
        left_ = full_ ? 0 : left_ - bytes;
        return !full_;
    }
    bool full() const { return full_; }
    /// What is wrong with the text for which there was no room.
    static std::string fault() {
        return "here the pipeline grows beyond " + std::to_string(most_mib) +
               " MiB of text, with all aliases, ${names} and extended files: no pipeline needs so "
               "much; repeat less";
    }

private:
    std::size_t left_ = most_mib << 20;
    bool full_ = false;
};

}  // namespace fluidcarve
