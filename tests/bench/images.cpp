#include "tests/bench/images.h"

#include "carve/solver/costs/code.h"
#include "carve/solver/dynamic.h"
#include "carve/solver/greedy.h"
#include "carve/solver/pyramid.h"
#include "carve/solver/search/strip.h"
#include "tests/bench/plot.h"

#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>

using namespace fluidcarve;

namespace {

/// Intensities, 0 to 1, row after row.
struct Picture {
    std::size_t width, height;
    std::vector<float> pixels;

    /// Eq. 6: the sum of the absolute derivatives, each by the pixel behind, of the last by the one
    /// before.
    float energy(std::size_t x, std::size_t y) const {
        const auto* const at = pixels.data() + x + width * y;
        return std::abs((x + 1 < width ? at[1] : *(at - 1)) - *at) +
               std::abs((y + 1 < height ? at[width] : *(at - width)) - *at);
    }
    double mean_energy() const {
        double sum = 0;
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) sum += energy(x, y);
        return sum / static_cast<double>(width * height);
    }
    void remove(std::span<const std::uint16_t> seam) {
        std::vector<float> left;
        left.reserve(pixels.size());
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x)
                if (x != seam[y]) left.push_back(pixels[x + width * y]);
        pixels = std::move(left);
        --width;
    }
};

/// @throws std::runtime_error if it is no PNG
Picture read_png(const std::string& path) {
    auto* const file = cairo_image_surface_create_from_png(path.c_str());
    if (const auto status = cairo_surface_status(file); status != CAIRO_STATUS_SUCCESS)
        throw std::runtime_error(path + ": " + cairo_status_to_string(status));
    // Whatever the file has, as eight bits of each colour.
    const int width = cairo_image_surface_get_width(file),
              height = cairo_image_surface_get_height(file);
    auto* const surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height);
    auto* const cairo = cairo_create(surface);
    cairo_set_source_surface(cairo, file, 0, 0);
    cairo_paint(cairo);
    cairo_surface_flush(surface);
    Picture out{static_cast<std::size_t>(width), static_cast<std::size_t>(height), {}};
    const auto* const bytes = cairo_image_surface_get_data(surface);
    for (int y = 0; y < height; ++y) {
        const auto* const row = reinterpret_cast<const std::uint32_t*>(
            bytes + y * cairo_image_surface_get_stride(surface));
        for (int x = 0; x < width; ++x) {
            const auto channel = [&](int shift) {
                return static_cast<float>(row[x] >> shift & 255) / 255;
            };
            out.pixels.push_back(0.299f * channel(16) + 0.587f * channel(8) + 0.114f * channel(0));
        }
    }
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
    cairo_surface_destroy(file);
    return out;
}

/// What seams pay for: the energy of their pixels, or, forward, only the new edges.
EnergyVolume costs_of(const Picture& picture, bool forward) {
    EnergyVolume out(
        {{static_cast<int>(picture.width), static_cast<int>(picture.height), 1}, Axis::u, 1});
    if (forward) {
        out.set_step_prices({.edge = 1});
        std::vector<std::uint16_t> codes(picture.pixels.size());
        std::ranges::transform(picture.pixels, codes.begin(), encode_field);
        out.set_field(0, codes);
        out.count_edges({});
        return out;
    }
    for (std::size_t y = 0; y < picture.height; ++y)
        for (std::size_t x = 0; x < picture.width; ++x)
            out.codes(0)[x + picture.width * y] = encode_energy(picture.energy(x, y));
    return out;
}

/// A seam that looks at nothing.
FindSeam random_walk() {
    return [random = std::mt19937(1)](const EnergyVolume& energy, Window window, int,
                                      const Tick&) mutable {
        std::vector<std::uint16_t> at;
        int entry =
            window.first + static_cast<int>(random() % static_cast<unsigned>(window.size()));
        for (std::size_t c = 0; c < energy.columns_per_frame(); ++c) {
            at.push_back(static_cast<std::uint16_t>(entry));
            entry =
                std::clamp(entry + static_cast<int>(random() % 3) - 1, window.first, window.last);
        }
        const auto paid = energy_of(energy, at);
        return Seams::Seam{std::move(at), paid};
    };
}

FindSeam greedy(int starts) {
    return [=](const EnergyVolume& energy, Window window, int number, const Tick& tick) {
        return greedy_seam(energy, window, number, starts, tick);
    };
}

struct Solver {
    std::string name;
    std::function<FindSeam()> make;
    std::vector<double> seams, images;  ///< what a seam pays per pixel, and mean energy of a pixel
                                        ///< of what is left; by the number of seams
    double seconds = 0;
};

std::vector<Solver> solvers(std::size_t seams) {
    const std::vector<double> none(seams, 0.0);
    return {{"random", random_walk, none, none},
            {"greedy, 1 start", [] { return greedy(1); }, none, none},
            {"greedy, 16 starts", [] { return greedy(16); }, none, none},
            {"dynamic", [] { return FindSeam(DynamicSeams()); }, none, none},
            {"pyramid", [] { return FindSeam(Pyramid(Quality::normal, 16)); }, none, none}};
}

}  // namespace

void compare_on_images(const std::string& folder, const std::string& out, int seams) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".png") files.push_back(entry.path().string());
    if (files.empty()) throw std::runtime_error(folder + " holds no PNG files");
    std::ranges::sort(files);
    std::vector<Picture> pictures;
    for (const auto& file : files) {
        pictures.push_back(read_png(file));
        seams = std::min(seams, static_cast<int>(pictures.back().width) / 2);
    }

    const auto share = 1 / static_cast<double>(pictures.size());
    double untouched = 0;
    for (const auto& picture : pictures) untouched += share * picture.mean_energy();
    fmt::print(
        "{} images, {} seams each; energy: sum of absolute derivatives (eq. 6), mean over pixels; "
        "untouched {:.5f}\n",
        pictures.size(), seams, untouched);

    std::ofstream csv(out + ".csv");
    csv << "cost,solver,seams,cost_of_seam,energy_of_image\n";
    std::vector<Panel> panels;
    for (const auto& [cost, forward] : {std::pair("backward", false), std::pair("forward", true)}) {
        auto of_cost = solvers(static_cast<std::size_t>(seams));
        for (const auto& picture : pictures)
            for (auto& solver : of_cost) {
                auto costs = costs_of(picture, forward);
                const auto found = find_seams(costs, {Seams::Kind::remove, {0, costs.width() - 1}},
                                              seams, solver.make(), [](double) {});
                auto left = picture;
                for (std::size_t n = 0; n < found.seams.size(); ++n) {
                    left.remove(found.seams[n].at);
                    solver.seams[n] +=
                        share * found.seams[n].energy / static_cast<double>(picture.height);
                    solver.images[n] += share * left.mean_energy();
                }
                solver.seconds +=
                    share * std::accumulate(found.wall_s.begin(), found.wall_s.end(), 0.0) / seams;
            }
        fmt::print("\n{:<20} {:>14} {:>16} {:>14}\n", cost, "paid", "left in image", "ms per seam");
        panels.push_back(
            {fmt::format("{}: what seams pay, mean over their pixels", cost), "removed seams", {}});
        panels.push_back(
            {fmt::format("{}: mean energy of the image's pixels", cost), "removed seams", {}});
        for (const auto& solver : of_cost) {
            fmt::print("{:<20} {:>14.5f} {:>16.5f} {:>14.2f}\n", solver.name,
                       std::accumulate(solver.seams.begin(), solver.seams.end(), 0.0) / seams,
                       solver.images.back(), 1e3 * solver.seconds);
            for (std::size_t n = 0; n < solver.seams.size(); ++n)
                csv << fmt::format("{},\"{}\",{},{:.6f},{:.6f}\n", cost, solver.name, n + 1,
                                   solver.seams[n], solver.images[n]);
            panels[panels.size() - 2].curves.push_back({solver.name, solver.seams});
            panels.back().curves.push_back({solver.name, solver.images});
        }
    }
    if (!csv) throw std::runtime_error(out + ".csv can't be written");
    Plot(std::move(panels)).write(out + ".png");
    fmt::print("\nwritten: {0}.csv, {0}.png\n", out);
}
