#pragma once

#include "graph/types/param.h"
#include "nodes/payloads.h"

#include <vector>

namespace fluidcarve {

class NodeCheck;

/// The parameter `range` of a sum of energies: `auto`, `[low, high]`, or a list with one of these per term.
struct TermRanges {
    std::vector<Auto<Interval>> each{std::nullopt};
    bool shared = true;  ///< one for all terms

    const Auto<Interval>& of(std::size_t term) const { return each.at(shared ? 0 : term); }
    /// Whether any is left to the sequence.
    bool gathers() const;
    /// Faults a list that is not one per term.
    void check(std::size_t terms, NodeCheck& check) const;
};

template <>
struct ParamTraits<TermRanges> {
    static Shape shape();
    static std::optional<TermRanges> parse(const Value& value, ValueReader& reader);
    static std::string text(const TermRanges& ranges);
};

/// What each of several grids ranges over in one frame: smallest and largest active value, low > high where there is none.
struct FrameRanges {
    std::vector<Interval> each;
};

/// The ranges of one frame's energies, as far as they are `auto`; of the others those of no values.
/// @throws Failure as active_range
std::shared_ptr<FrameRanges> ranges_of(const TermRanges& stated, const std::vector<Ref<FloatGrid>>& terms);

/// What the terms that are `auto` range over in a sequence.
class GatheredRanges {
public:
    void add(const FrameRanges& frame);
    /// The range of a term, stated or gathered.
    Interval of(const TermRanges& stated, std::size_t term) const;

private:
    std::vector<Interval> found_;
};

}  // namespace fluidcarve
