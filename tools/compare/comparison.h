#pragma once

#include "carve/base/frame_set.h"
#include "tools/compare/file_comparer.h"
#include "tools/reading/sequences.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <utility>
#include <vector>

namespace fluidcarve {

/// The verdicts on what was compared, from the best to the worst.
enum class Verdict { same, within, warning, different };

/// "same", "within", "warning" or "different".
std::string name_of(Verdict verdict);

/// How `diff` judges.
struct Thresholds {
    Tolerance tolerance;
    double fail_percent = 0;

    Verdict judge(const PartDifference& part) const;
};

/// What is known of a part, such as a grid, over all frames.
struct PartComparison {
    PartDifference sums;
    int worst_frame = 0;              ///< of `sums.worst`
    Verdict verdict = Verdict::same;  ///< the worst of all frames
    std::vector<int> differing;       ///< frames with the verdict `different`
    /// PartDifference::faults, and the frames that have them.
    std::vector<std::pair<std::string, std::vector<int>>> faults;
};

/// Two sequences, or files, and what is known of them.
struct SequenceComparison {
    FileSequence a, b;
    FrameSet frames, only_a, only_b;  ///< frames compared, and those that one side lacks
    std::vector<PartComparison> parts;

    void add(int frame, const std::vector<PartDifference>& found, const Thresholds& thresholds);
    Verdict verdict() const;
    bool per_frame() const { return a.per_frame(); }
};

/// For people, in lines.
std::string to_text(const SequenceComparison& comparison, const Thresholds& thresholds);
/// One entry of `sequences` in the output of `diff --json`.
nlohmann::ordered_json to_json(const SequenceComparison& comparison);

/// The place of the greatest difference: "frame 53, voxel [12, 4, 7], world [1.2, 0.4, 0.7]".
std::string place_of(const PartComparison& part, bool per_frame);

}  // namespace fluidcarve
