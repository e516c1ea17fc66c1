#include "tests/bench/large/table.h"

#include "tests/bench/bytes_in.h"
#include "tests/bench/large/scenes.h"
#include "tests/support/program.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/resource.h>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace fs = std::filesystem;

namespace {

/// Frames of the first run of a row, by which the rest is foreseen.
constexpr int tried_frames = 12;

/// What of the free disk a row may take.
constexpr double disk_share = 0.8;

/// What a run took.
struct Cost {
    double wall = 0, processor = 0;  ///< seconds
    double memory = 0;               ///< bytes
    nlohmann::json report;
};

double processor_seconds() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto of = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return of(usage.ru_utime) + of(usage.ru_stime);
}

/// What a row took at one length.
struct Measured {
    int frames = 0;
    std::vector<int> shape;  ///< of the lattice: I, J, K, frames
    double energies = 0,
           remap =
               0;  ///< seconds: of the pass that solvers gather from; of all that follows the seams
    double processor = 0;            ///< seconds of the whole pipeline with the greedy solver
    double greedy = 0, pyramid = 0;  ///< seconds a seam
    double whole = 0;                ///< seconds of the pipeline with the greedy solver
    double memory = 0, disk = 0;     ///< bytes, the most
    int finest = 1;                  ///< 2: seams were found at half size
    double gap = 0;                  ///< of the pyramid's first seam, as a share of its lower bound
};

/// A straight line through points, at another place.
double line_at(const std::vector<std::pair<double, double>>& points, double x) {
    double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
    for (const auto& [a, b] : points) {
        mean_x += a / static_cast<double>(points.size());
        mean_y += b / static_cast<double>(points.size());
    }
    for (const auto& [a, b] : points) {
        xx += (a - mean_x) * (a - mean_x);
        xy += (a - mean_x) * (b - mean_y);
    }
    return mean_y + (xx > 0 ? xy / xx : 0) * (x - mean_x);
}

/// Measures a row, in a folder of its own.
class Row {
public:
    Row(const TableScene& scene, const TableRequest& request)
        : scene_(scene), request_(request), folder_(fs::absolute(request.scratch) / scene.name) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~Row() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    Row(const Row&) = delete;
    Row& operator=(const Row&) = delete;

    /// At one length, or at three if not all frames may be measured.
    std::vector<Measured> lengths() {
        const int wanted =
            request_.frames > 0 ? std::min(request_.frames, scene_.frames) : scene_.frames;
        const int tried = std::min(tried_frames, wanted);
        make(tried);
        auto first = measure(tried);
        const double free = static_cast<double>(fs::space(folder_).available);
        const double a_frame = first.disk / tried + scene_.bytes *
                                                        static_cast<double>(first.shape[0]) *
                                                        first.shape[1] * first.shape[2];
        const int most = std::min(wanted, static_cast<int>(disk_share * free / a_frame));
        if (most <= tried) {
            if (tried == scene_.frames) return {first};
            return {measure(std::max(2, tried / 3)), measure(std::max(2, 2 * tried / 3)), first};
        }
        make(most);
        if (most == scene_.frames) return {measure(most)};
        return {measure(most / 3), measure(2 * most / 3), measure(most)};
    }

    const Made& made() const { return made_; }
    double seconds_a_frame_made() const { return making_ / made_.frames; }

private:
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    void make(int frames) {
        fs::create_directories(folder_ / "in");
        const auto start = std::chrono::steady_clock::now();
        made_ = make_sequence({files_of(scene_, fs::absolute(request_.folder)), scene_.size,
                               scene_.frames, frames, 1, scene_.velocity, path("in/in.####.vdb")},
                              [&](int frame) {
                                  fmt::print(stderr, "\r{}: frame {} of {} ", scene_.name, frame,
                                             frames);
                              });
        fmt::print(stderr, "\n");
        making_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }

    Cost run(int frames, const std::string& more) const {
        const auto call = fmt::format(
            "run {} -q --progress none --memory {} --work '{}' --report '{}' --set 'sim={}' --set "
            "'out={}' --set frames=1-{} {}",
            arguments_for(scene_, made_, fs::absolute(request_.folder), folder_), request_.memory,
            path("work"), path("report.json"), path("in/in.####.vdb"), path("out/out.####.vdb"),
            frames, more);
        const auto start = std::chrono::steady_clock::now();
        const double before = processor_seconds();
        const auto called = fluidcarve_program(call);
        if (called.code != 0)
            throw std::runtime_error(fmt::format("fluidcarve {}\n{}", call, called.err));
        Cost out{std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                 processor_seconds() - before, 0,
                 nlohmann::json::parse(Scratch::read(path("report.json")))};
        out.memory = out.report.at("peak_rss_bytes");
        fmt::print(stderr, "{}, {} frames: {:.1f} s, {:.1f} s of processors, {}\n", scene_.name,
                   frames, out.wall, out.processor, more);
        return out;
    }

    Measured measure(int frames) const {
        fs::remove_all(path("work"));
        fs::remove_all(path("out"));
        const auto energies = run(frames, "--to seams.energy");
        const auto pyramid = run(frames, "--to seams --set seams.type=seam.pyramid");
        const auto greedy = run(frames, "--to seams --set seams.type=seam.greedy");
        const auto rest = run(frames, "--to out --set seams.type=seam.greedy");
        const auto& seams = greedy.report.at("seams").at("seams");
        const auto a_seam = [](const Cost& cost) {
            const auto all =
                cost.report.at("seams").at("seams").at("wall_s").get<std::vector<double>>();
            return std::reduce(all.begin(), all.end()) / static_cast<double>(all.size());
        };
        Measured out{frames,
                     seams.at("shape"),
                     energies.wall,
                     rest.wall,
                     energies.processor + greedy.processor + rest.processor,
                     a_seam(greedy),
                     a_seam(pyramid),
                     energies.wall + greedy.wall + rest.wall,
                     0,
                     0,
                     seams.value("finest", 1),
                     pyramid.report.at("seams").at("seams").at("gap").front().get<double>()};
        for (const auto* const cost : {&energies, &pyramid, &greedy, &rest})
            out.memory = std::max(out.memory, cost->memory);
        out.disk = static_cast<double>(made_.bytes) * frames / made_.frames +
                   bytes_in(path("work")) + bytes_in(path("out"));
        return out;
    }

    const TableScene& scene_;
    const TableRequest& request_;
    fs::path folder_;
    Made made_;
    double making_ = 0;
};

std::string seconds_text(double seconds) {
    return seconds < 10 ? fmt::format("{:.2f}", seconds) : fmt::format("{:.0f}", seconds);
}

constexpr auto about =
    "# Whole pipelines at the paper's sizes: its table 2\n\n"
    "Each sequence is made of a simulation in `{}`, by `quality make`: as many voxels and frames "
    "as the paper's. It is carved by the shipped pipeline of "
    "that name, by as many seams as the paper's; of the river, the water alone. Below, `paper` is "
    "what the paper states.\n\n"
    "- voxels: along x, y and z, with z up, where the paper's y is. Lattice: vertices along u, v "
    "and w; `half` where seams are found at half size, as larger "
    "lattices have it unless told otherwise.\n"
    "- greedy, pyramid: seconds a seam, the mean of all, with the pipeline's own parameters. Gap: "
    "how far the pyramid's first seam is above the lower bound on "
    "the energy of any seam, at most; at half size, of any seam of that size.\n"
    "- energies: seconds to read all frames and compute what the solver takes. Remap: seconds to "
    "read, carve and write all frames, all seams at once. The "
    "paper's is a "
    "remap alone, and one is needed for each seam.\n"
    "- whole: seconds of the pipeline with the greedy solver, and those of all processors "
    "together.\n"
    "- memory: the most that a run held, mapped files included; `--memory {}` was asked for. Disk: "
    "input, output and work folder.\n\n"
    "`seam.pyramid` cuts finer energies up to a million columns, vertices across u times frames. "
    "So its seconds grow faster up to there than beyond.\n\n"
    "{} threads. A row with fewer frames than the paper's has three lengths, and in the last line "
    "what a straight line through them gives for all frames.\n\n"
    "| scene | voxels | lattice | frames | greedy | paper | pyramid | / greedy | gap | energies | "
    "remap | paper | whole | processors | memory GB | disk GB |\n"
    "|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";

std::string line_of(const TableScene& scene, const Measured& at, const std::string& frames) {
    return fmt::format(
        "| {} | {}x{}x{} | {}x{}x{}{} | {} | {} | {} | {} | {:.1f} | {:.1f} % | {} | {} | {} | {} "
        "| {} | {:.1f} | {:.1f} |\n",
        scene.name, scene.size.x(), scene.size.y(), scene.size.z(), at.shape[0], at.shape[1],
        at.shape[2], at.finest == 2 ? " half" : "", frames, seconds_text(at.greedy),
        scene.paper_greedy, seconds_text(at.pyramid), at.pyramid / at.greedy, 100 * at.gap,
        seconds_text(at.energies), seconds_text(at.remap),
        scene.paper_remap > 0 ? fmt::format("{}", scene.paper_remap) : "-", seconds_text(at.whole),
        seconds_text(at.processor), at.memory / 1e9, at.disk / 1e9);
}

/// What lengths foretell of all frames.
Measured foretold(const std::vector<Measured>& lengths, int frames) {
    auto out = lengths.back();
    for (auto figure : {&Measured::energies, &Measured::remap, &Measured::processor,
                        &Measured::greedy, &Measured::pyramid, &Measured::whole, &Measured::disk}) {
        std::vector<std::pair<double, double>> points;
        for (const auto& at : lengths) points.emplace_back(at.frames, at.*figure);
        out.*figure = line_at(points, frames);
    }
    return out;
}

}  // namespace

void measure_table(const TableRequest& request) {
    std::string page =
        fmt::format(about, fs::path(request.folder).lexically_normal().filename().string(),
                    request.memory, std::thread::hardware_concurrency());
    for (const auto& scene : table_scenes()) {
        if (!request.only.empty() &&
            std::ranges::find(request.only, scene.name) == request.only.end())
            continue;
        Row row(scene, request);
        const auto lengths = row.lengths();
        for (const auto& at : lengths) page += line_of(scene, at, fmt::format("{}", at.frames));
        if (lengths.back().frames < scene.frames)
            page += line_of(scene, foretold(lengths, scene.frames),
                            fmt::format("{} by the slope", scene.frames));
        fmt::print("{} made in {:.2f} s a frame\n{}", scene.name, row.seconds_a_frame_made(),
                   line_of(scene, lengths.back(), fmt::format("{}", lengths.back().frames)));
        std::ofstream out(request.out + ".md");
        out << page;
        if (!out.flush()) throw std::runtime_error(request.out + ".md can't be written");
    }
    fmt::print("written: {}.md\n", request.out);
}
