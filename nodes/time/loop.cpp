#include "nodes/time/loop.h"

#include "graph/text/problem.h"
#include "nodes/time/between.h"
#include "nodes/time/closing.h"
#include "nodes/time/sequence.h"
#include "nodes/time/thumbnails.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>
#include <optional>

namespace fluidcarve {

namespace {
/// Lengths that a loop may have, frames.
struct Lengths {
    int least = 0, most = 0;
};
}  // namespace

/// The lengths are stated as `n` or `[least, most]`.
template <>
struct ParamTraits<Lengths> {
    static Shape shape() { return {Shape::Kind::any_of, {}, {ParamTraits<int>::shape(), ParamTraits<std::vector<int>>::shape()}}; }
    static std::optional<Lengths> parse(const Value& value, ValueReader& reader) {
        if (value.kind == Value::Kind::scalar) {
            const auto one = ParamTraits<int>::parse(value, reader);
            return one ? std::optional(Lengths{*one, *one}) : std::nullopt;
        }
        const auto both = ParamTraits<std::vector<int>>::parse(value, reader);
        if (!both) return std::nullopt;
        if (both->size() != 2) return reader.fault(value, fmt::format("must have one number or two, not {}", both->size())), std::nullopt;
        return Lengths{(*both)[0], (*both)[1]};
    }
    static std::string text(const Lengths& lengths) { return fmt::format("[{}, {}]", lengths.least, lengths.most); }
};

namespace {

class Loop {
public:
    struct Params {
        Lengths lengths;
        Auto<int> fade;
        int loops = 1;
        Auto<int> start;
    };
    struct Ports {
        Ref<Volume> source;
        Optional<VectorGrid> velocity;
        Ref<Volume> volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        const auto [least, most] = params.lengths;
        if (least < 2 || most > most_frames) check.fault("frames", fmt::format("'frames' must be from 2 to {}", most_frames));
        if (least > most) check.fault("frames", fmt::format("'frames' must rise: [{}, {}]", most, least));
        if (params.fade && *params.fade >= least)
            check.fault("fade", fmt::format("a fade of {} frames leaves none of the {} frames of the loop as it is; lower it", *params.fade, least));
    }

    static std::vector<int> retimes(const Params& params, const std::vector<int>& frames) {
        const auto place = Place(params, frames);
        std::vector<int> out;
        for (int n = 0; n < params.lengths.most * params.loops; ++n) out.push_back(place.first + place.step * n);
        return out;
    }

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(*io.source, io.velocity, context);
        thumbnails_.add(source_.at(source_.size() - 1));
    }

    void finish(const Params& params, Ports&, Context& context) {
        place_ = Place(params, source_.numbers());
        const auto [least, most] = params.lengths;
        loop_ = best(params, static_cast<std::size_t>(least), static_cast<std::size_t>(most));
        const int from = source_.numbers()[loop_.first], to = source_.numbers()[loop_.first + loop_.length - 1];
        context.report("loop", {{"first", from}, {"last", to}, {"frames", loop_.length}, {"fade", loop_.fade}, {"difference", loop_.difference}});
        if (loop_.difference > much) context.warn(unlike(params));
        find_closing(context);
    }

    void run(const Params& params, Ports& io, Context& context) const {
        const auto length = loop_.length, n = static_cast<std::size_t>((context.frame() - place_.first) / place_.step) % length, at = loop_.first + n;
        if (n + loop_.fade < length) {
            io.volume = std::make_shared<Volume>(source_.at(at).volume);
            return;
        }
        const auto frame = static_cast<int>(n + loop_.fade - length);
        const auto a = source_.at(at).volume, b = source_.at(before(at, length)).volume;
        const auto share = [&](const openvdb::Vec3d& world) { return closing_ ? closing_->share(frame, world) : double(frame + 1) / double(loop_.fade + 1); };
        io.volume = std::make_shared<Volume>(volume_mixed(a, b, share, 2 * frame + 1 < static_cast<int>(loop_.fade) ? a : b));
    }

private:
    static constexpr int most_frames = 100000;
    static constexpr double much = 4;  ///< difference of the ends from which on it is warned of

    /// What is known of a loop before the frames are.
    struct Place {
        int first = 1, step = 1;

        Place() = default;
        /// @throws Failure if the sequence is shorter than the loop, or lacks frames
        Place(const Params& params, const std::vector<int>& frames) : first(params.start.value_or(frames.front())) {
            if (frames.size() > 1) step = frames[1] - frames[0];
            for (std::size_t n = 1; n < frames.size(); ++n)
                if (frames[n] - frames[n - 1] != step)
                    throw Failure(
                        fmt::format("a loop needs all frames, but between {} and {} some are left out; state `frames` without a gap, or let "
                                    "`missing: hold` of the reader fill it",
                                    frames[n - 1], frames[n]));
            if (static_cast<std::size_t>(params.lengths.most) > frames.size())
                throw Failure(fmt::format("a loop of {} frames needs as many of the source, which has {}; lower 'frames'", params.lengths.most, frames.size()));
        }
    };

    /// The frame into which one at the loop's end fades: a loop before it. Before the first frame of the source, that one is held.
    static std::size_t before(std::size_t at, std::size_t length) { return at - std::min(at, length); }

    /// A part of the source as a loop.
    struct Closed {
        std::size_t first = 0, length = 1, fade = 0;
        double difference = std::numeric_limits<double>::max();  ///< mean of the frames that fade into each other
    };
    /// The loop that closes best, of all lengths in a range.
    Closed best(const Params& params, std::size_t least, std::size_t most) const {
        Closed out;
        for (auto length = least; length <= most; ++length) {
            const auto fade = params.fade ? static_cast<std::size_t>(*params.fade) : (length + 3) / 4;
            for (std::size_t first = 0; first + length <= source_.size(); ++first) {
                double sum = 0;
                for (auto at = first + length - fade; at < first + length; ++at) sum += thumbnails_.difference(before(at, length), at);
                if (const double mean = sum / static_cast<double>(fade); mean < out.difference) out = {first, length, fade, mean};
            }
        }
        return out;
    }

    /// Finds where and when the end goes over into what comes before. Places that differ much take longer.
    void find_closing(Context& context) {
        openvdb::CoordBBox box;
        FloatGrid::ConstPtr like;
        const auto each = [&](const auto& visit) {
            for (std::size_t n = 0; n < loop_.fade; ++n) {
                context.check_cancelled();
                const auto at = loop_.first + loop_.length - loop_.fade + n;
                const auto shown = shown_in(source_.at(at), source_.at(before(at, loop_.length)));
                if (!shown || (like && shown->first.shown->transform() != like->transform())) return false;
                visit(shown->first.shown, shown->second.shown);
            }
            return true;
        };
        const bool alike = each([&](const FloatGrid::ConstPtr& end, const FloatGrid::ConstPtr& before) {
            like = end;
            for (const auto& grid : {end, before}) box.expand(grid->evalActiveVoxelBoundingBox());
        });
        if (!alike || box.empty()) return;
        constexpr double briefest = 3;
        const auto all = static_cast<double>(loop_.fade);
        closing_.emplace(*like, loop_.fade, std::clamp(loop_.difference, std::min(briefest, all), all), box);
        each([&](const FloatGrid::ConstPtr& end, const FloatGrid::ConstPtr& before) { closing_->add(*end, *before); });
        closing_->finish();
    }

    /// What a warning says of ends that differ much, and which length near the one asked for would close better.
    std::string unlike(const Params& params) const {
        const auto out =
            fmt::format("the ends of the loop differ {:.2g} times as much as neighbouring frames, so that their fade will be seen", loop_.difference);
        const auto near = loop_.length / 4;
        const auto other = best(params, std::max(loop_.fade + 1, loop_.length - near), std::min(loop_.length + near, source_.size()));
        return other.length == loop_.length ? out + "; a longer sequence leaves more choice"
                                            : fmt::format("{}; with `frames: {}` it would be {:.2g}", out, other.length, other.difference);
    }

    Sequence source_;
    Thumbnails thumbnails_;
    Place place_;
    Closed loop_;
    std::optional<Closing> closing_;  ///< nothing if no grid shows where both sides match
};

}  // namespace

NodeType time_loop() {
    using Params = Loop::Params;
    return Declare<Loop>("time.loop",
                         "A loop of a wished length: of all parts of the sequence the one that closes best. Its last frames go over into those before its "
                         "first, each place when both match best there.")
        .input("source", &Loop::Ports::source, "The grids, or one grid.")
        .input("velocity", &Loop::Ports::velocity, "Velocity, staggered or not. Where ends match is judged by where things move to, too.")
        .required("frames", &Params::lengths,
                  "Length of the loop, in frames. [20, 30] takes the length in this range that closes best, writes 30 frames in any case, in which it goes "
                  "round, and reports the length.")
        .param("fade", &Params::fade, Unit::frames, between(1, 1e5),
               "Number of its last frames that fade. It is best if the source has so many frames more than the loop: else its first frame is held. auto is a "
               "quarter.")
        .param("loops", &Params::loops, Unit::none, between(1, 1000), "How often the loop is written, one behind the other, to look at it.")
        .param("start", &Params::start, Unit::frames, any_number(), "Number of the first frame. auto is that of the source.")
        .output("volume", &Loop::Ports::volume,
                "The same grids. Frames before the fade stay bit for bit. Whole numbers, masks and points are those of the nearer side.")
        .names_as("volume", "source")
        .kept();
}

}  // namespace fluidcarve
