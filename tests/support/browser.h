#pragma once

#include "tests/support/scratch.h"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <regex>
#include <stdexcept>
#include <string>

namespace fluidcarve::test {

enum class Clock { virtual_, real };

inline bool browser_is_there() { return std::system("command -v chromium >/dev/null 2>&1") == 0; }

/// Opens a page in headless Chromium and runs a script in it.
/// @param script   body of an async function; what it returns is the result. It sees the page's own
///   names
/// @param options  further options of Chromium
/// @param clock    virtual: time runs on while nothing happens, so that what the page waits for is
///   there in the end, and stands still while
///                 the script works; real: for measurements
/// @throws std::runtime_error if the page or the script fails, with what both said
inline nlohmann::json ask_browser(const Scratch& scratch, std::string page,
                                  const std::string& script, const std::string& options = "",
                                  Clock clock = Clock::virtual_) {
    const std::string asked = R"js(<script>
        (async () => {
            const out = document.createElement('pre'), open = document.createElement('iframe');
            out.id = 'out';
            // The page is not loaded, and so not printed, before this frame is.
            open.hidden = true;
            document.body.append(open);
            open.contentDocument.open();
            try {
                out.textContent = JSON.stringify(await (async () => {)js" +
                              script + R"js(})());
            } catch (error) {
                out.textContent = JSON.stringify({failed: String(error) + error.stack});
            }
            document.head.append(out);
            open.contentDocument.close();
        })();
        </script></body>)js";
    page.replace(page.rfind("</body>"), 7, asked);
    const auto file = scratch.write("asked.html", page);
    const auto said = scratch / "said.html";
    const std::string time =
        clock == Clock::real ? " --timeout=120000" : " --virtual-time-budget=20000";
    const auto command =
        "timeout 300 chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader "
        "--enable-unsafe-swiftshader --hide-scrollbars"
        " --no-first-run --disable-extensions --disable-component-update "
        "--disable-background-networking" +
        time + " --user-data-dir=" + (scratch / "profile") + " " + options + " --dump-dom file://" +
        file + " >" + said + " 2>" + (scratch / "errors");
    const int code = std::system(command.c_str());
    const auto text = Scratch::read(said);
    const auto begin = text.find("<pre id=\"out\">"), end = text.find("</pre>", begin);
    if (begin == std::string::npos)
        throw std::runtime_error("chromium ended with " + std::to_string(code) + ": " +
                                 Scratch::read(scratch / "errors"));
    auto json = text.substr(begin + 14, end - begin - 14);
    for (const auto& [name, sign] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}})
        json = std::regex_replace(json, std::regex(name), sign);
    auto out = nlohmann::json::parse(json);
    if (out.is_object() && out.contains("failed")) throw std::runtime_error(json);
    return out;
}

}  // namespace fluidcarve::test
