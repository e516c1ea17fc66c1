'use strict';
// The controls, and what they show. State is what the controls say, the counts of the views, the camera, and the place of a slice.

const data = JSON.parse(byId('data').textContent), packed = new Packed(data.packed);
const scenes = data.scenes.map(each => new Scene(each, packed)), whole = wholeOf(scenes);
const views = scenes.map((scene, n) => new View(scene, n, whole));
const home = {yaw: -1.05, pitch: 0.3, zoom: 1, pan: [0, 0]};
let turn = {...home}, volume = null, chosen = views[0], drawing = 0, playing = null;
/** Milliseconds of script that the last picture took. */
let scriptTime = 0;

const number = id => Number(byId(id).value);
const kind = () => document.querySelector('input[name=kind]:checked').value;
const overlays = () => new Set([...document.querySelectorAll('#overlays input:checked')].filter(each => !each.disabled).map(each => each.value));
/** The frames of the page: those of the scene that has most. */
const frames = scenes.reduce((most, scene) => scene.frames.length > most.length ? scene.frames : most, []).map(each => each.number);

function draw() {
    drawing = 0;
    const begin = performance.now(), shown = kind(), style = getComputedStyle(document.documentElement);
    const names = ['ground', 'smoke', 'line', 'rig', 'bad', 'accent', 'page'];
    const colours = Object.fromEntries(names.map(name => [name, style.getPropertyValue('--' + name).trim()]));
    byId('volume').hidden = shown !== 'volume';
    if (shown === 'volume') volume.clear();
    for (const view of views)
        if (view.frame) view.draw(shown, number('at'), turn, overlays(), {wipe: number('wipe') / 100, brightness: number('brightness'), colours});
    scriptTime = performance.now() - begin;
}
/** Draws before the browser next paints, however many controls moved. */
function refresh() { drawing ||= requestAnimationFrame(draw); }

async function showFrame() {
    const wanted = number('frame'), put = await Promise.all(views.map(view => view.show(frames[wanted])));
    if (wanted !== number('frame')) return;
    put.forEach(each => each());
    byId('frameValue').textContent = frames[wanted];
    tellNotes();
    refresh();
}

function tellNotes() {
    const notes = chosen.frame ? chosen.notes() : [];
    if (!volume) notes.push(['', 'This browser has no WebGL2: slices are shown, but no volume.']);
    byId('notes').replaceChildren(...notes.map(([style, text]) => Object.assign(document.createElement('li'), {className: style, textContent: text})));
}

/** Takes the count of the slider, for the view chosen or for all. */
function takeCount() {
    for (const view of byId('together').checked ? views : [chosen]) view.count = Math.min(number('count'), view.scene.most);
    tellCount();
    tellNotes();
    refresh();
}

function tellCount() {
    const {scene, count} = chosen;
    byId('setting').value = chosen.setting();
    if (scene.most === 0) return;
    const text = scene.signed(count), {energies} = scene.sets[scene.sets.length - 1];
    byId('countValue').textContent = text;
    byId('count').setAttribute('aria-valuetext', `${text} seams`);
    const line = byId('energies').querySelector('.chosen'), x = count === 0 ? -10 : 300 * (count - 0.5) / energies.length;
    line.setAttribute('x1', x);
    line.setAttribute('x2', x);
}

/** The energy of each seam, the knee, and a line at what is chosen. */
function drawEnergies() {
    const {scene} = chosen, {energies} = scene.sets[scene.sets.length - 1], highest = Math.max(...energies) || 1, knee = scene.knee();
    const x = n => (300 * (n - 0.5) / energies.length).toFixed(2), y = energy => (86 - 80 * energy / highest).toFixed(2);
    const path = energies.map((energy, n) => `${n === 0 ? 'M' : 'L'}${x(n + 1)} ${y(energy)}`).join('');
    byId('energies').innerHTML = `<path class="curve" d="${path}"/>` +
        (knee > 0 ? `<line class="knee" x1="${x(knee)}" x2="${x(knee)}" y1="0" y2="90"/>` : '') + '<line class="chosen" y1="0" y2="90"/>';
    byId('energies').setAttribute('aria-label',
        `Energy of ${energies.length} seams, from ${energies[0].toPrecision(3)} to ${energies[energies.length - 1].toPrecision(3)}`);
    byId('knee').textContent = knee > 0 ? `Energy of each seam. From ${scene.signed(knee)} on (dashed) more seams hurt more.` : 'Energy of each seam.';
}

/** Gives the controls of seams to a view. */
function choose(view) {
    chosen = view;
    view.choice.checked = true;
    views.forEach(each => each.part.classList.toggle('chosen', each === view));
    const {scene} = view;
    byId('facts').textContent = `${scene.grid}, ${scene.size.join(' x ')} voxels, ` + (scene.frames.length === 1 ? '1 frame' : `${scene.frames.length} frames`);
    document.querySelectorAll('.seams').forEach(each => each.toggleAttribute('hidden', scene.most === 0));
    if (scene.most > 0) {
        byId('count').max = scene.most;
        byId('count').value = view.count;
        drawEnergies();
    }
    tellCount();
    tellNotes();
}

function showKind() {
    const shown = kind(), flat = shown !== 'volume';
    document.querySelectorAll('.slices').forEach(each => each.hidden = !flat);
    byId('stage').classList.toggle('lit', !flat);
    if (flat) {
        const last = whole.slices[axisNumber[shown]] - 1;
        byId('at').max = last;
        byId('at').value = Math.floor(last / 2);
        tellSlice();
    }
    views.forEach(view => view.forget());
    refresh();
}
function tellSlice() { byId('atValue').textContent = whole.low[axisNumber[kind()]] + whole.step * number('at'); }

function zoomBy(factor) {
    turn.zoom = clamp(turn.zoom * factor, 0.25, 16);
    refresh();
}
/** Turns the volume, or moves the slice. @param x, y  shares of a view's width and height */
function moveBy(x, y) {
    if (kind() === 'volume') turn = {...turn, yaw: turn.yaw - 4 * x, pitch: clamp(turn.pitch + 4 * y, -1.55, 1.55)};
    else turn = {...turn, pan: [turn.pan[0] + x, turn.pan[1] + y]};
    refresh();
}
function step(id, by) {
    const input = byId(id);
    input.value = number(id) + by;
    input.dispatchEvent(new Event('input', {bubbles: true}));
}

/** Milliseconds that a frame stays: 24 frames are a second, those between the frames of the page too. */
function pause() {
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) return 1000;
    const at = number('frame'), next = frames[at + 1] ?? 2 * frames[at] - frames[at - 1];
    return (next - frames[at]) * 1000 / 24;
}
async function play(on) {
    const run = playing = on ? {} : null;
    byId('play').textContent = on ? 'Stop' : 'Play';
    byId('play').setAttribute('aria-pressed', on);
    for (let shown = performance.now(); run;) {
        const left = Math.max(pause() - (performance.now() - shown), 0);
        await new Promise(done => setTimeout(done, left));
        if (playing !== run) return;
        shown = performance.now();
        byId('frame').value = (number('frame') + 1) % frames.length;
        await showFrame();
    }
}

function resize() {
    const all = byId('stage').getBoundingClientRect(), ratio = window.devicePixelRatio || 1, canvas = byId('volume');
    // A volume of more pixels is slow to draw, and shows no more.
    const scale = Math.min(ratio, Math.sqrt(3e5 * Math.min(views.length, 4) / (all.width * all.height)));
    canvas.width = Math.max(1, Math.round(all.width * scale));
    canvas.height = Math.max(1, Math.round(all.height * scale));
    for (const view of views) {
        const area = view.area.getBoundingClientRect(), {canvas: own} = view.picture;
        own.width = Math.max(1, Math.round(area.width * ratio));
        own.height = Math.max(1, Math.round(area.height * ratio));
        const [left, low, right, high] = [area.left - all.left, all.bottom - area.bottom, area.right - all.left, all.bottom - area.top].map(
            x => Math.round(x * scale));
        view.pixels = [left, low, Math.max(1, right - left), Math.max(1, high - low)];
    }
    refresh();
}

function listenTo(view) {
    const {area} = view, keys = {
        ArrowLeft: () => moveBy(-0.03, 0), ArrowRight: () => moveBy(0.03, 0), ArrowUp: () => moveBy(0, -0.03), ArrowDown: () => moveBy(0, 0.03),
        '+': () => zoomBy(1.15), '=': () => zoomBy(1.15), '-': () => zoomBy(1 / 1.15), Home: () => { turn = {...home}; refresh(); }};
    area.addEventListener('keydown', event => {
        if (!keys[event.key]) return;
        keys[event.key]();
        event.preventDefault();
    });
    area.addEventListener('wheel', event => {
        zoomBy(Math.exp(-event.deltaY / 600));
        event.preventDefault();
    }, {passive: false});
    area.addEventListener('pointerdown', event => {
        area.setPointerCapture(event.pointerId);
        choose(view);
    });
    area.addEventListener('pointermove', event => {
        if (event.buttons & 1) moveBy(event.movementX / area.clientWidth, event.movementY / area.clientHeight);
        if (kind() !== 'volume') byId('pointer').textContent = view.valueAt(event, kind(), number('at'), turn);
    });
    view.choice.addEventListener('input', () => choose(view));
}

function listen() {
    const on = (id, action) => byId(id).addEventListener('input', action);
    on('count', takeCount);
    on('together', takeCount);
    on('at', () => { tellSlice(); refresh(); });
    on('frame', showFrame);
    for (const id of ['wipe', 'brightness', 'overlays']) on(id, refresh);
    on('kinds', showKind);
    byId('play').addEventListener('click', () => play(!playing));
    byId('copy').addEventListener('click', async () => {
        byId('setting').select();
        // Pages that are opened from disk may not use the clipboard otherwise.
        const copied = await navigator.clipboard?.writeText(byId('setting').value).then(() => true, () => false) || document.execCommand('copy');
        byId('copy').textContent = copied ? 'Copied' : 'Press Ctrl+C';
        setTimeout(() => byId('copy').textContent = 'Copy', 1500);
    });
    views.forEach(listenTo);
    document.addEventListener('keydown', event => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (chosen.scene.most > 0 && (event.key === '[' || event.key === ']')) step('count', event.key === ']' ? 1 : -1);
        if (event.key === ' ' && frames.length > 1 && !event.target.closest('button, input, a')) {
            play(!playing);
            event.preventDefault();
        }
    });
    byId('volume').addEventListener('webglcontextlost', event => event.preventDefault());
    byId('volume').addEventListener('webglcontextrestored', () => {
        volume.prepare();
        for (const view of views) {
            if (view.frame) volume.setBefore(view.number, view.frame.volume);
            view.forget();
        }
        refresh();
    });
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refresh);
    new ResizeObserver(resize).observe(byId('stage'));
}

/** Offers the overlays that a scene has. */
function offerOverlays() {
    const any = has => scenes.some(has), sets = any(scene => scene.sets.length > 0), lattice = any(scene => scene.lattices.length > 0);
    const there = {lattice, rig: any(scene => scene.rigs.length > 0), seams: any(scene => scene.sets.length === 1), outside: lattice,
        energy: any(scene => scene.energyRange !== null), masks: any(scene => scene.masks.length > 0),
        window: any(scene => scene.sets.length === 1 && scene.sets[0].window !== null)};
    const colours = {lattice: 'var(--line)', rig: 'var(--rig)'};
    for (const box of document.querySelectorAll('#overlays input')) {
        box.disabled = !there[box.value];
        box.parentElement.hidden = box.disabled;
        // Before there are seams, the page is for placing a lattice.
        box.checked = there[box.value] && !sets && ['lattice', 'rig', 'masks', 'outside'].includes(box.value);
        box.nextElementSibling.style.background = colours[box.value] ?? `rgb(${tints[box.value]})`;
    }
    if (there.masks) byId('maskNames').textContent = [...new Set(scenes.flatMap(scene => scene.masks))].join(', ');
    byId('overlays').hidden = !Object.values(there).some(each => each);
}

function start() {
    byId('title').textContent = data.title;
    byId('views').replaceChildren(...views.map(view => view.part));
    document.querySelectorAll('.several').forEach(each => each.hidden = views.length < 2);
    byId('stage').classList.toggle('alone', views.length < 2);
    try {
        volume = new VolumeView(byId('volume'), scenes, whole);
        views.forEach(view => view.volume = volume);
    } catch {
        byId('volume').hidden = true;
    }
    const thin = whole.slices.indexOf(1), flat = thin >= 0 && whole.slices.some(n => n > 1);
    const first = flat ? 'xyz'[thin] : volume ? 'volume' : 'y';
    for (const radio of document.querySelectorAll('input[name=kind]')) {
        radio.disabled = radio.value === 'volume' ? !volume || flat : flat && radio.value !== first;
        radio.checked = radio.value === first;
    }
    offerOverlays();
    byId('wiped').hidden = byId('seams').hidden = scenes.every(scene => scene.most === 0);
    byId('setting').rows = Math.max(1, ...scenes.map(scene => (scene.differs ?? []).length));
    document.querySelector('.sequence').hidden = frames.length < 2;
    byId('frame').max = frames.length - 1;
    // Scenes that begin with one count keep one.
    byId('together').checked = views.every(view => view.count === views[0].count);
    choose(views[0]);
    listen();
    resize();
    showKind();
    showFrame();
}
start();
