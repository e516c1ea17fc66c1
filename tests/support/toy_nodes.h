#pragma once

#include "carve/base/failure.h"
#include "formats/file/output_file.h"
#include "graph/types/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <mutex>
#include <sstream>
#include <thread>

/// Node types without volumes, to test what a pipeline is and how it runs.
namespace toy {

using namespace fluidcarve;

/// A payload that counts how many frames' worth of it are alive.
struct Number {
    double value = 0;
    explicit Number(double value) : value(value) {
        const int now = ++alive;
        int most = most_alive;
        while (now > most && !most_alive.compare_exchange_weak(most, now)) {}
    }
    Number(const Number&) = delete;
    Number& operator=(const Number&) = delete;
    ~Number() { --alive; }

    static inline std::atomic<int> alive{0};
    static inline std::atomic<int> most_alive{0};
};

struct Text {
    std::string value;
};

/// What bodies did, for tests to look at; reset by each test.
struct Log {
    std::mutex mutex;
    std::vector<std::string> lines;
    void add(std::string line) {
        const std::lock_guard lock(mutex);
        lines.push_back(std::move(line));
    }
    std::vector<std::string> sorted() {
        const std::lock_guard lock(mutex);
        auto out = lines;
        std::ranges::sort(out);
        return out;
    }
    void reset() {
        const std::lock_guard lock(mutex);
        lines.clear();
        Number::most_alive = 0;
    }
};
inline Log log;

/// Delivers the frame's number; may fail at one frame, or be late at every third.
struct Count {
    struct Params {
        InputPath path;
        int fail_at = -1;
        bool missing = false;
        bool late = false;
        int skip = -1;
    };
    struct Ports {
        Ref<Number> number;
    };
    static void survey(const Params& params, Survey& survey) {
        if (params.skip >= 0) survey.leave_out(params.skip);
        if (params.missing) survey.missing(params.fail_at, "the file is not there");
    }
    static void run(const Params& params, Ports& io, Context& context) {
        if (context.frame() == params.fail_at)
            throw Failure("made to fail",
                          params.missing ? Failure::Kind::input : Failure::Kind::data);
        if (params.late && context.t() % 3 == 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(3));
        io.number = std::make_shared<Number>(context.frame());
        log.add(fmt::format("count {}", context.frame()));
    }
};

struct Add {
    struct Params {
        double offset = 0;
        int throw_at = -1;
    };
    struct Ports {
        List<Number> numbers;
        Ref<Number> sum;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        if (context.frame() == params.throw_at) throw std::runtime_error("a library threw");
        double sum = params.offset;
        for (const auto& number : io.numbers) sum += number->value;
        io.sum = std::make_shared<Number>(sum);
    }
};

/// Gathers all frames; delivers one number, and tells in which order the frames came.
struct Total {
    struct Params {
        int only_place = -1;
    };
    struct Ports {
        Ref<Number> number;
        Optional<Number> start;
        Ref<Number> total;
    };
    static NodeTraits traits(const Params& params) {
        return {.takes = [&params](const Context& context) {
            return params.only_place < 0 || static_cast<int>(context.t()) == params.only_place;
        }};
    }
    void add(const Params&, const Ports& io, Context& context) {
        sum += io.number->value;
        log.add(fmt::format("total {}", context.frame()));
        order.push_back(context.frame());
    }
    void finish(const Params&, Ports& io, Context& context) {
        if (!std::ranges::is_sorted(order)) throw Failure("frames came out of order");
        io.total = std::make_shared<Number>(sum + (io.start ? io.start->value : 0));
        context.report("totals", {{"frames", order.size()}, {"sum", sum}});
        log.add(fmt::format("finish {}", order.size()));
    }
    double sum = 0;
    std::vector<int> order;
};

/// Gathers the largest number, then delivers each frame's share of it.
struct Share {
    struct Params {
        bool stated = false;
    };
    struct Ports {
        Ref<Number> number;
        Ref<Number> share;
    };
    static NodeTraits traits(const Params& params) { return {.gathers = !params.stated}; }
    void add(const Params&, const Ports& io, Context&) { most = std::max(most, io.number->value); }
    void finish(const Params&, Ports&, Context&) {}
    void run(const Params&, Ports& io, Context&) const {
        io.share = std::make_shared<Number>(io.number->value / most);
    }
    double most = 1;
};

struct Print {
    struct Params {
        OutputPath path;
    };
    struct Ports {
        Ref<Number> number;
        Optional<Number> total;
    };
    static void run(const Params&, Ports& io, Context& context) {
        log.add(fmt::format("print {} = {}{}", context.frame(), io.number->value,
                            io.total ? fmt::format(" of {}", io.total->value) : ""));
    }
};

/// Reads each frame's number from a file.
struct Load {
    struct Params {
        InputPath path;
    };
    struct Ports {
        Ref<Number> number;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        std::ifstream in(params.path.at(context.frame()));
        double value = 0;
        if (!(in >> value)) throw Failure("the file holds no number", Failure::Kind::input);
        io.number = std::make_shared<Number>(value);
        log.add(fmt::format("load {}", context.frame()));
    }
};

/// Worth keeping; warns of large numbers, and reports each.
struct Square {
    struct Params {
        double times = 1;
        int slow_ms = 0;
    };
    struct Ports {
        Ref<Number> number, square;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        if (params.slow_ms > 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(params.slow_ms));
        io.square = std::make_shared<Number>(params.times * io.number->value * io.number->value);
        if (io.square->value > 50) context.warn("a large number");
        context.report("squares", {{std::to_string(context.frame()), io.square->value}});
        log.add(fmt::format("square {}", context.frame()));
    }
};

/// So many of the numbers of all frames, the largest first: takes each frame as a digest, and finds
/// more if it has some.
struct Top {
    struct Params {
        int count = 1;
        double offset = 0;  ///< changes no digest
    };
    struct Ports {
        Ref<Number> number;
        Ref<Text> top;
    };
    static std::shared_ptr<Number> digest(const Params&, const Ports& io, Context& context) {
        log.add(fmt::format("digest {}", context.frame()));
        if (io.number->value < 2) context.warn("a small number");
        return std::make_shared<Number>(io.number->value);
    }
    void add(const Params&, const Ref<Number>& number, Context&) {
        numbers.push_back(number->value);
    }
    void resume(const Payload& result, const nlohmann::ordered_json& entry) {
        found = result.as<Text>()->value;
        known = entry.at("steps").size();
    }
    void finish(const Params& params, Ports& io, Context& context) {
        std::sort(numbers.rbegin(), numbers.rend());
        for (auto n = known; n < static_cast<std::size_t>(params.count); ++n) {
            log.add(fmt::format("step {}", n + 1));
            found += fmt::format("{} ", numbers.at(n) + params.offset);
            io.top = std::make_shared<Text>(Text{found});
            context.report("tops", {{"steps", steps(*io.top)}});
            context.checkpoint(Payload(std::make_shared<Text>(Text{found})));
        }
        if (!io.top) io.top = std::make_shared<Text>(Text{found});
        context.report("tops", {{"steps", steps(*io.top)}});
    }
    static std::vector<std::string> steps(const Text& text) {
        std::istringstream in(text.value);
        return {std::istream_iterator<std::string>(in), {}};
    }
    static Growth growth() {
        return {"count", [](const void*) { return std::string("largest"); },
                [](const Payload& result) {
                    return ItemCount{steps(*result.as<Text>()).size(), 0};
                },
                [](const void* params, std::size_t) {
                    return static_cast<std::size_t>(static_cast<const Params*>(params)->count);
                },
                [](const Payload& result, std::size_t count, nlohmann::ordered_json& entry) {
                    auto all = steps(*result.as<Text>());
                    all.resize(count);
                    entry["steps"] = all;
                    return Payload(
                        std::make_shared<Text>(Text{fmt::format("{} ", fmt::join(all, " "))}));
                }};
    }
    std::vector<double> numbers;
    std::string found;
    std::size_t known = 0;
};

/// Writes a file, which begins with its place in time as writers' files do: no two are the same to
/// the byte.
struct Save {
    struct Params {
        OutputPath path;
    };
    struct Ports {
        Ref<Number> number;
        Optional<Text> text;
    };
    static void run(const Params& params, Ports& io, Context& context) {
        static std::atomic<int> serial{0};
        OutputFile file(params.path.at(context.frame()));
        std::ofstream(file.aside())
            << serial++ << ": " << io.number->value << " " << (io.text ? io.text->value : "");
        file.commit();
        log.add(fmt::format("save {}", context.frame()));
    }
};

inline Registry registry() {
    Registry out;
    const Filed<Number> filed{1, [](const Number& number, std::ostream& to) { to << number.value; },
                              [](std::istream& from) {
                                  double value = 0;
                                  from >> value;
                                  return std::make_shared<Number>(value);
                              }};
    const Filed<Text> filed_text{
        1, [](const Text& text, std::ostream& to) { to << text.value; },
        [](std::istream& from) {
            return std::make_shared<Text>(Text{{std::istreambuf_iterator<char>(from), {}}});
        }};
    out.add(payload_type<Number>(
        "number", "A number.", [](const Number&) { return std::uint64_t{8}; }, filed));
    out.add(payload_type<Text>(
        "text", "A text.", [](const Text& text) { return std::uint64_t{text.value.size()}; },
        filed_text));
    out.add(NodeType(Declare<Load>("toy.load", "Reads numbers.")
                         .required("path", &Load::Params::path, "A file per frame.")
                         .output("number", &Load::Ports::number, "The number.")));
    out.add(NodeType(
        Declare<Square>("toy.square", "Squares numbers.")
            .input("number", &Square::Ports::number, "The number.")
            .param("times", &Square::Params::times, Unit::none, any_number(), "Multiplies it.")
            .param("slow_ms", &Square::Params::slow_ms, Unit::none, at_least(0), "Takes so long.")
            .output("square", &Square::Ports::square, "The square.")
            .kept()));
    out.add(NodeType(
        Declare<Top>("toy.top", "The largest numbers of all frames.")
            .input("number", &Top::Ports::number, "The numbers.")
            .param("count", &Top::Params::count, Unit::none, between(0, 100), "How many.")
            .param("offset", &Top::Params::offset, Unit::none, any_number(), "Added to each.")
            .output("top", &Top::Ports::top, "The largest first.")
            .digests({"number"})
            .grows(Top::growth())
            .kept()));
    out.add(NodeType(Declare<Save>("toy.save", "Writes numbers.")
                         .input("number", &Save::Ports::number, "The number.")
                         .input("text", &Save::Ports::text, "Written behind it.")
                         .required("path", &Save::Params::path, "A file per frame.")));
    out.add(
        NodeType(Declare<Count>("toy.count", "The frame's number.")
                     .required("path", &Count::Params::path, "Looks like input; nothing is opened.")
                     .param("fail_at", &Count::Params::fail_at, Unit::frames, any_number(),
                            "Fails at this frame.")
                     .param("missing", &Count::Params::missing, "The failure is a missing file.")
                     .param("late", &Count::Params::late, "Takes long at every third frame.")
                     .param("skip", &Count::Params::skip, Unit::frames, any_number(),
                            "Leaves this frame out.")
                     .output("number", &Count::Ports::number, "The number.")));
    out.add(NodeType(
        Declare<Add>("toy.add", "Adds numbers.")
            .input("numbers", &Add::Ports::numbers, "What to add.")
            .param("offset", &Add::Params::offset, Unit::none, between(-100, 100), "Added too.")
            .param("throw_at", &Add::Params::throw_at, Unit::frames, any_number(),
                   "Throws at this frame.")
            .output("sum", &Add::Ports::sum, "The sum.")));
    out.add(NodeType(Declare<Total>("toy.total", "Adds a number over all frames.")
                         .input("number", &Total::Ports::number, "What to add.")
                         .input("start", &Total::Ports::start, "Where to start.")
                         .param("only_place", &Total::Params::only_place, Unit::frames,
                                any_number(), "Looks at one place of the sequence only.")
                         .output("total", &Total::Ports::total, "The sum.")));
    out.add(NodeType(
        Declare<Share>("toy.share", "A number as a share of the largest.")
            .input("number", &Share::Ports::number, "The number.")
            .param("stated", &Share::Params::stated, "The largest is 1; nothing is gathered.")
            .output("share", &Share::Ports::share, "The share.")));
    out.add(NodeType(
        Declare<Print>("toy.print", "Writes down a number.")
            .input("number", &Print::Ports::number, "The number.")
            .input("total", &Print::Ports::total, "Shown beside it.")
            .required("path", &Print::Params::path, "Looks like output; nothing is written.")));
    return out;
}

}  // namespace toy
