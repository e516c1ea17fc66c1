#pragma once

namespace fluidcarve {

/// The style sheet of the report page.
constexpr const char* html_style = R"css(
:root {
  color-scheme: light dark;
  --page: #ffffff; --text: #1b1f24; --muted: #5c6670; --rule: #dfe3e8; --soft: #f4f6f8;
  --accent: #b9480a; --band: rgba(185, 72, 10, .14); --bad: #b3261e;
  --heat0: #fff5ec; --heat1: #ffe4cd; --heat2: #ffc99d; --heat3: #ffab6e; --heat4: #f78d45;
      --kept: #e6eaef; --on-heat: #1b1f24;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #14171a; --text: #e6e9ec; --muted: #9aa4ae; --rule: #2c3238; --soft: #1c2024;
    --accent: #ff9a57; --band: rgba(255, 154, 87, .18); --bad: #ff8a80;
    --heat0: #241f1b; --heat1: #3d2b1e; --heat2: #5f3d22; --heat3: #864f22; --heat4: #ad5f1f;
        --kept: #262c32; --on-heat: #f6f3f0;
  }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 1160px; padding: 40px 32px 64px; background: var(--page);
    color: var(--text);
  font: 15px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif;
      overflow-wrap: anywhere; }
h1 { font-size: 28px; line-height: 1.25; font-weight: 650; margin: 0; letter-spacing: -.01em; }
h2 { font-size: 19px; font-weight: 650; margin: 48px 0 12px; padding-top: 14px;
    border-top: 1px solid var(--rule); }
h3 { font-size: 15px; font-weight: 650; margin: 24px 0 6px; }
p { margin: 0 0 12px; max-width: 72ch; }
a { color: inherit; text-decoration-color: var(--rule); text-underline-offset: 3px; }
small, .muted { color: var(--muted); font-weight: 400; font-size: 13px; }
code { font: 13px/1.5 ui-monospace, "SF Mono", Menlo, Consolas, "DejaVu Sans Mono", monospace; }
.eyebrow { color: var(--muted); font-size: 13px; margin-bottom: 4px; }
.outcome { font-size: 17px; margin: 8px 0 0; color: var(--accent); font-weight: 600; }
.outcome.bad, .bad { color: var(--bad); }
.facts { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr));
    gap: 14px 24px; margin: 24px 0 0; }
.facts dt { color: var(--muted); font-size: 13px; }
.facts dd { margin: 0; font-size: 17px; font-variant-numeric: tabular-nums; }
.scroll { overflow-x: auto; -webkit-overflow-scrolling: touch; }
table { border-collapse: collapse; width: 100%; font-size: 14px;
    font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; vertical-align: top; }
thead th { color: var(--muted); font-weight: 400; font-size: 13px; vertical-align: bottom;
    border-bottom: 1px solid var(--rule); }
th, td { padding: 6px 18px 6px 0; }
td { vertical-align: top; }
tbody tr + tr > * { border-top: 1px solid var(--rule); }
.wide th, .wide td { overflow-wrap: normal; white-space: nowrap; }
.wide .number { text-align: right; }
.wide th:first-child { position: sticky; left: 0; background: var(--page); }
.wide th:first-child small { margin-left: 9px; }
.meter { display: inline-block; vertical-align: middle; width: 130px; height: 8px;
    margin-left: 12px; border-radius: 4px; background: var(--soft); }
.meter i { display: block; height: 100%; min-width: 2px; border-radius: 4px;
    background: var(--accent); }
.messages { list-style: none; margin: 0; padding: 0; }
.messages li { padding: 8px 0 8px 14px; border-left: 3px solid var(--accent); margin-bottom: 8px; }
.messages.failures li { border-color: var(--bad); }
.messages small { display: block; }
figure { margin: 0 0 24px; }
figcaption { color: var(--muted); font-size: 13px; margin-top: 6px; }
.picture { display: block; cursor: zoom-in; }
.picture input { position: absolute; opacity: 0; pointer-events: none; }
.picture img { display: block; max-width: 100%; border-radius: 4px; }
.picture input:focus-visible + .scroll { outline: 2px solid var(--accent); outline-offset: 2px; }
.picture input:checked + .scroll { cursor: zoom-out; }
.picture input:checked + .scroll img { max-width: none; }
svg { font-family: inherit; display: block; }
.graph svg { width: 100%; height: auto; min-width: calc(.75 * var(--width));
    max-width: var(--width); }
.graph .edge { stroke: var(--muted); }
.graph text { fill: var(--on-heat); }
.graph rect { stroke: var(--muted); }
.heat0 rect { fill: var(--heat0); } .heat1 rect { fill: var(--heat1); }
    .heat2 rect { fill: var(--heat2); }
.heat3 rect { fill: var(--heat3); } .heat4 rect { fill: var(--heat4); }
    .kept rect { fill: var(--kept); }
.kept text, .idle text { fill: var(--text); }
.idle rect { fill: var(--page); stroke-dasharray: 4 4; }
.failed rect { stroke: var(--bad); stroke-width: 3; }
.legend { display: flex; flex-wrap: wrap; gap: 6px 18px; list-style: none; margin: 10px 0 0;
    padding: 0; color: var(--muted); font-size: 13px; }
.legend li { display: flex; align-items: center; gap: 7px; }
.legend i { width: 22px; height: 13px; border-radius: 3px; border: 1px solid var(--muted); }
.legend .line { height: 0; border: 0; border-top: 2px solid var(--accent); border-radius: 0; }
.legend .line.bound { border-top-color: var(--muted); }
.legend .heat0 { background: var(--heat0); } .legend .heat1 { background: var(--heat1); }
    .legend .heat2 { background: var(--heat2); }
.legend .heat3 { background: var(--heat3); } .legend .heat4 { background: var(--heat4); }
    .legend .kept { background: var(--kept); }
.legend .idle { border-style: dashed; } .legend .failed { border: 2px solid var(--bad); }
    .legend .gathers { border-width: 2.5px; }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 400px), 1fr));
    gap: 20px 40px; margin-top: 16px; }
.plot { width: 100%; max-width: 480px; height: auto; fill: var(--muted); }
.plot .grid { stroke: var(--rule); }
.plot .band { fill: var(--band); }
.plot path.energy, .plot path.gap { stroke: var(--accent); stroke-width: 2; }
.plot path.bound { stroke: var(--muted); stroke-width: 1.5; }
.plot circle.energy, .plot circle.gap { fill: var(--accent); }
.plot circle.bound { fill: var(--page); stroke: var(--muted); stroke-width: 1.5; }
details { margin: 4px 0 12px; }
summary { color: var(--muted); font-size: 13px; cursor: pointer; }
.values th { width: 17%; font-weight: 400; }
.values td { width: 53%; }
.values td.from { width: 30%; color: var(--muted); font-size: 13px; }
.values th, .values td { padding-top: 3px; padding-bottom: 3px; }
@media (max-width: 640px) {
  body { padding: 24px 16px 48px; font-size: 15px; }
  h1 { font-size: 22px; }
  h2 { margin-top: 36px; }
  .facts { grid-template-columns: 1fr 1fr; }
  .meter { width: 70px; }
  .graph svg { min-width: var(--width); }
  .wide th:first-child small { display: block; margin: 0; }
  .values tr { display: grid; grid-template-columns: 8em 1fr; }
  .values th, .values td, .values td.from { width: auto; padding-right: 8px; }
  .values td.from { grid-column: 2; border-top: 0; padding-top: 0; }
}
@media print { details > * { display: block; } h2 { break-after: avoid; } figure,
    tr { break-inside: avoid; } }
)css";

}  // namespace fluidcarve
