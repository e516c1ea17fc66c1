#include "nodes/time/loop.h"

#include "graph/text/problem.h"
#include "nodes/time/between.h"
#include "nodes/time/sequence.h"
#include "nodes/time/thumbnails.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>

namespace fluidcarve {
namespace {

class Loop {
public:
    struct Params {
        int count = 24;
        Auto<int> fade;
        int loops = 1;
        Auto<int> start;
        Transport transport = Transport::semi_lagrangian;
    };
    struct Ports {
        Ref<Volume> source;
        Optional<VectorGrid> velocity;
        Ref<Volume> volume;
    };

    static void check(const Params& params, NodeCheck& check) {
        if (params.fade && *params.fade >= params.count)
            check.fault("fade", fmt::format("a fade of {} frames leaves none of the {} frames of the loop as it is; lower it", *params.fade, params.count));
    }

    static std::vector<int> retimes(const Params& params, const std::vector<int>& frames) {
        const auto place = Place(params, frames);
        std::vector<int> out;
        for (int n = 0; n < params.count * params.loops; ++n) out.push_back(place.first + place.step * n);
        return out;
    }

    void add(const Params&, const Ports& io, Context& context) {
        source_.add(*io.source, io.velocity, context);
        thumbnails_.add(source_.at(source_.size() - 1));
    }

    void finish(const Params& params, Ports&, Context& context) {
        place_ = Place(params, source_.numbers());
        const auto length = static_cast<std::size_t>(params.count);
        const auto [first, least] = best(length);
        begin_ = first;
        const int from = source_.numbers()[begin_], to = source_.numbers()[begin_ + length - 1];
        context.report("loop", {{"first", from}, {"last", to}, {"fade", place_.fade}, {"difference", least}});
        if (least > much) context.warn(unlike(length, least));
    }

    void run(const Params& params, Ports& io, Context& context) const {
        const auto n = static_cast<std::size_t>((context.frame() - place_.first) / place_.step % params.count);
        const auto length = static_cast<std::size_t>(params.count), at = begin_ + n;
        if (n + place_.fade < length) {
            io.volume = std::make_shared<Volume>(source_.at(at).volume);
            return;
        }
        // The first frame of the fade shows least of what comes before the loop, the last one most.
        const double share = static_cast<double>(n + place_.fade - length + 1) / static_cast<double>(place_.fade + 1);
        const auto a = source_.at(at), b = source_.at(before(at, length));
        auto shown = shown_in(a, b);
        VectorGrid::Ptr motion;
        if (shown) {
            // What moved in a whole loop, no velocity tells.
            shown->first.velocity = shown->second.velocity = nullptr;
            motion = motion_between(shown->first, shown->second, 0, context.memory_budget());
        }
        io.volume = std::make_shared<Volume>(volume_between(a.volume, b.volume, share, motion.get(), params.transport));
    }

private:
    static constexpr double much = 4;  ///< difference of the ends from which on it is warned of

    /// What is known of a loop before the frames are.
    struct Place {
        int first = 1, step = 1;
        std::size_t fade = 0;

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
            const auto length = static_cast<std::size_t>(params.count);
            if (length > frames.size())
                throw Failure(fmt::format("a loop of {} frames needs as many of the source, which has {}; lower 'frames'", length, frames.size()));
            fade = params.fade ? static_cast<std::size_t>(*params.fade) : (length + 3) / 4;
        }
    };

    /// The frame into which one at the loop's end fades: a loop before it. Before the first frame of the source, that one is held.
    static std::size_t before(std::size_t at, std::size_t length) { return at - std::min(at, length); }

    /// A loop's first frame, and the mean difference of the frames that fade into each other.
    struct Closed {
        std::size_t first;
        double difference;
    };
    /// The loop of a length that closes best.
    Closed best(std::size_t length) const {
        Closed out{0, std::numeric_limits<double>::max()};
        for (std::size_t first = 0; first + length <= source_.size(); ++first) {
            double sum = 0;
            for (auto at = first + length - place_.fade; at < first + length; ++at) sum += thumbnails_.difference(before(at, length), at);
            if (const double mean = sum / static_cast<double>(place_.fade); mean < out.difference) out = {first, mean};
        }
        return out;
    }

    /// What a warning says of ends that differ much, and which length near the one asked for would close better.
    std::string unlike(std::size_t length, double least) const {
        const auto out = fmt::format("the ends of the loop differ {:.2g} times as much as neighbouring frames, so that their fade will be seen", least);
        auto better = length;
        for (auto other = std::max(place_.fade + 1, length - length / 4); other <= std::min(length + length / 4, source_.size()); ++other)
            if (const double here = best(other).difference; here < least) {
                least = here;
                better = other;
            }
        return better == length ? out + "; a longer sequence leaves more choice" : fmt::format("{}; with `frames: {}` it would be {:.2g}", out, better, least);
    }

    Sequence source_;
    Thumbnails thumbnails_;
    Place place_;
    std::size_t begin_ = 0;  ///< index of the first frame into which the end fades
};

}  // namespace

NodeType time_loop() {
    using Params = Loop::Params;
    return Declare<Loop>("time.loop",
                         "A loop of a wished length: of all parts of the sequence the one that closes best. Its last frames fade into those before its first, "
                         "moved towards them.")
        .input("source", &Loop::Ports::source, "The grids, or one grid.")
        .input("velocity", &Loop::Ports::velocity, "Velocity, staggered or not. Where ends match is judged by where things move to, too.")
        .required("frames", &Params::count, Unit::frames, between(2, 1e6), "Length of the loop.")
        .param("fade", &Params::fade, Unit::frames, between(1, 1e5),
               "Number of its last frames that fade. It is best if the source has so many frames more than the loop: else its first frame is held. auto is a "
               "quarter.")
        .param("loops", &Params::loops, Unit::none, between(1, 1000), "How often the loop is written, one behind the other, to look at it.")
        .param("start", &Params::start, Unit::frames, any_number(), "Number of the first frame. auto is that of the source.")
        .param("transport", &Params::transport, "How values are moved. mac_cormack is sharper, and takes twice as long.")
        .output("volume", &Loop::Ports::volume,
                "The same grids. Frames before the fade stay bit for bit. Whole numbers, masks and points are those of the nearer side.")
        .names_as("volume", "source")
        .kept();
}

}  // namespace fluidcarve
