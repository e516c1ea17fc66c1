#pragma once

#include "carve/volume/volume.h"
#include "graph/types/param.h"

#include <optional>
#include <vector>

namespace fluidcarve {

class NodeCheck;

/// The parameter `range` of a sum of energies: `auto`, `[low, high]`, or a list with one of these
/// per term.
struct TermRanges {
    std::vector<Auto<Interval>> each{std::nullopt};
    bool shared = true;  ///< `each` has one entry for all terms; false: one per term

    const Auto<Interval>& of(std::size_t term) const { return each.at(shared ? 0 : term); }
    /// Whether any range is `auto` and must be gathered from the sequence.
    bool gathers() const;
    /// Reports a fault if a list does not have one entry per term.
    void check(std::size_t terms, NodeCheck& check) const;
};

template <>
struct ParamTraits<TermRanges> {
    static Shape shape();
    static std::optional<TermRanges> parse(const Value& value, ValueReader& reader);
    static std::string text(const TermRanges& ranges);
};

/// The range of each term in one frame: smallest and largest active value; low > high if there is
/// none.
struct FrameRanges {
    std::vector<Interval> each;
};

/// The ranges of one frame's terms. Terms whose range is stated get the empty range.
/// @throws Failure as active_range
std::shared_ptr<FrameRanges> ranges_of(const TermRanges& stated,
                                       const std::vector<Ref<FloatGrid>>& terms);

/// Gathers the ranges of the terms whose range is `auto` over a sequence.
class GatheredRanges {
public:
    void add(const FrameRanges& frame);
    /// The range of a term, stated or gathered.
    Interval of(const TermRanges& stated, std::size_t term) const;

private:
    std::vector<Interval> found_;
};

}  // namespace fluidcarve
