#include "runtime/run/preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace fluidcarve {
namespace {

/// Collects what one reader says of its files.
class SurveyOf : public Survey {
public:
    /// @param needed  frames that the run will read; nothing: all
    SurveyOf(const std::vector<int>& frames, const std::optional<FrameSet>& needed, std::set<std::string, std::less<>> wanted)
        : frames_(frames), needed_(needed), wanted_(std::move(wanted)) {}
    const std::vector<int>& frames() const override { return frames_; }
    bool needs(int frame) const override { return !needed_ || needed_->contains(frame); }
    bool wants(std::string_view output) const override { return wanted_.contains(output); }
    void stands_in(int frame, int file) override { stand_ins[frame] = file; }
    void expect(int, std::uint64_t bytes) override { most_bytes = std::max(most_bytes, bytes); }
    void leave_out(int frame) override { left_out.insert(frame); }
    void missing(int frame, const std::string& message) override { lost.emplace_back(frame, message); }
    void warn(const std::string& message) override { warnings.push_back(message); }

    std::map<int, int> stand_ins;
    std::uint64_t most_bytes = 0;
    std::set<int> left_out;
    std::vector<std::pair<int, std::string>> lost;
    std::vector<std::string> warnings;

private:
    const std::vector<int>& frames_;
    const std::optional<FrameSet>& needed_;
    const std::set<std::string, std::less<>> wanted_;
};

/// Names of a node's outputs that the run reads or caches.
std::set<std::string, std::less<>> wanted_outputs(const Pipeline& pipeline, const std::vector<bool>& needed, std::size_t node, bool cache) {
    std::set<std::string, std::less<>> out;
    if (cache && pipeline.nodes[node].kept)
        for (const auto& output : pipeline.nodes[node].outputs) out.insert(output.name);
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n)
        for (const auto& links : pipeline.nodes[n].inputs)
            for (const auto& link : links)
                if (needed[n] && link.node == node) out.insert(pipeline.nodes[node].outputs[link.output].name);
    return out;
}

/// What all readers say of their files.
struct Inputs {
    std::vector<int> frames;  ///< the sequence without the frames that readers leave out
    std::vector<Fault> missing;
    std::map<std::size_t, std::map<int, int>> stand_ins;  ///< per node: frame to the frame whose file it uses
    std::map<std::size_t, std::uint64_t> most_bytes;      ///< per node: bytes of its largest frame
};

/// Calls the survey of each reader.
/// @param needed       per node: whether the run needs it
/// @param in_sequence  per node: whether it is needed in every frame of the sequence, not only in delivered frames
Inputs survey(const Pipeline& pipeline, const std::vector<bool>& needed, const std::vector<bool>& in_sequence, const std::optional<FrameSet>& deliver,
              bool cache, Report& report) {
    Inputs out;
    std::set<int> left_out;
    for (std::size_t n = 0; n < pipeline.nodes.size(); ++n) {
        const auto& node = pipeline.nodes[n];
        if (!needed[n] || !node.type->survey) continue;
        const std::vector<int> once{pipeline.frames.frames().front()};
        const std::optional<FrameSet> read = node.rate == Rate::fixed || in_sequence[n] ? std::nullopt : deliver;
        SurveyOf of(node.rate == Rate::fixed ? once : pipeline.frames.frames(), read, wanted_outputs(pipeline, needed, n, cache));
        node.type->survey(node.params.get(), of);
        for (const auto& warning : of.warnings) report.warn(n, warning);
        out.stand_ins[n] = of.stand_ins;
        out.most_bytes[n] = of.most_bytes;
        for (const auto& [frame, message] : of.lost)
            if (of.needs(frame))
                out.missing.push_back(
                    {node.name, node.type->name, node.rate == Rate::fixed ? std::nullopt : std::optional(frame), message, Failure::Kind::input});
        std::vector<int> asked;
        for (const auto frame : of.left_out)
            if (deliver && deliver->contains(frame)) asked.push_back(frame);
        if (!asked.empty()) report.warn(n, fmt::format("left out for want of a file, though -f names them: {}", FrameSet(asked).text()));
        left_out.insert(of.left_out.begin(), of.left_out.end());
    }
    for (const auto frame : pipeline.frames.frames())
        if (!left_out.contains(frame)) out.frames.push_back(frame);
    // With frames left out, the nearest file of a frame may be another one: find the stand-ins again.
    for (auto& [n, stand_ins] : out.stand_ins) {
        if (stand_ins.empty() || left_out.empty() || pipeline.nodes[n].rate == Rate::fixed) continue;
        const std::optional<FrameSet> none = FrameSet();
        SurveyOf again(out.frames, none, {});
        pipeline.nodes[n].type->survey(pipeline.nodes[n].params.get(), again);
        stand_ins = again.stand_ins;
    }
    return out;
}

/// Per node: whether a gatherer needs it, and so needs it in every frame of the sequence, not only in delivered frames.
std::vector<bool> in_sequence(const Pipeline& pipeline, const Plan& plan) {
    std::vector<bool> out(pipeline.nodes.size(), false);
    for (const auto& pass : plan.passes)
        for (const auto& needs : pass.gatherer_needs)
            for (std::size_t n = 0; n < needs.size(); ++n) out[n] = out[n] || needs[n];
    return out;
}

std::string folder_of(const RunOptions& options, const char* part) { return options.cache ? options.work_folder + part : std::string(); }

}  // namespace

Preparation::Preparation(const Pipeline& pipeline, const Registry& registry, const RunOptions& options, const Wish& wish,
                         const std::optional<FrameSet>& deliver, Report& report)
    : pipeline_(pipeline),
      plan_(make_plan(pipeline, wish)),
      cache_(registry, folder_of(options, "")),
      files_(folder_of(options, "/files")),
      keys_(pipeline, frames_, stand_ins_, files_, [this](std::size_t n, std::size_t place) { return wants(n, place); }),
      store_(pipeline, frames_, keys_, cache_, files_) {
    every_ = in_sequence(pipeline, plan_);
    auto inputs = survey(pipeline, plan_.needed, every_, deliver, options.cache, report);
    frames_ = std::move(inputs.frames);
    missing_ = std::move(inputs.missing);
    stand_ins_ = std::move(inputs.stand_ins);
    input_bytes_ = std::move(inputs.most_bytes);
    keys_.reset();
    for (const auto frame : frames_) delivered_.push_back(!deliver || deliver->contains(frame));

    std::vector<std::string> paths;
    for (std::size_t n = 0; n < pipeline.nodes.size() && cache_.on(); ++n)
        for (std::size_t place = 0; plan_.needed[n] && place < frames_.size(); ++place) {
            if (!every_[n] && !delivered_[place]) continue;
            for (auto& path : keys_.files(n, place)) paths.push_back(std::move(path));
            if (pipeline.nodes[n].rate != Rate::frame) break;
        }
    files_.prepare(paths);
}

std::vector<bool> Preparation::reads(std::size_t n) const {
    if (!plan_.needed[n]) return std::vector<bool>(frames_.size(), false);
    if (every_[n] || pipeline_.nodes[n].rate != Rate::frame) return std::vector<bool>(frames_.size(), true);
    return delivered_;
}

bool Preparation::wants(std::size_t n, std::size_t place) const {
    static Context::Host silent;
    Context where(silent, frames_);
    const auto& node = pipeline_.nodes[n];
    return !node.type->wants || node.type->wants(node.params.get(), where.at(place));
}

std::vector<int> Preparation::delivered_frames() const {
    std::vector<int> out;
    for (std::size_t place = 0; place < frames_.size(); ++place)
        if (delivered_[place]) out.push_back(frames_[place]);
    return out;
}

Schedule Preparation::schedule() { return schedule(false); }
Schedule Preparation::careful_schedule() { return schedule(true); }

Schedule Preparation::schedule(bool careful) {
    std::map<std::pair<std::size_t, std::size_t>, bool> results, digests;
    const auto once = [](auto& known, std::size_t n, std::size_t place, const auto& find) {
        const auto [found, fresh] = known.try_emplace({n, place}, false);
        if (fresh) found->second = find();
        return found->second;
    };
    const Known known{[&](std::size_t n, std::size_t place) {
                          return once(results, n, place, [&] { return careful ? store_.knows_whole(n, place) : store_.knows(n, place); });
                      },
                      [&](std::size_t n, std::size_t place) {
                          return once(digests, n, place, [&] { return careful ? store_.knows_whole_digest(n, place) : store_.knows_digest(n, place); });
                      },
                      [this](std::size_t n, std::size_t place) { return wants(n, place); },
                      [&](std::size_t n, std::size_t place) { return !careful && cache_.on() && static_cast<bool>(keys_.kept(n, place)); }};
    return make_schedule(pipeline_, plan_, delivered_, known);
}

Schedule Preparation::uncached_schedule() const {
    const auto nothing = [](std::size_t, std::size_t) { return false; };
    return make_schedule(pipeline_, plan_, delivered_, {nothing, nothing, [this](std::size_t n, std::size_t place) { return wants(n, place); }, nothing});
}

void Preparation::repeat_said(const Schedule& schedule, Report& report) {
    if (!cache_.on()) return;
    const auto uncached = uncached_schedule();
    const auto runs_once = [](const Schedule& in, std::size_t n) { return in.once[n] == Schedule::Action::run; };
    const auto repeat = [&](std::size_t n, const Said& said) {
        for (const auto& warning : said.warnings) report.warn(n, warning);
        for (const auto& [section, entry] : said.report) report.entry(n, section, entry);
    };
    for (std::size_t n = 0; n < pipeline_.nodes.size(); ++n) {
        const auto& node = pipeline_.nodes[n];
        const auto now = frames_of(schedule, n), anew = frames_of(uncached, n);
        const bool once = runs_once(uncached, n) && !runs_once(schedule, n);
        for (std::size_t place = 0; place < frames_.size(); ++place) {
            if (node.type->digest != typeid(void) && anew.taken_anew.contains(place) && !now.taken_anew.contains(place))
                repeat(n, store_.said_of_digest(n, place));
            if ((once && place == 0) || (anew.run.contains(place) && !now.run.contains(place))) repeat(n, store_.said(n, place));
        }
    }
}

}  // namespace fluidcarve
