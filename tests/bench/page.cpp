#include "tests/bench/page.h"

#include "tests/bench/measure.h"
#include "tests/support/browser.h"
#include "tests/support/page_frames.h"

#include <fmt/format.h>

using namespace fluidcarve::test;

void bench_page() {
    if (!browser_is_there()) {
        fmt::print("page: chromium is not installed\n");
        return;
    }
    const Scratch scratch;
    const auto times = ask_browser(scratch, page_of(frame_of(96, 12)), R"js(
        await showFrame();
        const times = {};
        for (const shown of ['volume', 'z']) {
            document.querySelector(`input[name=kind][value=${shown}]`).checked = true;
            showKind();
            times[shown] = 1e9;
            for (let n = 0; n < 24; ++n) {
                byId('count').value = 1 + n % 12;
                takeCount();
                draw();
                times[shown] = Math.min(times[shown], scriptTime);
            }
        }
        return times;)js",
                                   "", Clock::real);
    for (const auto& [name, shown] : {std::pair("volume", "volume"), {"slice", "z"}}) {
        const double ms = times[shown].get<double>();
        line(fmt::format("page, 96 voxels, slider to {}: script / 50 ms", name), ms / 50, fmt::format("{:.1f} ms", ms));
    }
}
