#include "nodes/time.h"

#include "carve/base/failure.h"
#include "carve/time/between.h"
#include "carve/time/pace.h"
#include "carve/time/sequence.h"
#include "carve/time/thumbnails.h"
#include "carve/time/time_surface.h"
#include "graph/types/node_type.h"
#include "nodes/params/pace_params.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>

namespace fluidcarve {

namespace {

/// The surface of surface_between(), or a warning that there is none.
std::optional<TimeSurface> surface_in(const Sequence& source,
                                      const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                                      double width, const Context& context) {
    auto out = surface_between(source, pairs, width, [&] { context.check_cancelled(); });
    if (!out && !source.box().empty())
        context.warn(
            "no float grid of one transform shows in all frames where both sides match: all places "
            "go over at once");
    return out;
}

/// Lengths that a loop may have, frames.
struct Lengths {
    int least = 0, most = 0;
};

}  // namespace

/// The lengths are stated as `n` or `[least, most]`.
template <>
struct ParamTraits<Lengths> {
    static Shape shape() {
        return {Shape::Kind::any_of,
                {},
                {ParamTraits<int>::shape(), ParamTraits<std::vector<int>>::shape()}};
    }
    static std::optional<Lengths> parse(const Value& value, ValueReader& reader) {
        if (value.kind == Value::Kind::scalar) {
            const auto one = ParamTraits<int>::parse(value, reader);
            return one ? std::optional(Lengths{*one, *one}) : std::nullopt;
        }
        const auto both = ParamTraits<std::vector<int>>::parse(value, reader);
        if (!both) return std::nullopt;
        if (both->size() != 2)
            return reader.fault(value,
                                fmt::format("must have one number or two, not {}", both->size())),
                   std::nullopt;
        return Lengths{(*both)[0], (*both)[1]};
    }
    static std::string text(const Lengths& lengths) {
        return fmt::format("[{}, {}]", lengths.least, lengths.most);
    }
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
        if (least < 2 || most > most_frames)
            check.fault("frames", fmt::format("'frames' must be from 2 to {}", most_frames));
        if (least > most)
            check.fault("frames", fmt::format("'frames' must rise: [{}, {}]", most, least));
        if (params.fade && *params.fade >= least)
            check.fault("fade", fmt::format("a fade of {} frames leaves none of the {} frames of "
                                            "the loop as it is; lower it",
                                            *params.fade, least));
    }

    static std::vector<int> retimes(const Params& params, const std::vector<int>& frames) {
        const auto place = Place(params, frames);
        std::vector<int> out;
        for (int n = 0; n < params.lengths.most * params.loops; ++n)
            out.push_back(place.first + place.step * n);
        return out;
    }

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(*io.source, io.velocity, context.frame(), context.limits());
        thumbnails_.add(*io.source, io.velocity);
    }

    void finish(const Params& params, Ports&, Context& context) {
        place_ = Place(params, source_.numbers());
        const auto [least, most] = params.lengths;
        loop_ = best(params, static_cast<std::size_t>(least), static_cast<std::size_t>(most));
        const int from = source_.numbers()[loop_.first],
                  to = source_.numbers()[loop_.first + loop_.length - 1];
        context.report("loop", {{"first", from},
                                {"last", to},
                                {"frames", loop_.length},
                                {"fade", loop_.fade},
                                {"difference", loop_.difference}});
        if (loop_.difference > much) context.warn(unlike(params));
        else if (loop_.first < loop_.fade)
            context.warn(fmt::format(
                "the loop's last {} frames fade into what comes before it, but there "
                "{} {} of the source: its first frame is held instead, so that what "
                "moves stops there; lower `frames` or `fade`, or give a longer sequence",
                loop_.fade, loop_.first == 1 ? "is" : "are",
                loop_.first == 0   ? std::string("no frames")
                : loop_.first == 1 ? "1 frame"
                                   : fmt::format("{} frames", loop_.first)));
        find_surface(context);
    }

    void run(const Params&, Ports& io, Context& context) const {
        const auto length = loop_.length,
                   n = static_cast<std::size_t>((context.frame() - place_.first) / place_.step) %
                       length,
                   at = loop_.first + n;
        if (n + loop_.fade < length) {
            io.volume = std::make_shared<Volume>(source_.at(at).volume);
            return;
        }
        const auto frame = static_cast<int>(n + loop_.fade - length);
        const auto a = source_.at(at).volume, b = source_.at(before(at, length)).volume;
        const auto share = [&](const openvdb::Vec3d& world) {
            return surface_ ? surface_->share(frame, world)
                            : double(frame + 1) / double(loop_.fade + 1);
        };
        io.volume = std::make_shared<Volume>(
            volume_mixed(a, b, share, 2 * frame + 1 < static_cast<int>(loop_.fade) ? a : b));
    }

private:
    static constexpr int most_frames = 100000;
    static constexpr double much = 4;  ///< difference of the ends from which on it is warned of

    /// What is known of a loop before the frames are.
    struct Place {
        int first = 1, step = 1;

        Place() = default;
        /// @throws Failure if the sequence is shorter than the loop, or lacks frames
        Place(const Params& params, const std::vector<int>& frames)
            : first(params.start.value_or(frames.front())), step(step_of(frames)) {
            if (static_cast<std::size_t>(params.lengths.most) > frames.size())
                throw Failure(fmt::format(
                    "a loop of {} frames needs as many of the source, which has {}; lower 'frames'",
                    params.lengths.most, frames.size()));
        }
    };

    /// The frame into which one at the loop's end fades: a loop before it. Before the first frame
    /// of the source, that one is held.
    static std::size_t before(std::size_t at, std::size_t length) {
        return at - std::min(at, length);
    }

    /// A part of the source as a loop.
    struct Closed {
        std::size_t first = 0, length = 1, fade = 0;
        /// Mean of the frames that fade into each other.
        double difference = std::numeric_limits<double>::max();
    };
    /// The loop that closes best, of all lengths in a range.
    Closed best(const Params& params, std::size_t least, std::size_t most) const {
        Closed out;
        for (auto length = least; length <= most; ++length) {
            const auto fade =
                params.fade ? static_cast<std::size_t>(*params.fade) : (length + 3) / 4;
            std::vector<double> off;  // of each frame that may fade
            for (auto at = length - fade; at < source_.size(); ++at)
                off.push_back(thumbnails_.difference(before(at, length), at));
            for (std::size_t first = 0; first + length <= source_.size(); ++first) {
                const auto from = off.begin() + static_cast<std::ptrdiff_t>(first);
                const double mean =
                    std::accumulate(from, from + static_cast<std::ptrdiff_t>(fade), 0.0) /
                    static_cast<double>(fade);
                if (mean < out.difference) out = {first, length, fade, mean};
            }
        }
        return out;
    }

    /// Finds where and when the end goes over into what comes before. Places that differ much take
    /// longer.
    void find_surface(Context& context) {
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        for (auto at = loop_.first + loop_.length - loop_.fade; at < loop_.first + loop_.length;
             ++at)
            pairs.emplace_back(at, before(at, loop_.length));
        constexpr double briefest = 3;
        const auto all = static_cast<double>(loop_.fade);
        surface_ = surface_in(source_, pairs,
                              std::clamp(loop_.difference, std::min(briefest, all), all), context);
    }

    /// What a warning says of ends that differ much, and which length near the one asked for would
    /// close better.
    std::string unlike(const Params& params) const {
        const auto out = fmt::format(
            "the ends of the loop differ {:.2g} times as much as neighbouring frames, so that "
            "their fade will be seen",
            loop_.difference);
        const auto near = loop_.length / 4;
        const auto other = best(params, std::max(loop_.fade + 1, loop_.length - near),
                                std::min(loop_.length + near, source_.size()));
        return other.length == loop_.length
                   ? out + "; a longer sequence leaves more choice"
                   : fmt::format("{}; with `frames: {}` it would be {:.2g}", out, other.length,
                                 other.difference);
    }

    Sequence source_;
    Thumbnails thumbnails_;
    Place place_;
    Closed loop_;
    std::optional<TimeSurface> surface_;  ///< nothing: all places go over alike
};

}  // namespace

NodeType time_loop() {
    using Params = Loop::Params;
    return Declare<Loop>("time.loop",
                         "A loop of a wished length: of all parts of the sequence the one that "
                         "closes best. Its last frames go over into those before its first, each "
                         "place when both match best there.")
        .input("source", &Loop::Ports::source, "The grids, or one grid.")
        .input(
            "velocity", &Loop::Ports::velocity,
            "Velocity, staggered or not. Where ends match is judged by where things move to, too.")
        .required(
            "frames", &Params::lengths,
            "Length of the loop, in frames. [20, 30] takes the length in this range that closes "
            "best, writes 30 frames in any case, in which it goes round, and reports the length.")
        .param("fade", &Params::fade, Unit::frames, between(1, 1e5),
               "Number of its last frames that fade. It is best if the source has so many frames "
               "more than the loop: else its first frame is held. auto is a quarter.")
        .param("loops", &Params::loops, Unit::none, between(1, 1000),
               "How often the loop is written, one behind the other, to look at it.")
        .param("start", &Params::start, Unit::frames, between(-farthest_frame, farthest_frame),
               "Number of the first frame. auto is that of the source.")
        .output("volume", &Loop::Ports::volume,
                "The same grids. Frames before the fade stay bit for bit. Points go over one "
                "by one, by their `id` if they have one. Whole numbers and masks are those of the "
                "nearer side.")
        .names_as("volume", "source")
        .version(5)
        .kept();
}

}  // namespace fluidcarve
