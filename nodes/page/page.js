'use strict';
// The controls, and what they show. State is what the controls say, the camera, and the place of a slice.

const byId = id => document.getElementById(id);
const scene = new Scene(JSON.parse(byId('data').textContent));
const canvases = {volume: byId('volume'), picture: byId('picture')};
const picture = new Picture(canvases.picture, scene);
const home = {yaw: -1.05, pitch: 0.3, zoom: 1, pan: [0, 0]};
let turn = {...home}, volume = null, frame = null, folds = [], drawing = 0, playing = 0;
/** What `carved` holds: frame, count and, of one slice, view and place. */
let carvedFor = '', tintedFor = '';
const carved = new Uint8Array(scene.voxels);
/** Milliseconds of script that the last picture took. */
let scriptTime = 0;

const number = id => Number(byId(id).value);
const kind = () => document.querySelector('input[name=kind]:checked').value;
const overlays = () => new Set([...document.querySelectorAll('#overlays input:checked')].filter(each => !each.disabled).map(each => each.value));
const colour = name => getComputedStyle(document.documentElement).getPropertyValue('--' + name).trim();
const parts = text => [1, 3, 5].map(n => parseInt(text.slice(n, n + 2), 16) / 255);
const wipe = () => scene.most > 0 ? number('wipe') / 100 : 1;

/** The carve of what is shown: of a slice, or of all voxels. */
function carveShown() {
    const count = number('count'), shown = kind(), at = number('at'), key = [frame.number, count, shown, shown === 'volume' ? '' : at].join(' ');
    if (key === carvedFor) return false;
    carvedFor = key;
    const first = [0, 0, 0], last = scene.size.map(n => n - 1);
    if (shown !== 'volume') first[axisNumber[shown]] = last[axisNumber[shown]] = at;
    if (count === 0 && scene.sets.length < 2) {
        carved.set(frame.volume);
        return true;
    }
    const key2 = frame.number + ' ' + count;
    if (frame.stepsFor !== key2) {
        frame.stepsFor = key2;
        frame.steps = carveSteps(scene.sets, count, scene.softness, frame.orders);
    }
    carve(frame.volume, scene.size, scene.background, frame.lattice, frame.places, frame.steps, [first, last], carved);
    return true;
}

function project(at) {
    const shown = kind();
    return shown === 'volume' ? volume.project(at, turn, canvases.picture) : picture.project(shown, at, turn);
}

function draw() {
    drawing = 0;
    if (!frame) return;
    const begin = performance.now(), shown = kind(), count = number('count'), over = overlays();
    const fresh = scene.most > 0 && carveShown(), tint = tinter(scene, frame, over, count);
    picture.clear();
    canvases.volume.hidden = shown !== 'volume';
    if (shown === 'volume') {
        if (fresh) volume.setAfter(carved);
        const key = [frame.number, [...over], over.has('seams') ? count : ''].join(' ');
        if (key !== tintedFor) {
            tintedFor = key;
            const bytes = tint && new Uint8Array(4 * scene.voxels);
            for (let n = 0; tint && n < scene.voxels; ++n) tint(n, bytes, 4 * n);
            volume.setOverlay(bytes);
        }
        volume.draw(turn, {wipe: wipe(), brightness: number('brightness'), ground: parts(colour('ground')), smoke: parts(colour('smoke'))});
    } else {
        picture.drawSlice(shown, number('at'), frame.volume, scene.most > 0 ? carved : frame.volume, tint, wipe(), turn, 2 ** number('brightness'));
    }
    if (frame.lattice && over.has('lattice')) {
        picture.drawLattice(frame.lattice, project, colour('line'));
        picture.drawFolds(frame.lattice, folds, project, colour('bad'));
    }
    if (frame.rig && over.has('rig')) picture.drawRig(frame.rig, project, colour('rig'));
    picture.drawWipe(wipe(), colour('accent'));
    scriptTime = performance.now() - begin;
}
/** Draws before the browser next paints, however many controls moved. */
function refresh() { drawing ||= requestAnimationFrame(draw); }

async function showFrame() {
    const wanted = number('frame'), read = await scene.frame(wanted);
    if (wanted !== number('frame')) return;
    frame = read;
    carvedFor = '';
    folds = frame.folds ??= frame.lattice ? foldedCells(frame.lattice) : [];
    byId('frameValue').textContent = frame.number;
    if (volume) volume.setBefore(frame.volume);
    tellNotes();
    refresh();
}

function tellNotes() {
    const notes = [];
    if (folds.length > 0)
        notes.push(['bad',
            `${folds.length} cells of the lattice fold, from plane ${folds[0].k} on: shown in red. Make the lattice narrower, or its rig smoother.`]);
    if (scene.sets.length === 0 && scene.lattices.length > 0) notes.push(['', 'There are no seams yet: this is where the lattice lies.']);
    if (scene.step > 1) notes.push(['',
        `Each voxel shows the mean of ${scene.step} x ${scene.step} x ${scene.step} voxels; the carve of the page reads these.`]);
    if (!volume) notes.push(['', 'This browser has no WebGL2: slices are shown, but no volume.']);
    byId('notes').replaceChildren(...notes.map(([style, text]) => Object.assign(document.createElement('li'), {className: style, textContent: text})));
}

function tellCount() {
    const count = number('count'), text = scene.signed(count), {energies} = scene.sets[scene.sets.length - 1];
    byId('countValue').textContent = text;
    byId('count').setAttribute('aria-valuetext', `${text} seams`);
    byId('setting').value = `--set ${scene.setting}=${text}`;
    const line = byId('energies').querySelector('.chosen'), x = count === 0 ? -10 : 300 * (count - 0.5) / energies.length;
    line.setAttribute('x1', x);
    line.setAttribute('x2', x);
}

/** The energy of each seam, the knee, and a line at what is chosen. */
function drawEnergies() {
    const {energies} = scene.sets[scene.sets.length - 1], highest = Math.max(...energies) || 1, knee = scene.knee();
    const x = n => (300 * (n - 0.5) / energies.length).toFixed(2), y = energy => (86 - 80 * energy / highest).toFixed(2);
    const path = energies.map((energy, n) => `${n === 0 ? 'M' : 'L'}${x(n + 1)} ${y(energy)}`).join('');
    byId('energies').innerHTML = `<path class="curve" d="${path}"/>` +
        (knee > 0 ? `<line class="knee" x1="${x(knee)}" x2="${x(knee)}" y1="0" y2="90"/>` : '') + '<line class="chosen" y1="0" y2="90"/>';
    byId('energies').setAttribute('aria-label',
        `Energy of ${energies.length} seams, from ${energies[0].toPrecision(3)} to ${energies[energies.length - 1].toPrecision(3)}`);
    byId('knee').textContent = knee > 0 ? `Energy of each seam. From ${scene.signed(knee)} on (dashed) more seams hurt more.` : 'Energy of each seam.';
}

function showKind() {
    const shown = kind(), flat = shown !== 'volume';
    document.querySelectorAll('.slices').forEach(each => each.hidden = !flat);
    if (flat) {
        const last = scene.size[axisNumber[shown]] - 1;
        byId('at').max = last;
        byId('at').value = Math.floor(last / 2);
        tellSlice();
    }
    carvedFor = '';
    refresh();
}
function tellSlice() { byId('atValue').textContent = scene.first[axisNumber[kind()]] + scene.step * number('at'); }

/** The value under the pointer. */
function tellPointer(event) {
    const shown = kind(), line = byId('pointer');
    if (!frame || shown === 'volume') return;
    const area = canvases.picture.getBoundingClientRect(), ratio = canvases.picture.width / area.width;
    const pixel = [(event.clientX - area.left) * ratio, (event.clientY - area.top) * ratio], at = picture.voxelAt(shown, number('at'), pixel, turn);
    if (!at) return line.textContent = '\u00a0';
    const n = at[0] + scene.size[0] * (at[1] + scene.size[1] * at[2]), text = byte => scene.value(byte).toPrecision(3);
    const index = at.map((x, axis) => scene.first[axis] + scene.step * x), world = scene.worldOf(at).map(x => x.toPrecision(4));
    line.textContent = `${scene.grid} ${text(frame.volume[n])}` + (scene.most > 0 ? `, carved ${text(carved[n])}` : '') +
        (frame.energy ? `, energy ${(frame.energy[n] / 255 * scene.energyRange[1]).toPrecision(3)}` : '') +
        ` at voxel [${index.join(', ')}], world [${world.join(', ')}]`;
}

function zoomBy(factor) {
    turn.zoom = clamp(turn.zoom * factor, 0.25, 16);
    refresh();
}
/** Turns the volume, or moves the slice. @param x, y  shares of the view's width and height */
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

function play(on) {
    clearInterval(playing);
    const slow = matchMedia('(prefers-reduced-motion: reduce)').matches;
    playing = on ? setInterval(() => {
        byId('frame').value = (number('frame') + 1) % scene.frames.length;
        showFrame();
    }, slow ? 1000 : 125) : 0;
    byId('play').textContent = on ? 'Stop' : 'Play';
    byId('play').setAttribute('aria-pressed', on);
}

function resize() {
    const area = byId('view').getBoundingClientRect(), ratio = window.devicePixelRatio || 1;
    // A volume of more pixels is slow to draw, and shows no more.
    const most = Math.min(ratio, Math.sqrt(3e5 / (area.width * area.height)));
    for (const [name, scale] of [['volume', most], ['picture', ratio]]) {
        canvases[name].width = Math.max(1, Math.round(area.width * scale));
        canvases[name].height = Math.max(1, Math.round(area.height * scale));
    }
    refresh();
}

function listen() {
    const on = (id, action) => byId(id).addEventListener('input', action);
    on('count', () => { tellCount(); refresh(); });
    on('at', () => { tellSlice(); refresh(); });
    on('frame', showFrame);
    for (const id of ['wipe', 'brightness', 'overlays']) on(id, refresh);
    on('views', showKind);
    byId('play').addEventListener('click', () => play(!playing));
    byId('copy').addEventListener('click', async () => {
        byId('setting').select();
        // Pages that are opened from disk may not use the clipboard otherwise.
        const copied = await navigator.clipboard?.writeText(byId('setting').value).then(() => true, () => false) || document.execCommand('copy');
        byId('copy').textContent = copied ? 'Copied' : 'Press Ctrl+C';
        setTimeout(() => byId('copy').textContent = 'Copy', 1500);
    });
    const view = byId('view'), keys = {
        ArrowLeft: () => moveBy(-0.03, 0), ArrowRight: () => moveBy(0.03, 0), ArrowUp: () => moveBy(0, -0.03), ArrowDown: () => moveBy(0, 0.03),
        '+': () => zoomBy(1.15), '=': () => zoomBy(1.15), '-': () => zoomBy(1 / 1.15), Home: () => { turn = {...home}; refresh(); }};
    view.addEventListener('keydown', event => {
        if (!keys[event.key]) return;
        keys[event.key]();
        event.preventDefault();
    });
    view.addEventListener('wheel', event => {
        zoomBy(Math.exp(-event.deltaY / 600));
        event.preventDefault();
    }, {passive: false});
    view.addEventListener('pointerdown', event => view.setPointerCapture(event.pointerId));
    view.addEventListener('pointermove', event => {
        if (event.buttons & 1) moveBy(event.movementX / view.clientWidth, event.movementY / view.clientHeight);
        tellPointer(event);
    });
    document.addEventListener('keydown', event => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (scene.most > 0 && (event.key === '[' || event.key === ']')) step('count', event.key === ']' ? 1 : -1);
        if (event.key === ' ' && scene.frames.length > 1 && !event.target.closest('button, input, a')) {
            play(!playing);
            event.preventDefault();
        }
    });
    canvases.volume.addEventListener('webglcontextlost', event => event.preventDefault());
    canvases.volume.addEventListener('webglcontextrestored', () => {
        volume.prepare();
        volume.setBefore(frame.volume);
        carvedFor = tintedFor = '';
        refresh();
    });
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', refresh);
    new ResizeObserver(resize).observe(view);
}

function start() {
    byId('title').textContent = scene.title;
    byId('facts').textContent = `${scene.grid}, ${scene.size.join(' x ')} voxels, ` + (scene.frames.length === 1 ? '1 frame' : `${scene.frames.length} frames`);
    try {
        volume = new VolumeView(canvases.volume, scene.size, scene.voxel);
    } catch {
        canvases.volume.hidden = true;
    }
    const thin = scene.size.indexOf(1), flat = thin >= 0 && scene.size.some(n => n > 1);
    const first = flat ? 'xyz'[thin] : volume ? 'volume' : 'y';
    for (const radio of document.querySelectorAll('input[name=kind]')) {
        radio.disabled = radio.value === 'volume' ? !volume || flat : flat && radio.value !== first;
        radio.checked = radio.value === first;
    }
    const there = {lattice: scene.lattices.length > 0, rig: scene.rigs.length > 0, seams: scene.sets.length === 1, energy: scene.energyRange !== null,
        masks: scene.masks.length > 0, window: scene.sets.length === 1 && scene.sets[0].window !== null};
    const colours = {lattice: 'var(--line)', rig: 'var(--rig)'};
    for (const box of document.querySelectorAll('#overlays input')) {
        box.disabled = !there[box.value];
        box.parentElement.hidden = box.disabled;
        // Before there are seams, the page is for placing a lattice.
        box.checked = there[box.value] && scene.sets.length === 0 && ['lattice', 'rig', 'masks'].includes(box.value);
        box.nextElementSibling.style.background = colours[box.value] ?? `rgb(${tints[box.value]})`;
    }
    if (there.masks) byId('maskNames').textContent = scene.masks.join(', ');
    byId('overlays').hidden = !Object.values(there).some(each => each);
    document.querySelectorAll('.after, #left, #right').forEach(each => each.hidden = scene.most === 0);
    document.querySelector('.sequence').hidden = scene.frames.length < 2;
    byId('frame').max = scene.frames.length - 1;
    if (scene.most > 0) {
        byId('count').max = scene.most;
        byId('count').value = scene.count;
        drawEnergies();
        tellCount();
    }
    listen();
    showKind();
    showFrame();
}
start();
