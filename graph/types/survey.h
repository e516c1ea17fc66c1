#pragma once

#include "graph/types/outlook.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <typeindex>
#include <vector>

namespace fluidcarve {

/// A part of a reader's first output that the run will take by its name (Selection).
struct Pick {
    std::string part;
    std::type_index type = typeid(void);  ///< of the input that takes it
    std::string taker;                    ///< for messages: "'edges' takes carved.density"
};

/// Facts about a payload in a frame before it is read.
struct SurveyedFacts {
    std::optional<std::vector<std::string>> grids;  ///< names of its grids, in their order
    /// Width and height of the picture that the payload is, or covers; pixels.
    std::optional<std::array<int, 2>> pixels;
};

/// Interface for a node's `survey`: before a run starts, a reader looks at its files, and other
/// nodes at what they will receive.
class Survey {
public:
    virtual ~Survey() = default;
    virtual const std::vector<int>& frames() const = 0;  ///< frame numbers of the sequence
    virtual bool needs(int frame) const = 0;             ///< whether the run will read the frame
    /// Whether the run will read the output.
    virtual bool wants(std::string_view output) const = 0;
    /// Parts of the first output that the run will take.
    virtual const std::vector<Pick>& picks() const = 0;
    /// The frame uses the file of another one.
    virtual void stands_in(int frame, int file) = 0;
    /// States how many bytes of memory the frame will take, estimated from its file.
    virtual void expect(int frame, std::uint64_t bytes) = 0;
    /// Removes the frame for all nodes. Its neighbours become adjacent in time.
    virtual void leave_out(int frame) = 0;
    /// The file, or a grid in it, is missing or unreadable.
    virtual void missing(int frame, const std::string& message) = 0;
    /// States facts about a reader's output.
    virtual void delivers(int frame, std::string_view output, SurveyedFacts what) = 0;
    /// Facts about an input; null: unknown.
    virtual const SurveyedFacts* receives(int frame, std::string_view input) const = 0;
    /// States the region of an output, if headers or small files tell it.
    virtual void lies(std::string_view /*output*/, const Region&) {}
    virtual void warn(const std::string& message) = 0;
};

}  // namespace fluidcarve
