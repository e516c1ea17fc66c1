#include "tests/bench/lqr.h"

#include "carve/lattice/lattice.h"
#include "carve/remap/grid.h"
#include "carve/solver/costs/sample.h"
#include "carve/solver/dynamic.h"
#include "formats/file/module.h"
#include "formats/image/image_volume.h"
#include "nodes/energy_image.h"
#include "tests/bench/measure.h"
#include "tests/support/program.h"
#include "tests/support/scratch.h"
#include "tests/support/seams_through.h"

#include <lqr.h>

#include <cmath>
#include <stdexcept>

using namespace fluidcarve;

namespace {

constexpr int width = 1920, height = 1080, seams = 384;

/// A photograph of any size, scaled, and to whole numbers of 8 bits again.
Image scaled(const Image& photo, int width, int height) {
    auto out = photo;
    out.data = out.display = {0, 0, width, height};
    out.channels.resize(3);
    out.pixels.clear();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) * photo.data.width / width - 0.5,
                         v = (y + 0.5) * photo.data.height / height - 0.5;
            const auto at = [&](int i, int j, std::size_t c) {
                i = std::clamp(i, 0, photo.data.width - 1);
                j = std::clamp(j, 0, photo.data.height - 1);
                return static_cast<double>(
                    photo.pixels[static_cast<std::size_t>(j * photo.data.width + i) *
                                     photo.channels.size() +
                                 c]);
            };
            const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
            const double a = u - i, b = v - j;
            for (std::size_t c = 0; c < 3; ++c) {
                const double value = (1 - b) * ((1 - a) * at(i, j, c) + a * at(i + 1, j, c)) +
                                     b * ((1 - a) * at(i, j + 1, c) + a * at(i + 1, j + 1, c));
                out.pixels.push_back(static_cast<float>(std::round(255 * value) / 255));
            }
        }
    return out;
}

struct Carved {
    double seconds = 0;
    double remap_seconds = 0;   ///< of the new picture, if it is made apart
    std::vector<bool> removed;  ///< `[y][x]`, y down
};

Carved by_dynamic(const Image& image, const Volume& volume) {
    Carved out;
    FoundSeams found;
    out.seconds = seconds(3, [&] {
        const auto energy = image_energy(volume);
        const auto lattice = make_box(openvdb::Vec3d(0), {width, height, 1}, 1, {0, 1, 2});
        EnergyVolume frames({lattice.shape, Axis::u, 1});
        sample_energy(*energy, lattice, Axis::u, frames.codes(0));
        found = find_seams(frames, {Seams::Kind::remove, {0, width - 1}}, seams, DynamicSeams(),
                           [](double) {});
    });
    const auto lattice = make_box(openvdb::Vec3d(0), {width, height, 1}, 1, {0, 1, 2});
    const auto set = std::make_shared<Seams>(test::no_seams(lattice));
    set->seams = found.seams;
    const CarveMap map(lattice, {set}, 1, std::nullopt);
    out.remap_seconds =
        seconds(3, [&] { carve_volume(volume, lattice, map, Interpolation::linear); });
    out.removed.resize(static_cast<std::size_t>(width) * height);
    for (int y = 0; y < height; ++y) {
        std::vector<int> left;
        for (int x = 0; x < width; ++x) left.push_back(x);
        for (const auto& seam : found.seams) {
            const auto at = left.begin() + seam.at[static_cast<std::size_t>(y)];
            out.removed[static_cast<std::size_t>((image.data.height - 1 - y) * width + *at)] = true;
            left.erase(at);
        }
    }
    return out;
}

/// A picture of 8 bits and three channels, carved by liblqr. The caller destroys it.
LqrCarver* carver_of(const Image& image, int narrow) {
    auto* const bytes = static_cast<guchar*>(g_malloc(image.pixels.size()));
    std::ranges::transform(image.pixels, bytes, [](float value) {
        return static_cast<guchar>(std::lround(255 * value));
    });
    auto* const carver = lqr_carver_new(bytes, image.data.width, image.data.height, 3);
    if (!carver || lqr_carver_init(carver, 1, 0) != LQR_OK ||
        lqr_carver_set_energy_function_builtin(carver, LQR_EF_LUMA_GRAD_SUMABS) != LQR_OK ||
        lqr_carver_resize(carver, narrow, image.data.height) != LQR_OK)
        throw std::runtime_error("liblqr has failed");
    return carver;
}

Carved by_lqr(const Image& image) {
    Carved out;
    LqrCarver* carver = nullptr;
    out.seconds = seconds(3, [&] {
        if (carver) lqr_carver_destroy(carver);
        carver = carver_of(image, width - seams);
    });
    auto* const map = lqr_vmap_dump(carver);
    if (lqr_vmap_get_width(map) != width || lqr_vmap_get_height(map) != height)
        throw std::runtime_error("liblqr's map is of another size");
    const auto* const order = lqr_vmap_get_data(map);
    for (int n = 0; n < width * height; ++n) out.removed.push_back(order[n] != 0);
    lqr_vmap_destroy(map);
    lqr_carver_destroy(carver);
    return out;
}

/// From a file to a narrower one, 1411 x 1411 to four fifths: how long liblqr takes, and the
/// program with the same energy.
void bench_whole_run(const ImageModule& images, const std::string& path) {
    constexpr int side = 1411, narrow = 1129;
    const Scratch scratch;
    auto photo = scaled(images.read(path, format_of_file(path).name), side, side);
    photo.format = "png";
    images.write(scratch / "photo.png", photo, 100);
    const auto theirs = seconds(3, [&] {
        auto image = images.read(scratch / "photo.png", "png");
        const std::unique_ptr<LqrCarver, decltype(&lqr_carver_destroy)> carver(
            carver_of(image, narrow), &lqr_carver_destroy);
        image.data = image.display = {0, 0, narrow, side};
        image.pixels.clear();
        int x = 0, y = 0;
        guchar* pixel = nullptr;
        while (lqr_carver_scan(carver.get(), &x, &y, &pixel))
            for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(pixel[c]) / 255);
        images.write(scratch / "theirs.png", image, 100);
    });
    scratch.write(
        "narrow.yaml",
        fmt::format("fluidcarve: 1\n"
                    "nodes:\n"
                    "  photo:  {{type: image.read, path: {0}/photo.png}}\n"
                    "  edges:  {{type: energy.image, source: photo}}\n"
                    "  box:    {{type: lattice.box, fit: edges.energy}}\n"
                    "  seams:  {{type: seam.dynamic, energy: edges.energy, lattice: box, axis: u, "
                    "count: -20%}}\n"
                    "  carved: {{type: remap.grids, source: photo, lattice: box, seams: seams}}\n"
                    "  out:    {{type: image.write, source: carved, path: {0}/ours.png}}\n",
                    scratch.path()));
    const auto ours = seconds(3, [&] {
        const auto run = fluidcarve_program("run " + (scratch / "narrow.yaml") +
                                            " --no-cache -q --progress none");
        if (run.code != 0) throw std::runtime_error(run.err);
    });
    line(fmt::format("{0}x{0} PNG to {1}, whole run: liblqr / fluidcarve", side, narrow),
         theirs / ours, fmt::format("{:.2f} s, {:.2f} s", theirs, ours));
}

/// Eq. 6 in the untouched picture, over all that was removed: what carrying it along from seam to
/// seam sums up to.
double energy_of(const Carved& carved, const FloatGrid& energy) {
    double out = 0;
    for (int y = 0; y < height; ++y) {
        int count = 0;
        for (int x = 0; x < width; ++x) {
            if (!carved.removed[static_cast<std::size_t>(y * width + x)]) continue;
            out += energy.tree().getValue({x, height - 1 - y, 0});
            ++count;
        }
        if (count != seams)
            throw std::runtime_error(fmt::format("row {} lost {} pixels", y, count));
    }
    return out;
}

}  // namespace

void bench_lqr() {
    const std::string folder = SOURCE_ROOT "/tests/data/images/";
    const auto& images = load_module<ImageModule>("images");
    bench_whole_run(images, folder + "rocket.jpg");
    for (const auto* name : {"rocket.jpg", "chelsea.png"}) {
        const auto path = folder + name;
        const auto image = scaled(images.read(path, format_of_file(path).name), width, height);
        const auto volume = volume_of(image);
        const auto energy = image_energy(volume);
        const auto what = fmt::format("{} at {}x{}, {} seams: ", name, width, height, seams);
        const auto theirs = by_lqr(image);
        Carved one, two;
        with_threads(1, [&] { return one = by_dynamic(image, volume), 0.0; });
        with_threads(2, [&] { return two = by_dynamic(image, volume), 0.0; });
        line(what + "liblqr / seam.dynamic, 1 thread", theirs.seconds / one.seconds,
             fmt::format("{:.2f} s, {:.2f} s", theirs.seconds, one.seconds));
        line(what + "the same, 2 threads", theirs.seconds / two.seconds,
             fmt::format("{:.2f} s", two.seconds));
        line(what + "liblqr / seam.dynamic and remap, 2 threads",
             theirs.seconds / (two.seconds + two.remap_seconds),
             fmt::format("remap {:.2f} s", two.remap_seconds));
        const double sums[] = {energy_of(theirs, *energy), energy_of(two, *energy)};
        line(what + "energy removed: liblqr's / seam.dynamic's", sums[0] / sums[1],
             fmt::format("{:.1f}, {:.1f}", sums[0], sums[1]));
    }
}
