#include "nodes/time/carve.h"

#include "graph/text/problem.h"
#include "nodes/time/between.h"
#include "nodes/time/time_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace fluidcarve {
namespace {

class TimeCarve {
public:
    struct Params {
        Count count;
        Auto<int> start;
    };
    struct Ports {
        Ref<Volume> source;
        Ref<Volume> volume;
    };

    static std::vector<int> retimes(const Params& params, const std::vector<int>& frames) {
        const int before = static_cast<int>(frames.size()), by = params.count.of(before);
        if (std::abs(by) > before - 2)
            throw Failure(fmt::format("count {} is too much: of {} frames at most {} can leave or be doubled", ParamTraits<Count>::text(params.count), before,
                                      std::max(before - 2, 0)));
        const int first = params.start.value_or(frames.front()), step = step_of(frames);
        std::vector<int> out;
        for (int n = 0; n < before + by; ++n) out.push_back(first + step * n);
        return out;
    }

    void add(const Params&, const Ports& io, Context& context) { source_.add(*io.source, nullptr, context); }

    void finish(const Params& params, Ports&, Context& context) {
        by_ = params.count.of(static_cast<int>(source_.size()));
        frames_ = retimes(params, source_.numbers());
        // Of the moments where both sides exist, the first and the last show one side alone.
        const auto far = static_cast<std::size_t>(std::abs(by_)), moments = source_.size() - far;
        if (by_ == 0 || moments < 3) return;
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        for (std::size_t n = 1; n + 1 < moments; ++n) pairs.emplace_back(by_ < 0 ? std::pair(n, n + far) : std::pair(n + far, n));
        // A little less than two frames: if a place goes over in a frame, those beside it keep their bits.
        constexpr double brief = 1.8;
        surface_ = surface_between(source_, pairs, std::min(brief, static_cast<double>(pairs.size())), context);
    }

    void run(const Params&, Ports& io, Context& context) const {
        const int n = static_cast<int>(std::ranges::lower_bound(frames_, context.frame()) - frames_.begin()), size = static_cast<int>(source_.size());
        // Of what is before the surface, and of what is behind it.
        const int first = n, last = n - by_;
        if (by_ == 0 || last < 0 || first >= size) {
            io.volume = std::make_shared<Volume>(source_.at(static_cast<std::size_t>(first >= size ? last : first)).volume);
            return;
        }
        const int moment = by_ < 0 ? n : n - by_, middle = (size - std::abs(by_)) / 2;
        const auto a = source_.at(static_cast<std::size_t>(first)).volume, b = source_.at(static_cast<std::size_t>(last)).volume;
        const auto share = [&](const openvdb::Vec3d& world) { return surface_ ? surface_->share(moment - 1, world) : moment < middle ? 0.0 : 1.0; };
        io.volume = std::make_shared<Volume>(volume_mixed(a, b, share, moment < middle ? a : b));
    }

private:
    Sequence source_;
    std::vector<int> frames_;
    int by_ = 0;
    std::optional<TimeSurface> surface_;  ///< nothing: all places go over in the middle
};

}  // namespace

NodeType time_carve() {
    return Declare<TimeCarve>(
               "time.carve",
               "The same sequence, some frames shorter or longer, at its own pace: a slab of frames leaves, or is shown twice, each place of it at the moment "
               "when both sides match best there. What follows this node has the new frames.")
        .input("source", &TimeCarve::Ports::source, "The grids, or one grid.")
        .required("count", &TimeCarve::Params::count, Unit::frames, any_number(),
                  "Frames: negative removes, positive inserts. N% is a share of those of the source. What moves far in so many frames is seen to jump: take "
                  "less, or several of these nodes one behind the other.")
        .param("start", &TimeCarve::Params::start, Unit::frames, any_number(), "Number of the first frame. auto is that of the source.")
        .output("volume", &TimeCarve::Ports::volume,
                "The same grids. All but the places that just change are bit for bit those of a frame of the source. Whole numbers, masks and points change at "
                "one moment.")
        .names_as("volume", "source")
        .kept();
}

}  // namespace fluidcarve
