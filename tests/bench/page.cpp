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
        const [view] = views, times = {};
        for (const shown of ['volume', 'z']) {
            document.querySelector(`input[name=kind][value=${shown}]`).checked = true;
            showKind();
            for (const visit of ['first', 'again']) {
                // Of the slowest count, the quickest of a few visits: the others were held up by
                // something else.
                let slowest = 0;
                for (let count = 1; count <= 12; ++count) {
                    let quickest = Infinity;
                    for (let n = 0; n < 5; ++n) {
                        if (visit === 'first') view.known.clear();
                        view.forget();
                        byId('count').value = count;
                        takeCount();
                        draw();
                        quickest = Math.min(quickest, scriptTime);
                    }
                    slowest = Math.max(slowest, quickest);
                }
                times[`${shown} ${visit}`] = slowest;
            }
        }
        return times;)js",
                                   "", Clock::real);
    for (const auto& [name, shown] : {std::pair("volume", "volume first"),
                                      {"slice", "z first"},
                                      {"volume, again", "volume again"},
                                      {"slice, again", "z again"}}) {
        const double ms = times[shown].get<double>();
        line(fmt::format("page, 96 voxels, slider to {}: script / 50 ms", name), ms / 50,
             fmt::format("{:.1f} ms", ms), Better::lower);
    }
}
